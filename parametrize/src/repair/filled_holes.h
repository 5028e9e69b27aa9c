// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// A surface without its holes, to be cut and laid flat.
struct FilledSurface {
  CleanSurface surface;        ///< the vertices and triangles of the clean surface first, in their order
  std::vector<uint32_t> hole;  ///< per triangle after those: the hole that it fills, 0..rim.size()-1
  std::vector<uint32_t> rim;   ///< per hole: the lowest vertex on it
};

/// Fills the holes in a surface, which are less than its openings: the cloth beside one goes on over the filling,
/// nearly without a bend. The longest border of a component stays, and so do slits and borders that touch others.
/// @param left_open  the lowest vertices of holes that are to stay as well, ascending
[[nodiscard]] FilledSurface fill_holes(const CleanSurface& clean, std::span<const uint32_t> left_open);

}  // namespace geocloth
