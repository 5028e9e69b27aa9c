// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "geocloth/parametrize/animated_mesh.h"
#include "import/animated_scene.h"

namespace geocloth::import_detail {

/// Of a glTF file: nodes, skins and morph targets of the scene that it opens with.
/// @throws Error as AnimatedMesh
[[nodiscard]] ReadScene read_gltf_scene(const std::filesystem::path& path, const AnimationOptions& options);

}  // namespace geocloth::import_detail
