// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/convert.h"

namespace geocloth {

/// A clean surface and what of it the image leaves out because it is smaller than a pixel, or lies loose on the rest.
struct CarriedSurface {
  CleanSurface represented;          ///< what the image has to reproduce; points are those of the clean surface
  std::vector<CarriedPart> carried;  ///< what was left out, or closed
  size_t too_small = 0;              ///< how many of them, the first, are too small for pixels
  std::vector<uint32_t>
      piece_of_point;  ///< per point: the carried piece that it is in and nothing else, kNone otherwise
  double spacing = 0;  ///< [m] of the pixels that pieces were too small for; 0: none were left out
};

/// Pieces that are sewn to nothing, beside one that is fifty times as large.
struct LoosePiecesLeft {
  uint32_t count = 0;
  double across = 0;        ///< [m] the widest
  bool are_small = true;    ///< all of them beside the whole
  uint32_t would_ride = 0;  ///< of them with `carry_loose`
};
/// @param spacing  [m] of the pixels; 0 where `carry_loose` is on, or would do nothing
[[nodiscard]] LoosePiecesLeft find_loose_pieces(const CleanSurface& clean, double spacing);

/// The whole surface is to be represented.
[[nodiscard]] CarriedSurface carry_nothing(const CleanSurface& clean);

/// Leaves out the pieces (connected manifold components) whose area is below that of a pixel, and then the strips of
/// narrow_pieces.h, the smallest first, as long as they make up 1 % of the area together at most and something remains;
/// and closes holes that are less than a pixel long and three pixels around. With `carry_loose`, and where most of the
/// surface is a garment, loose pieces below a pixel are left out even if they are more, and so are those that are up to
/// a twentieth of the garment or three pixels across and lie on it all over, as buttons do. Spacing and pixel are those
/// that the options ask for.
/// @param mesh  the file's mesh, for the names of its parts
[[nodiscard]] CarriedSurface carry_small_pieces(const TriangleMesh& mesh, const CleanSurface& clean,
                                                const FlattenOptions& options, bool carry_loose);

}  // namespace geocloth
