// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "import/gltf_data.h"
#include "import/gltf_file.h"

namespace geocloth::import_detail {

/// Refuses a file that requires an extension which changes the mesh and is not understood.
/// @throws Error(unsupported) with the remedy
void check_extensions(const GltfFile& gltf);

/// Checks meshes, skins, nodes (a forest, glTF 2.0, section 3.5), and every index between them.
void check_scene(const GltfFile& gltf, const GltfData& data);

/// What of a checked scene is not read, though some viewers show it: copies of a node (EXT_mesh_gpu_instancing) and
/// meshes outside the scene that the file opens with. One sentence each.
[[nodiscard]] std::vector<std::string> find_left_out(const GltfFile& gltf);

}  // namespace geocloth::import_detail
