// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Pieces (components) that are sewn to each other, if to anything.
struct NarrowPieces {
  std::vector<uint32_t> component;
  double area = 0;   ///< [m^2]
  double width = 0;  ///< [m] where they are widest
};

/// Finds strips and threads that are narrower than half a pixel all along and lie on other cloth, as rows of stitches,
/// piping and tapes do: within a pixel of what stays, and not sewn to it.
/// @param most_area  [m^2] of a piece
/// @param left_out   per component: whether it is not there
[[nodiscard]] std::vector<NarrowPieces> find_narrow_pieces(const CleanSurface& clean, double pixel_side,
                                                           double most_area, std::span<const uint8_t> left_out);

}  // namespace geocloth
