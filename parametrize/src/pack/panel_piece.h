// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "develop/chart.h"
#include "develop/grain.h"
#include "pack/pack.h"

namespace geocloth {

/// A chart in its plane as far as packing goes: its outline, and which way is up where.
class PanelPlan {
 public:
  /// @param cell  [m] about the size of detail that is told apart
  PanelPlan(const Chart& chart, double cell);

  [[nodiscard]] const std::vector<uint32_t>& loop() const { return loop_; }  ///< the outline's vertices
  [[nodiscard]] const Point2& place(uint32_t i) const { return place_[i]; }  ///< of the loop's vertex i [m]
  /// A path across the chart can end there.
  [[nodiscard]] bool has_inner_edge(uint32_t i) const { return has_inner_edge_[i] != 0; }

  /// The upward direction of what a closed run of the loop's vertices encloses, as turn_upright() (grain.h) finds it.
  [[nodiscard]] Point2 up_of(const std::vector<uint32_t>& piece) const;

  [[nodiscard]] double area_of(const std::vector<uint32_t>& piece) const;
  [[nodiscard]] double outline() const;  ///< length of the whole loop [m]

  /// The pixels that a piece takes up when it is turned so that a direction is up.
  [[nodiscard]] ChartShape shape_of(const std::vector<uint32_t>& piece, const Point2& up, double pixel) const;

 private:
  void add_grain(const std::array<Point3, 3>& p, const std::array<Point2, 3>& uv, int halvings);

  std::vector<uint32_t> loop_;
  std::vector<Point2> place_;
  std::vector<uint8_t> has_inner_edge_;
  Point2 low_{0, 0};
  double cell_ = 0;
  size_t columns_ = 0, rows_ = 0;
  std::vector<GrainSum> sum_;  // rows_ x (columns_ + 1): what a row of cells holds left of a column
};

}  // namespace geocloth
