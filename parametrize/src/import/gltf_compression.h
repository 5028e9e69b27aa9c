// SPDX-License-Identifier: GPL-3.0-or-later
// Compressed data in glTF files: EXT_meshopt_compression (views) and KHR_draco_mesh_compression (primitives).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "import/gltf_file.h"

namespace geocloth::import_detail {

class GltfData;

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// What a compressed view decodes to, as its extension says: `count` elements of `stride` bytes.
struct MeshoptLayout {
  enum class Mode { attributes, triangles, indices } mode = Mode::attributes;
  enum class Filter { none, octahedral, quaternion, exponential } filter = Filter::none;
  std::size_t count = 0, stride = 0;
};

/// @throws Error(invalid_data) for values that the extension does not allow, Error(limit) for too many elements
[[nodiscard]] MeshoptLayout read_meshopt_layout(const GltfFile& gltf, const GltfFile::Json& extension,
                                                const std::string& where);
/// @returns count * stride bytes
/// @throws Error(invalid_data) when the bytes are no such stream
[[nodiscard]] std::vector<std::byte> decode_meshopt(const GltfFile& gltf, GltfFile::Bytes bytes,
                                                    const MeshoptLayout& layout, const std::string& where);

/// Decodes the primitives whose positions are there only in Draco's form; indices and attributes become new accessors.
/// @throws Error(invalid_data) when they are broken, Error(limit) when they are too large
void decode_draco(GltfFile& gltf, GltfData& data);

}  // namespace geocloth::import_detail
