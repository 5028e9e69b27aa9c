// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// A cut surface into which vertices are inserted. Every component is a disk, so that each outline vertex has exactly
/// one outline half-edge that leaves it.
struct RefinedMesh {
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  std::vector<uint32_t> point;  ///< per vertex
  uint32_t point_count = 0;
  std::vector<uint32_t> clean_vertex;    ///< per vertex, kNone if inserted
  std::vector<uint32_t> clean_triangle;  ///< per triangle
  std::vector<uint32_t> component;       ///< per triangle
  std::vector<uint32_t> opposite;        ///< per half-edge, kNone on the outline
  std::vector<uint32_t> leaving;         ///< per vertex: outline half-edge that leaves it, kNone inside

  /// Puts a vertex on half-edge h (a to b) and splits its one or two triangles; h then runs from a to the new vertex.
  /// @return the new vertex
  uint32_t split_edge(uint32_t h, const Point3& at, uint32_t new_point);
};

[[nodiscard]] RefinedMesh make_refined_mesh(const CutSurface& cut);

/// A surface that is no disk has several borders, but still at most one border half-edge per vertex.
/// @param opposite  per half-edge of the surface
[[nodiscard]] RefinedMesh make_refined_mesh(const CleanSurface& surface, std::vector<uint32_t> opposite);

/// Splits every interior edge that joins two outline vertices at its middle. Afterwards no triangle has all its
/// vertices on the outline, and an embedding with positive weights over a convex outline has no flipped or empty
/// triangle, even where outline vertices lie on a straight line.
void split_edges_across(RefinedMesh& mesh);

}  // namespace geocloth
