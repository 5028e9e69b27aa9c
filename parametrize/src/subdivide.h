// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// A cut surface whose long edges were halved, and the triangle of the original that each triangle is part of.
struct SubdividedSurface {
  CutSurface cut;  ///< inserted vertices have kNone as clean vertex and new points, shared by all copies of an edge
  std::vector<uint32_t> clean_triangle;
};

/// Halves edges until none is longer than `longest` [m], or the number of triangles would grow out of proportion. The
/// surface stays the same; a map of it gets more freedom.
[[nodiscard]] SubdividedSurface subdivide_long_edges(const CutSurface& cut, double longest);

}  // namespace geocloth
