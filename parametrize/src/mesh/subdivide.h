// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// Halves edges until none is longer than `longest` [m], or the number of triangles would grow out of proportion. The
/// surface stays the same; a map of it gets more freedom. Inserted vertices have kNone as clean vertex and new points,
/// shared by all copies of an edge.
[[nodiscard]] CutSurface subdivide_long_edges(CutSurface cut, double longest);

/// The same of a surface that lies in the plane already.
/// @param uv  per vertex of the cut; grows with it
[[nodiscard]] CutSurface subdivide_long_edges(CutSurface cut, std::vector<Point2>& uv, double longest);

}  // namespace geocloth
