// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "import/gltf_data.h"
#include "import/gltf_file.h"

namespace geocloth::import_detail {

/// Refuses a file that requires an extension which changes the mesh and is not understood.
/// @throws Error(unsupported) with the remedy
void check_extensions(const GltfFile& gltf);

/// Checks meshes, skins, nodes (a forest, glTF 2.0, section 3.5), and every index between them.
void check_scene(const GltfFile& gltf, const GltfData& data);

}  // namespace geocloth::import_detail
