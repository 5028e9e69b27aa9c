// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "mesh_file.h"

namespace geocloth::meshes {

/// An irregular triangulation of a sewing panel in the plane.
struct PlanarMesh {
  std::vector<Point2> position;                   ///< the loops' points first, in their order
  std::vector<std::array<uint32_t, 3>> triangle;  ///< counter-clockwise
};

/// Points along a polyline, about `spacing` apart, with every corner kept; the last point is left out.
[[nodiscard]] std::vector<Point2> sample_polyline(const std::vector<Point2>& corners, double spacing);

/// Fills closed loops (the first is the outline, others are holes) with triangles of edge length about `spacing`.
/// The loops' points stay as they are, so panels that were sampled alike can be sewn. No edge but the loops' own joins
/// two of their points: such an edge could coincide with one of the panel that is sewn on.
[[nodiscard]] PlanarMesh triangulate(const std::vector<std::vector<Point2>>& loops, double spacing);

}  // namespace geocloth::meshes
