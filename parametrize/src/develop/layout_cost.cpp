// SPDX-License-Identifier: GPL-3.0-or-later
//
// Seams and distortion on one scale, as in OptCuts (Li et al. 2018), whose factor between the two is found by its
// user's bound on the distortion; here the bounds are part of the cost.
#include "develop/layout_cost.h"

#include <algorithm>
#include <cmath>

#include "develop/chart_energy.h"
#include "mesh/point_math.h"

namespace geocloth {

double strained_area(const Chart& chart) {
  const std::vector<double> energy = chart_energy(chart).energy_per_triangle(chart.uv);
  double strained = 0;
  for (size_t t = 0; t < energy.size(); ++t) {
    const Triangle& k = chart.triangle[t];
    if (chart.is_cloth(t) && energy[t] > kMostStrain) {
      strained += triangle_area(chart.position[k[0]], chart.position[k[1]], chart.position[k[2]]);
    }
  }
  return strained;
}

namespace {

double smooth_length(const Chart& chart, const std::vector<uint32_t>& loop) {
  constexpr int kRounds = 6;
  std::vector<Point2> place;
  place.reserve(loop.size());
  for (const uint32_t v : loop) place.push_back(chart.uv[v]);
  const size_t n = place.size();
  double length = 0;
  for (int round = 0; round <= kRounds; ++round) {
    const std::vector<Point2> before = place;
    length = 0;
    for (size_t i = 0; i < n; ++i) {
      const Point2 &a = before[i], &b = before[(i + 1) % n];
      length += std::hypot(b[0] - a[0], b[1] - a[1]);
      place[i] = {(a[0] + b[0]) / 2, (a[1] + b[1]) / 2};
    }
  }
  return length;
}

}  // namespace

double smooth_outline_length(const Chart& chart) {
  double length = smooth_length(chart, outline_loop(chart));
  for (const std::vector<uint32_t>& rim : rim_loops(chart)) length += smooth_length(chart, rim);
  return length;
}

void LayoutCost::add(const Chart& chart, double outline_length) {
  const double own = total_area(chart);
  area += own;
  outline += outline_length;
  energy += own * chart_energy(chart).energy(chart.uv);
  strained += strained_area(chart);
}

double LayoutCost::value(double target_energy) const {
  constexpr double kExcess = 1 / 0.06, kBeyond = 1 / 0.005, kStrained = 20;
  const double mean = energy / area;
  return outline / 2 / std::sqrt(area) + kExcess * (mean - 4) + kBeyond * std::max(mean - target_energy, 0.0) +
         kStrained * std::max(strained / area - kMostStrained, 0.0);
}

}  // namespace geocloth
