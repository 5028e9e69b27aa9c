// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/convert.h"

namespace geocloth {

/// A clean surface and what of it the image leaves out because it is smaller than a pixel.
struct CarriedSurface {
  CleanSurface represented;          ///< what the image has to reproduce; points are those of the clean surface
  std::vector<CarriedPart> carried;  ///< what was left out, or closed
  std::vector<uint32_t>
      piece_of_point;  ///< per point: the carried piece that it is in and nothing else, kNone otherwise
};

/// The whole surface is to be represented.
[[nodiscard]] CarriedSurface carry_nothing(const CleanSurface& clean);

/// Leaves out the pieces (connected manifold components) whose area is below that of a pixel, and then the strips of
/// narrow_pieces.h, the smallest first, as long as they make up 1 % of the area together at most and something remains;
/// and closes holes that are less than a pixel long and three pixels around.
/// Spacing and pixel are those that the options ask for.
/// @param mesh  the file's mesh, for the names of its parts
[[nodiscard]] CarriedSurface carry_small_pieces(const TriangleMesh& mesh, const CleanSurface& clean,
                                                const FlattenOptions& options);

}  // namespace geocloth
