// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "develop/develop.h"

namespace geocloth {

/// Takes the fillings out that an outline meets: such a hole is part of the outline then, which costs nothing. The
/// other triangles stay where they are in the plane.
/// @returns whether there were any
bool open_met_holes(std::vector<Chart>& charts);

/// The same of a developed surface, once a way was cut from each of some holes to the outline, the shortest one.
/// @param hole  ascending
[[nodiscard]] DevelopedSurface with_holes_cut_open(const DevelopedSurface& developed, std::span<const uint32_t> hole);

/// The components of a developed surface, by number.
[[nodiscard]] std::vector<Chart> charts_of(const DevelopedSurface& developed);

/// The charts as one surface, without what is in none of them.
[[nodiscard]] DevelopedSurface assembled(const CutSurface& cut, const std::vector<Chart>& charts);

}  // namespace geocloth
