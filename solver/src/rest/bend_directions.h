// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "geocloth/solver/material.h"

namespace geocloth {

/// The directions in which a pixel's curvature is measured, in the order of the springs: along the row (weft), down the
/// column (warp), down-right, down-left.
inline constexpr int kBendDirections = 4;
inline constexpr uint32_t kWeft = 0, kWarp = 1;

/// How the grid runs through a pixel at rest.
struct GridDirections {
  double right = 0, down = 0;  ///< [m] > 0 steps along the row and down the column
  double angle = 0;            ///< [rad] from right to down, in ]0, pi[
};

/// [rad] How far from weft a line in the surface runs that is at an angle from the grid's right.
[[nodiscard]] double angle_from_weft(const GridDirections& grid, double angle_from_right);

/// [N m] Against bending of a line at an angle [rad] from weft.
[[nodiscard]] double rigidity_along(const Material& material, double angle);

/// [N m] of each direction, none below 0, so that the four together resist bending about any axis as the material with
/// its bend_bias does: as well as springs along these four directions can, exactly on a grid of squares.
[[nodiscard]] std::array<double, kBendDirections> spread_rigidity(const Material& material, const GridDirections& grid);

}  // namespace geocloth
