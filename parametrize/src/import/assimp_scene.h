// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "geocloth/parametrize/animated_mesh.h"
#include "import/animated_scene.h"

namespace geocloth::import_detail {

/// Of an FBX or DAE file: nodes, skins and, of FBX, blend shapes.
/// @throws Error as AnimatedMesh
[[nodiscard]] ReadScene read_assimp_scene(const std::filesystem::path& path, const AnimationOptions& options);

}  // namespace geocloth::import_detail
