// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// Calls visit(sample, next) for every step of a chart's outline and around its holes.
template <class Visit>
void for_outline_steps(const FlatChart& chart, const Visit& visit) {
  const auto around = [&](const std::vector<OutlineSample>& loop) {
    for (std::size_t k = 0; k < loop.size(); ++k) visit(loop[k], loop[(k + 1) % loop.size()]);
  };
  around(chart.outline);
  for (const std::vector<OutlineSample>& hole : chart.holes) around(hole);
}

/// The polygon of one chart's outline pixels, ready for many questions "does this segment stay inside?". Pixels, not
/// the places that they sample: a spring belongs to the image when it stays inside of the image's outline.
class ChartOutline {
 public:
  explicit ChartOutline(const FlatChart& chart);

  /// Does the closed segment between two pixels (relative to the chart) stay in the chart? Running along the outline or
  /// touching it counts as inside. Both ends must lie in the chart.
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

/// Per row of a chart: the columns at which it enters and leaves the outline polygon, ascending. The polygon's edges
/// join 8-neighbours, so that they cross rows at pixels only.
[[nodiscard]] std::vector<std::vector<uint32_t>> row_crossings(const FlatChart& chart);

/// Directed border edges (edges of one triangle) of every chart, in the order of the triangles.
[[nodiscard]] std::vector<std::vector<std::array<uint32_t, 2>>> chart_borders(const FlatSurface& flat);

/// The outline of every chart.
[[nodiscard]] std::vector<ChartOutline> chart_outlines(const FlatSurface& flat);

/// A pixel of the atlas relative to its chart's corner.
[[nodiscard]] Point2 pixel_in_chart(const FlatChart& chart, uint32_t x, uint32_t y);

}  // namespace geocloth
