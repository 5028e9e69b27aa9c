// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/solver/collider.h"
#include "geocloth/solver/solver.h"
#include "support/make_sheet.h"

namespace geocloth::test {

inline constexpr float kFrame = 1.F / 60;  ///< [s]

/// A sheet that lies on a slab and hangs over its sides; spacing 2.5 cm: at 8 substeps 2.4 m/s is fast for it.
inline SheetOptions sheet_on_slab() {
  SheetOptions options{.nx = 25, .ny = 25, .width = 0.6F, .height = 0.6F, .horizontal = true};
  options.center = {0, 0.003F, 0};
  return options;
}

inline Material cloth_on_slab() {
  Material material;
  material.friction = 0.5F;
  material.damping = 0;  // which brakes in the world
  return material;
}

inline Collider slab(float way, float turn_deg = 0) {
  Collider c{"slab", Box{{}, {0.2F, 0.1F, 0.2F}, {}}, 0.5F, {}};
  c.pose.translate = {way, -0.1F, 0};
  c.pose.rotate = quat_from_euler_deg({0, turn_deg, 0});
  return c;
}

inline SolverSettings eight_substeps() {
  SolverSettings settings;
  settings.substeps = 8;
  return settings;
}

}  // namespace geocloth::test
