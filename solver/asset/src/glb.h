// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "geocloth/asset/cloth_asset.h"
#include "geocloth/asset/output_file.h"

/// glTF 2.0 binary files, written and read. Shared by the asset file and the animated exporter; not installed.
namespace geocloth::glb {

using Json = nlohmann::json;

inline constexpr const char* kGenerator = "geocloth";  ///< what our files say in asset.generator
inline constexpr const char* kCloth = "cloth";  ///< in the extras of a mesh, where a cloth has several: its number
inline constexpr const char* kOpenFrom = "openFrom";  ///< in the extras of a mesh: the frame in which a cut opens it

/// What a viewer will use a buffer view for (bufferView.target).
enum class Target : uint32_t { none = 0, vertices = 34962, indices = 34963 };

/// Collects buffer views and the JSON that describes them, then writes the container.
/// Every buffer view starts at a multiple of four bytes. Same calls, same bytes.
class Builder {
 public:
  /// @param spill  takes the binary data while the file grows, instead of memory; it is not committed
  explicit Builder(OutputFile* spill = nullptr);

  /// The glTF object; "asset" and "scene" are set, "buffers", "bufferViews" and "accessors" come from the calls below.
  Json root;

  /// @returns the index of the new buffer view. @throws Error(limit) when the file would exceed 4 GiB
  uint32_t add_view(std::span<const std::byte> bytes, Target target = Target::none, uint32_t stride = 0);
  template <class T>
  uint32_t add_array(const std::vector<T>& values, Target target = Target::none) {
    return add_view(std::as_bytes(std::span(values)), target);
  }

  /// @returns the index of an accessor over `values`, which lie in a view from `byte_offset` on. With min and max.
  uint32_t add_accessor(std::span<const Vec3> values, uint32_t view, std::size_t byte_offset = 0);
  uint32_t add_accessor(std::span<const Vec2> values, uint32_t view, std::size_t byte_offset = 0);
  uint32_t add_accessor(std::span<const float> values, uint32_t view, std::size_t byte_offset = 0);
  /// Triangle corners, as 16-bit numbers where they fit: first the view of all, then the accessor of a run of them.
  uint32_t add_index_view(std::span<const Triangle> triangles, uint32_t vertex_count);
  uint32_t add_index_accessor(uint32_t view, std::size_t first_triangle, std::size_t triangle_count,
                              uint32_t vertex_count);

  /// Images, textures and materials of a source mesh. @returns the index of its first material
  uint32_t add_materials(const SourceMesh& source);

  /// The finished file. Without a spill: in memory; with one, or to spare memory: into an output file.
  [[nodiscard]] std::vector<std::byte> bytes();
  void write(OutputFile& file);

 private:
  struct Bounds {
    std::vector<float> min, max;
  };
  uint32_t add_accessor(const char* type, std::size_t count, uint32_t view, std::size_t byte_offset, Bounds bounds);
  /// Header, JSON chunk and the head of the binary chunk.
  std::vector<std::byte> head();

  std::vector<std::byte> binary_;
  OutputFile* spill_;
  uint64_t size_ = 0;  ///< [bytes] of the binary chunk so far
};

/// The two chunks of a file. The binary chunk is a part of the bytes given.
struct Container {  // NOLINT(bugprone-exception-escape): nlohmann's move does not throw, whatever the tool reads in it
  Json json;
  std::span<const std::byte> binary;
};

/// Takes a file apart. Only container rules are checked here. @throws Error(invalid_data), Error(unsupported)
[[nodiscard]] Container parse(std::span<const std::byte> bytes, const std::string& name);

}  // namespace geocloth::glb
