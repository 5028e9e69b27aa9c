// SPDX-License-Identifier: GPL-3.0-or-later
//
// Many ways to part a chart are compared, so that a piece must cost little: the chart's upward directions are summed
// along rows of coarse cells, and what an outline encloses is a difference of sums per row.
#include "pack/panel_piece.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr int kMostHalvings = 16;

/// Where the horizontal lines y = first + k * step, k in [0, rows), cross an outline: by row, then ascending.
template <typename Place>
std::vector<std::pair<size_t, double>> find_crossings(size_t count, const Place& place, double first, double step,
                                                      size_t rows) {
  std::vector<std::pair<size_t, double>> crossing;
  // A point on a line counts as below it.
  const auto lines_below = [&](double y) {
    return static_cast<size_t>(std::clamp(std::ceil((y - first) / step), 0.0, static_cast<double>(rows)));
  };
  for (size_t i = 0; i < count; ++i) {
    const Point2 a = place(i), b = place(i + 1 == count ? 0 : i + 1);
    const auto [low, high] = std::minmax({lines_below(a[1]), lines_below(b[1])});
    for (size_t row = low; row < high; ++row) {
      const double y = first + static_cast<double>(row) * step;
      crossing.emplace_back(row, a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]));
    }
  }
  std::sort(crossing.begin(), crossing.end());
  return crossing;
}

}  // namespace

PanelPlan::PanelPlan(const Chart& chart, double cell) : loop_(outline_loop(chart)), cell_(cell) {
  std::vector<uint8_t> inner(chart.position.size(), 0);
  for (uint32_t h = 0; h < chart.opposite.size(); ++h) {
    if (chart.opposite[h] != kNone) inner[chart.triangle[h / 3][h % 3]] = 1;
  }
  low_ = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Point2 high{-low_[0], -low_[1]};
  for (const uint32_t v : loop_) {
    place_.push_back(chart.uv[v]);
    has_inner_edge_.push_back(inner[v]);
    for (size_t k = 0; k < 2; ++k) {
      low_[k] = std::min(low_[k], chart.uv[v][k]);
      high[k] = std::max(high[k], chart.uv[v][k]);
    }
  }
  columns_ = static_cast<size_t>((high[0] - low_[0]) / cell) + 1;
  rows_ = static_cast<size_t>((high[1] - low_[1]) / cell) + 1;
  sum_.resize(rows_ * (columns_ + 1));
  for (const Triangle& t : chart.triangle) {
    add_grain({chart.position[t[0]], chart.position[t[1]], chart.position[t[2]]},
              {chart.uv[t[0]], chart.uv[t[1]], chart.uv[t[2]]}, kMostHalvings);
  }
  for (size_t y = 0; y < rows_; ++y) {
    GrainSum* row = &sum_[y * (columns_ + 1)];
    for (size_t x = 0; x < columns_; ++x) row[x + 1].add(row[x]);
  }
}

/// A triangle that is large beside the cells lies in many of them.
void PanelPlan::add_grain(const std::array<Point3, 3>& p, const std::array<Point2, 3>& uv, int halvings) {
  const auto side = [&](size_t i, size_t k) { return std::hypot(uv[i][0] - uv[k][0], uv[i][1] - uv[k][1]); };
  const std::array<double, 3> length{side(1, 2), side(2, 0), side(0, 1)};
  const auto longest = static_cast<size_t>(std::max_element(length.begin(), length.end()) - length.begin());
  if (halvings > 0 && length[longest] > 2 * cell_) {
    const size_t i = (longest + 1) % 3, k = (longest + 2) % 3;
    const Point3 middle = (p[i] + p[k]) * 0.5;
    const Point2 uv_middle{(uv[i][0] + uv[k][0]) / 2, (uv[i][1] + uv[k][1]) / 2};
    for (const size_t moved : {i, k}) {
      std::array<Point3, 3> half = p;
      std::array<Point2, 3> uv_half = uv;
      half[moved] = middle;
      uv_half[moved] = uv_middle;
      add_grain(half, uv_half, halvings - 1);
    }
    return;
  }
  const Point2 middle{(uv[0][0] + uv[1][0] + uv[2][0]) / 3, (uv[0][1] + uv[1][1] + uv[2][1]) / 3};
  const size_t x = std::min(columns_ - 1, static_cast<size_t>(std::max(0.0, (middle[0] - low_[0]) / cell_)));
  const size_t y = std::min(rows_ - 1, static_cast<size_t>(std::max(0.0, (middle[1] - low_[1]) / cell_)));
  sum_[y * (columns_ + 1) + x + 1].add(grain_of_triangle(p, uv));
}

Point2 PanelPlan::up_of(const std::vector<uint32_t>& piece) const {
  const auto place = [&](size_t i) { return place_[piece[i]]; };
  const auto column = [&](double x) {
    return std::min(columns_, static_cast<size_t>(std::max(0.0, (x - low_[0]) / cell_ + 0.5)));
  };
  GrainSum all;
  const auto crossing = find_crossings(piece.size(), place, low_[1] + 0.5 * cell_, cell_, rows_);
  for (size_t k = 0; k + 1 < crossing.size(); k += 2) {
    const GrainSum* row = &sum_[crossing[k].first * (columns_ + 1)];
    all.add(row[column(crossing[k + 1].second)]);
    all.add(row[column(crossing[k].second)], -1);
  }
  if (!(all.area > 0)) return {0, 1};
  std::vector<Point2> outline;
  for (size_t i = 0; i < piece.size(); ++i) outline.push_back(place(i));
  return upward(all, outline);
}

double PanelPlan::area_of(const std::vector<uint32_t>& piece) const {
  double twice = 0;
  for (size_t i = 0; i < piece.size(); ++i) {
    const Point2 &a = place_[piece[i]], &b = place_[piece[i + 1 == piece.size() ? 0 : i + 1]];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

double PanelPlan::outline() const {
  double sum = 0;
  for (size_t i = 0; i < place_.size(); ++i) {
    const Point2 &a = place_[i], &b = place_[i + 1 == place_.size() ? 0 : i + 1];
    sum += std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  return sum;
}

ChartShape PanelPlan::shape_of(const std::vector<uint32_t>& piece, const Point2& up, double pixel) const {
  std::vector<Point2> corner;  // [pixels], v down
  Point2 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()}, high{0, 0};
  for (const uint32_t i : piece) {
    const Point2& p = place_[i];
    corner.push_back({(p[0] * up[1] - p[1] * up[0]) / pixel, -(p[0] * up[0] + p[1] * up[1]) / pixel});
    for (size_t k = 0; k < 2; ++k) low[k] = std::min(low[k], corner.back()[k]);
  }
  for (Point2& p : corner) {
    p = {p[0] - low[0], p[1] - low[1]};
    for (size_t k = 0; k < 2; ++k) high[k] = std::max(high[k], p[k]);
  }
  const auto rounded = [](double x) { return static_cast<uint32_t>(std::lround(x)); };
  ChartShape shape{rounded(high[0]) + 1, rounded(high[1]) + 1, {}};
  for (const Point2& p : corner) shape.run.push_back({rounded(p[1]), rounded(p[0]), rounded(p[0])});
  const auto place = [&](size_t i) { return corner[i]; };
  const auto crossing = find_crossings(corner.size(), place, 0, 1, shape.height);
  for (size_t k = 0; k + 1 < crossing.size(); k += 2) {
    const auto row = static_cast<uint32_t>(crossing[k].first);
    shape.run.push_back({row, rounded(crossing[k].second), rounded(crossing[k + 1].second)});
  }
  return shape;
}

}  // namespace geocloth
