// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/convert.h"

namespace geocloth {

/// Moves the points of a surface as little as need be until its triangles no longer cut through each other: the lines
/// in which they do are shortened until they vanish (Volino and Magnenat-Thalmann 2006, Resolving surface collisions
/// through intersection contour minimization), while edges keep their lengths. Points that are far from all of them
/// stay bit for bit. What does not come apart in some hundred rounds stays as it was at its best.
/// @param triangle  indices of places; triangles that share a point never cut each other, nor do those in one plane
/// @param place     [m] finite
/// @throws Error(limit) where millions of triangles lie at the same places
Untangled untangle(const std::vector<Triangle>& triangle, std::vector<Point3>& place);

}  // namespace geocloth
