// SPDX-License-Identifier: GPL-3.0-or-later
// A grid of pixels knows nothing of slits: neighbours across a cut look connected and would be joined by springs as
// long as the slit is deep. So every spring is tested as a segment against the outline of its chart. The signs are
// exact; a segment is cut where it touches the outline and each piece is judged by its midpoint (even-odd rule).
#include "image/chart_outline.h"

#include <algorithm>
#include <cmath>

#include "mesh/point_math.h"
#include "mesh/predicates.h"

namespace geocloth {
namespace {

Point2 along(const Point2& a, const Point2& b, double t) {
  return {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t};
}

/// Where p, which lies on the line through a and b, stands between them.
double parameter(const Point2& a, const Point2& b, const Point2& p) {
  const double du = b[0] - a[0], dv = b[1] - a[1];
  return std::abs(du) > std::abs(dv) ? (p[0] - a[0]) / du : (p[1] - a[1]) / dv;
}

bool between(double x, double a, double b) {
  return x >= std::min(a, b) && x <= std::max(a, b);
}

/// Is p on the closed segment, up to the rounding of a midpoint?
bool on_segment(const Point2& a, const Point2& b, const Point2& p) {
  constexpr double kTolerance = 1e-9;  // [pixels]
  const double du = b[0] - a[0], dv = b[1] - a[1], square = du * du + dv * dv;
  const double t = square > 0 ? std::clamp(((p[0] - a[0]) * du + (p[1] - a[1]) * dv) / square, 0.0, 1.0) : 0;
  const Point2 nearest = along(a, b, t);
  return std::hypot(p[0] - nearest[0], p[1] - nearest[1]) <= kTolerance;
}

}  // namespace

ChartOutline::ChartOutline(const FlatChart& chart) {
  row_.resize(std::max(chart.height, 1U));
  for_outline_steps(chart, [&](const OutlineSample& from, const OutlineSample& to) {
    const auto index = static_cast<uint32_t>(edge_.size());
    edge_.push_back({{static_cast<double>(from.x), static_cast<double>(from.y)},
                     {static_cast<double>(to.x), static_cast<double>(to.y)}});
    for (uint32_t r = std::min(from.y, to.y); r <= std::max(from.y, to.y); ++r) row_[r].push_back(index);
  });
}

uint32_t ChartOutline::row_of(double v) const {
  return static_cast<uint32_t>(std::clamp(std::floor(v), 0.0, static_cast<double>(row_.size() - 1)));
}

std::vector<uint32_t> ChartOutline::edges_near(const Point2& a, const Point2& b) const {
  std::vector<uint32_t> near;
  for (uint32_t r = row_of(std::min(a[1], b[1])); r <= row_of(std::max(a[1], b[1])); ++r) {
    for (const uint32_t index : row_[r]) {
      const Edge& e = edge_[index];
      const bool apart =
          std::max(e.a[0], e.b[0]) < std::min(a[0], b[0]) || std::min(e.a[0], e.b[0]) > std::max(a[0], b[0]) ||
          std::max(e.a[1], e.b[1]) < std::min(a[1], b[1]) || std::min(e.a[1], e.b[1]) > std::max(a[1], b[1]);
      if (!apart) near.push_back(index);
    }
  }
  return near;
}

bool ChartOutline::contains(const Point2& p) const {
  bool inside = false;
  for (const uint32_t index : row_[row_of(p[1])]) {
    const Edge& e = edge_[index];
    if (on_segment(e.a, e.b, p)) return true;
    if ((e.a[1] > p[1]) == (e.b[1] > p[1])) continue;
    // Does the ray from p towards smaller u cross the edge? The sign changes with the direction of the edge.
    if ((orientation(e.a, e.b, p) > 0) == (e.b[1] > e.a[1])) inside = !inside;
  }
  return inside;
}

bool ChartOutline::holds(const Point2& a, const Point2& b) const {
  const std::vector<uint32_t> near = edges_near(a, b);
  if (near.empty()) return true;
  std::vector<double> cut{0, 1};
  for (const uint32_t index : near) {
    const Edge& e = edge_[index];
    const int side_a = orientation(a, b, e.a), side_b = orientation(a, b, e.b);
    const int end_a = orientation(e.a, e.b, a), end_b = orientation(e.a, e.b, b);
    if (side_a * side_b < 0 && end_a * end_b < 0) return false;
    for (const auto& [side, p] : {std::pair(side_a, e.a), std::pair(side_b, e.b)}) {
      if (side == 0 && between(p[0], a[0], b[0]) && between(p[1], a[1], b[1])) cut.push_back(parameter(a, b, p));
    }
  }
  std::sort(cut.begin(), cut.end());
  for (std::size_t i = 0; i + 1 < cut.size(); ++i) {
    if (cut[i] < cut[i + 1] && !contains(along(a, b, (cut[i] + cut[i + 1]) / 2))) return false;
  }
  return true;
}

std::vector<std::vector<uint32_t>> row_crossings(const FlatChart& chart) {
  std::vector<std::vector<uint32_t>> columns(chart.height);
  for_outline_steps(chart, [&](const OutlineSample& a, const OutlineSample& b) {
    if (a.y != b.y) columns[std::min(a.y, b.y)].push_back(a.y < b.y ? a.x : b.x);
  });
  for (std::vector<uint32_t>& row : columns) std::sort(row.begin(), row.end());
  return columns;
}

std::vector<std::vector<std::array<uint32_t, 2>>> chart_borders(const FlatSurface& flat) {
  using Side = std::array<uint32_t, 2>;
  const auto sorted = [](const Side& s) { return Side{std::min(s[0], s[1]), std::max(s[0], s[1])}; };
  std::vector<Side> edges;
  edges.reserve(3 * flat.triangle.size());
  for (const Triangle& t : flat.triangle) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(sorted({t[k], t[(k + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  std::vector<std::vector<Side>> borders(flat.charts.size());
  for (std::size_t t = 0; t < flat.triangle.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Side side{flat.triangle[t][k], flat.triangle[t][(k + 1) % 3]};
      const auto [first, last] = std::equal_range(edges.begin(), edges.end(), sorted(side));
      if (last - first == 1) borders[flat.chart[t]].push_back(side);
    }
  }
  return borders;
}

std::vector<ChartOutline> chart_outlines(const FlatSurface& flat) {
  std::vector<ChartOutline> outlines;
  for (const FlatChart& chart : flat.charts) outlines.emplace_back(chart);
  return outlines;
}

Point2 pixel_in_chart(const FlatChart& chart, uint32_t x, uint32_t y) {
  return {static_cast<double>(x - chart.x0), static_cast<double>(y - chart.y0)};
}

}  // namespace geocloth
