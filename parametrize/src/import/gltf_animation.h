// SPDX-License-Identifier: GPL-3.0-or-later
// One animation of a glTF file (glTF 2.0, section 3.11 and appendix C).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "import/gltf_data.h"
#include "import/gltf_file.h"
#include "import/node_animation.h"

namespace geocloth::import_detail {

/// Reads and checks an animation of a checked scene. Only what is played is checked here, so that a broken animation
/// does not cost the mesh.
/// @param clip     as of find_clip()
/// @param targets  numbers of morph targets, of each mesh
/// @throws Error(invalid_data) when there is none, or when it is broken; Error(limit) when it is too large
[[nodiscard]] NodeAnimation read_gltf_animation(const GltfFile& gltf, const GltfData& data, const std::string& clip,
                                                const std::vector<std::size_t>& targets);

}  // namespace geocloth::import_detail
