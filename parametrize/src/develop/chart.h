// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// One disk of a cut surface by itself, on its way into the plane. Triangles keep their order through all cuts.
struct Chart {
  std::vector<Triangle> triangle;
  std::vector<uint32_t> global_triangle;  ///< per triangle: triangle of the cut surface
  std::vector<uint32_t> opposite;         ///< per half-edge
  std::vector<Point3> position;           ///< per vertex [m]
  std::vector<uint32_t> cut_vertex;       ///< per vertex: vertex of the cut surface
  std::vector<Point2> uv;                 ///< per vertex [m], y up, triangles counter-clockwise; empty until embedded
  std::vector<uint32_t> hole{};  ///< per triangle: the hole that it fills, kNone for cloth; empty: all is cloth

  [[nodiscard]] bool is_cloth(size_t t) const { return hole.empty() || hole[t] == kNone; }
};

/// Some triangles of a cut surface as a chart without coordinates.
[[nodiscard]] Chart extract_chart(const CutSurface& cut, std::vector<uint32_t> triangles);
[[nodiscard]] std::vector<std::vector<uint32_t>> triangles_of_components(const CutSurface& cut);

[[nodiscard]] double total_area(const Chart& chart);  ///< of its cloth
/// Of a triangle in a chart's plane [m^2], positive when it is counter-clockwise.
[[nodiscard]] inline double signed_area(const Point2& a, const Point2& b, const Point2& c) {
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]));
}

/// The outline's vertices, counter-clockwise.
[[nodiscard]] std::vector<uint32_t> outline_loop(const Chart& chart);
[[nodiscard]] std::vector<uint8_t> on_outline(const Chart& chart);  ///< per vertex
[[nodiscard]] double outline_length(const Chart& chart);

/// What makes an edge count as shorter for a cut.
struct EdgeWishes {
  double crease = 0;                   ///< share of its length that an edge saves that is folded by a radian or more;
                                       ///< less in proportion where it is folded less
  std::span<const double> discount{};  ///< per half-edge of the cut surface, other shares; may be empty
};

struct ChartNeighbour {
  uint32_t vertex;
  double length;  ///< of the edge [m], less what the wishes save
  bool outline;   ///< the edge is one of the outline
};
[[nodiscard]] std::vector<std::vector<ChartNeighbour>> neighbours(const Chart& chart, const EdgeWishes& wishes = {});

/// Dijkstra's distances from a set of vertices along edges inside the chart, with the way back. `closed` vertices are
/// ends, never passed.
struct Distances {
  std::vector<double> value;   ///< infinite where nothing leads
  std::vector<uint32_t> from;  ///< kNone at a source
  [[nodiscard]] std::vector<uint32_t> path_from(uint32_t vertex) const;
};
[[nodiscard]] Distances distances(const Chart& chart, const std::vector<uint32_t>& sources,
                                  const std::vector<uint8_t>& closed, const EdgeWishes& wishes = {});
[[nodiscard]] double path_length(const Chart& chart, const std::vector<uint32_t>& path);

/// The chart cut open along a path of vertices; the plane's coordinates stay.
[[nodiscard]] Chart opened(const Chart& chart, const std::vector<uint32_t>& path);
[[nodiscard]] Chart opened(const Chart& chart, std::span<const std::vector<uint32_t>> paths);

/// The loops of vertices around the holes that are filled, as far as those lie inside the chart.
[[nodiscard]] std::vector<std::vector<uint32_t>> rim_loops(const Chart& chart);

/// The edge-connected pieces of a chart, in the order of their first triangles.
[[nodiscard]] std::vector<Chart> separated(const Chart& chart);

}  // namespace geocloth
