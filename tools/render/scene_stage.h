// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/solver/scene.h"
#include "render/renderer.h"

namespace geocloth {

/// What a renderer needs to know of a simulation. The subject is where the garments are at the start and where the
/// scene will move them, with room to swing, and the colliders near them over the whole time: the motion itself is not
/// known yet. Where a garment is not pinned the camera goes with it.
[[nodiscard]] RenderScene stage_simulation(const Simulation& simulation);

}  // namespace geocloth
