// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "import/gltf_data.h"
#include "import/gltf_file.h"

namespace geocloth::import_detail {

/// Writes every skinned or morphed mesh of a checked scene anew as viewers show it before anything moves: joints where
/// the nodes have them, morph targets with the weights that the mesh or its node gives them. A skinned mesh becomes a
/// root node; a mesh that nothing deforms stays bit for bit as it is, at most with another matrix.
void pose_meshes(GltfFile& gltf, GltfData& data);

}  // namespace geocloth::import_detail
