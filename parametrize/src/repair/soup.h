// SPDX-License-Identifier: GPL-3.0-or-later
// A triangle soup over welded points, and the steps that make it a complex of proper triangles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/repair.h"

namespace geocloth {

/// Triangles over points. Nothing is said about how they hang together.
struct Soup {
  std::vector<Point3> position;  ///< per point [m]
  std::vector<Triangle> triangle;
  std::vector<uint32_t> source;  ///< per triangle: triangle of the file
};

/// How far apart vertices may be that become one.
struct WeldReach {
  double distance;  ///< [m]
  bool is_asked;    ///< then it is not more in soups
};
/// @param size  [m] of the mesh
[[nodiscard]] WeldReach weld_reach(const RepairOptions& options, double size);

/// Points of the vertices that some triangle uses, kNone for the others: vertices at one place, and vertices within
/// reach of each other, are one point. Points are numbered in the order of their first vertex and stand where it
/// stands. The nearest are joined first; no point grows wider than the reach, and no triangle with three different
/// places loses one, however small it is: half the shortest edge at a vertex is the most. Where that leaves loose
/// triangles that make a whole when vertices are joined within a two-hundredth of the shortest edge (and a hundred
/// times the reach), they are, unless the reach was asked for: such a soup was shaken or rounded.
struct Weld {
  std::vector<uint32_t> point;   ///< per vertex
  std::vector<Point3> position;  ///< per point
};
[[nodiscard]] Weld weld(std::span<const Point3> position, std::span<const Triangle> triangle, const WeldReach& reach);

/// Triangles over the points of their vertices, without those that have two corners at one.
[[nodiscard]] std::vector<Triangle> proper_triangles(std::span<const Triangle> triangle,
                                                     const std::vector<uint32_t>& point);

/// One side of a triangle that no other triangle shares.
struct BorderSide {
  uint32_t triangle;
  uint32_t corner;  ///< it runs from this corner to the next
};
/// Ascending by triangle and corner.
[[nodiscard]] std::vector<BorderSide> border_sides(std::span<const Triangle> triangles);

/// Drops triangles that use a point twice. @returns how many
uint64_t drop_collapsed(Soup& soup);

/// Drops all but the first of the triangles over the same three points, whichever way round, and all but the first of
/// the polygons over the same points. Corners that two layers sewn round the border have in common stay; they and what
/// is beside them are split so that the layers have no edge in common there; without both where they are tiny.
/// Of double-sided parts whose back is cut along other diagonals than the front, and so shares no triangle with it, the
/// back. @param polygon  per triangle of the file; may be empty @returns how many faces
uint64_t drop_duplicates(Soup& soup, std::span<const uint32_t> polygon);

/// Sews borders that lie along each other within the tolerance: points of them within a tenth of the edges there become
/// one, in the middle, and edges are split at the others (T-junctions). @param vertex_point  per vertex of the file:
/// its point @returns how many points were met by splitting
uint64_t sew_borders(Soup& soup, std::vector<uint32_t>& vertex_point, double tolerance);

/// Removes triangles whose three points lie on a line: the faces beyond their longest side get its middle point as a
/// corner instead, which keeps the surface closed there. @returns how many were removed
uint64_t flatten_caps(Soup& soup);

}  // namespace geocloth
