// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// The least whole number of steps that every seam needs for the welded grid to be a proper mesh: a closed seam three
/// (a loop of fewer edges collapses); one with a cut end two (its two sides need room to part); of several seams
/// between the same two nodes each two (only one could be a single edge, and to keep it simple none is); others one.
/// @param natural  per seam: the steps that it takes by its length; of several seams between the same two nodes the
///   shortest is a single edge then, if it is that short: what narrow strips hang by. Empty: none
[[nodiscard]] std::vector<uint32_t> least_seam_steps(const CutSurface& cut, std::span<const Outline> outlines,
                                                     std::span<const uint32_t> natural = {});

}  // namespace geocloth
