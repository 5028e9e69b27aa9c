// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "geocloth/solver/scene.h"

namespace geocloth {

/// A cloth as warnings call it: its path in the scene, and its file.
[[nodiscard]] std::string name_of_cloth(const Scene& scene, size_t cloth);

/// What a scene asks for that will not come as its author expects, known before it plays. In plain words, with a
/// remedy.
[[nodiscard]] std::vector<std::string> scene_warnings(const Simulation& simulation);
/// The same of what only playing tells: cuts that met nothing, flat cloth that cannot fold, a pressure that the
/// substeps do not hold.
[[nodiscard]] std::vector<std::string> played_warnings(Simulation& simulation);

}  // namespace geocloth
