// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

struct ImportOptions {
  /// Metres per unit of the file. Not set: what the file itself says (glTF: 1; FBX, DAE: their unit; others: 1).
  std::optional<double> scale;
};

/// Reads OBJ, glTF (.gltf with files or data URIs, .glb, .vrm), PLY, STL, OFF, FBX or DAE with assimp: all meshes and
/// primitives of the file with their node transforms, quads and polygons triangulated. Skinned and morphed glTF and
/// skinned DAE are taken as viewers show them before anything moves; in FBX skinned meshes keep their bind pose. glTF
/// may be compressed by EXT_meshopt_compression or KHR_draco_mesh_compression. Points are left out; lines are kept as
/// TriangleMesh::loose_edge, which sewing follows. Vertices
/// keep the file's order; for OBJ the order of its `v` records.
/// @throws Error(io) when the file is missing, a directory or unreadable; Error(invalid_data) when it is no mesh, is
///   truncated, has no faces, or has coordinates that are not finite; Error(unsupported) when it needs an extension
///   that changes the mesh and is not understood, with the remedy;
///   Error(limit) when it is absurdly large
[[nodiscard]] TriangleMesh import_mesh(const std::filesystem::path& path, const ImportOptions& options = {});

/// How many animations a file has, which import_mesh() does not play (a DAE file has one at most); 0 for formats
/// without.
/// @throws Error as import_mesh()
[[nodiscard]] size_t count_animations(const std::filesystem::path& path);

}  // namespace geocloth
