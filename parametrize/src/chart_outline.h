// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// The border of one chart in its plane, ready for many questions "does this segment stay inside?".
class ChartOutline {
 public:
  /// @param border  directed border edges of the chart (vertex pairs), its inside to the left seen with v up
  ChartOutline(const FlatSurface& flat, const FlatChart& chart, const std::vector<std::array<uint32_t, 2>>& border);

  /// Does the closed segment stay in the chart? Running along the outline or touching it counts as inside.
  /// Both ends must lie in the chart.
  [[nodiscard]] bool holds(const Point2& a, const Point2& b) const;

 private:
  struct Edge {
    Point2 a, b;
  };
  [[nodiscard]] uint32_t row_of(double v) const;
  [[nodiscard]] std::vector<uint32_t> edges_near(const Point2& a, const Point2& b) const;
  [[nodiscard]] bool contains(const Point2& p) const;

  std::vector<Edge> edge_;
  std::vector<std::vector<uint32_t>> row_;  ///< edges by the pixel rows that they touch
};

/// Directed border edges (edges of one triangle) of every chart, in the order of the triangles.
[[nodiscard]] std::vector<std::vector<std::array<uint32_t, 2>>> chart_borders(const FlatSurface& flat);

/// The outline of every chart.
[[nodiscard]] std::vector<ChartOutline> chart_outlines(const FlatSurface& flat);

/// Where a pixel of the atlas stands in its chart's plane: outline pixels at their vertex, others at the pixel itself.
/// @param outline_vertex  Raster::vertex of the pixel
[[nodiscard]] Point2 place_in_chart(const FlatSurface& flat, const FlatChart& chart, uint32_t outline_vertex,
                                    uint32_t x, uint32_t y);

}  // namespace geocloth
