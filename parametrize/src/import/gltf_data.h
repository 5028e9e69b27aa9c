// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a glTF file: its buffers, views and accessors, each checked to lie within what it refers to (glTF 2.0,
// section 3.6), compressed ones decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "import/gltf_file.h"

namespace geocloth::import_detail {

struct GltfAccessor {
  std::size_t count = 0, component_size = 0, components = 0, component_type = 0;
  bool has_data = false, normalized = false;
  std::size_t stride = 0;
  GltfFile::Bytes bytes;             ///< from its first element on; empty for one that is sparse only
  std::vector<GltfAccessor> sparse;  ///< indices and values, of one that is sparse
};

class GltfData {
 public:
  using Json = GltfFile::Json;
  using Bytes = GltfFile::Bytes;

  /// Reads the buffers beside the file, too. What was compressed is written to the JSON as views of new buffers.
  /// @param gltf  outlives this object
  explicit GltfData(GltfFile& gltf);

  [[nodiscard]] const std::vector<Bytes>& buffers() const { return buffers_; }
  [[nodiscard]] Bytes view(std::size_t i) const { return views_[i].bytes; }
  [[nodiscard]] const GltfAccessor& accessor(std::size_t i) const { return accessors_[i]; }
  /// The accessor that object[key] names.
  [[nodiscard]] const GltfAccessor& attribute(const Json& object, const char* key, const std::string& where) const;

  /// All components of accessor `i`, sparse ones resolved, normalized integers as the numbers they stand for (3.11).
  [[nodiscard]] std::vector<float> floats(std::size_t i) const;
  /// Accessor `i` of checked indices, sparse ones resolved.
  [[nodiscard]] std::vector<uint32_t> indices(std::size_t i) const;

  /// Refuses values that are not below `limit`.
  void check_indices(const GltfAccessor& a, std::size_t limit, const std::string& where) const;

  /// Appends an accessor without gaps to the JSON. @returns its index
  std::size_t add_accessor(std::size_t component_type, const char* type, std::size_t count,
                           std::vector<std::byte> bytes);
  /// Gives accessor `i` other elements of the same number and type.
  void replace(std::size_t i, std::size_t component_type, std::vector<std::byte> bytes);

 private:
  struct View {
    Bytes bytes;
    std::size_t stride;
  };

  void load_buffers();
  void load_views();
  void load_accessors();
  Bytes load_buffer(const Json& buffer, std::size_t i, const std::string& where);
  View read_view(const Json& json, const std::string& where) const;
  void decode_view(std::size_t i, const Json& compression, const std::string& where);
  void load_sparse(const Json& json, GltfAccessor& accessor, const std::string& where);
  [[nodiscard]] Bytes elements(const Json& object, const std::string& where, GltfAccessor& a) const;
  std::size_t add_buffer(std::vector<std::byte> bytes);
  std::size_t add_view(std::vector<std::byte> bytes);
  void count_bytes(std::size_t more);

  GltfFile& gltf_;
  std::vector<std::vector<std::byte>> owned_;
  std::vector<Bytes> buffers_;
  std::vector<View> views_;
  std::vector<GltfAccessor> accessors_;
  std::size_t total_bytes_ = 0;
};

/// Bytes of one component of an accessor; 0 for an unknown type.
[[nodiscard]] std::size_t gltf_component_size(std::size_t component_type);

}  // namespace geocloth::import_detail
