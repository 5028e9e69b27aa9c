// SPDX-License-Identifier: GPL-3.0-or-later
//
// Straightened seams move slivers of cloth from chart to chart. The charts' places in the plane are carried over
// (carry_layout.cpp), so that a few Newton steps settle what changed.

#include "develop/straight_layout.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_for.h>

#include "cut/edge_wishes.h"
#include "develop/carry_layout.h"
#include "develop/chart_energy.h"
#include "develop/chart_overlap.h"
#include "develop/embed_chart.h"
#include "develop/layout_cost.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr int kRounds = 8;
/// How far seams may move, in vertices: less each time that fails. All but the first stay on creases.
constexpr std::array<uint32_t, 5> kRings{kNone, 1000, 3, 1, 0};
constexpr double kStrained = 0.25;  // a chart's excess energy may rise by this share of it
constexpr double kNoise = 5e-3;     // and by this in any case

FormerLayout layout_of(const CutSurface& cut, const std::vector<Chart>& charts) {
  FormerLayout former;
  former.chart.resize(cut.triangle.size());
  former.position.resize(cut.triangle.size());
  former.uv.resize(cut.triangle.size());
  for (uint32_t c = 0; c < charts.size(); ++c) {
    for (size_t t = 0; t < charts[c].triangle.size(); ++t) {
      const uint32_t f = charts[c].global_triangle[t];
      former.chart[f] = c;
      for (size_t i = 0; i < 3; ++i) {
        former.position[f][i] = charts[c].position[charts[c].triangle[t][i]];
        former.uv[f][i] = charts[c].uv[charts[c].triangle[t][i]];
      }
    }
  }
  return former;
}

/// How a chart lies.
struct Standing {
  double energy = 0;
  double cost = 0;  // layout_cost.h
};

Standing standing_of(const Chart& chart, double target_energy) {
  LayoutCost cost;
  cost.add(chart, outline_length(chart));
  return {cost.energy / cost.area, cost.value(target_energy)};
}

/// Distortion may rise a little, or by what the shorter outline is worth.
bool is_as_good(const Standing& now, const Standing& before) {
  return now.energy <= before.energy + kStrained * (before.energy - 4) + kNoise || now.cost <= before.cost;
}

/// The chart to which most of a new one belonged.
uint32_t former_chart(const Chart& chart, const std::vector<uint32_t>& former_triangle, const FormerLayout& former) {
  std::vector<std::pair<uint32_t, double>> share;  // chart, area
  for (size_t t = 0; t < chart.triangle.size(); ++t) {
    const Triangle& k = chart.triangle[t];
    const double area = triangle_area(chart.position[k[0]], chart.position[k[1]], chart.position[k[2]]);
    share.emplace_back(former.chart[former_triangle[t]], area);
  }
  std::sort(share.begin(), share.end());
  uint32_t best = share.front().first;
  double most = 0, sum = 0;
  for (size_t i = 0; i < share.size(); ++i) {
    sum = i > 0 && share[i - 1].first == share[i].first ? sum + share[i].second : share[i].second;
    if (sum > most) {
      most = sum;
      best = share[i].first;
    }
  }
  return best;
}

/// Has a chart the triangles of a former one, whole and no others?
bool same_triangles(const Chart& chart, const Chart& former_chart, const std::vector<uint32_t>& former_triangle,
                    const FormerLayout& former) {
  if (chart.triangle.size() != former_chart.triangle.size()) return false;
  for (size_t t = 0; t < former_triangle.size(); ++t) {
    for (size_t i = 0; i < 3; ++i) {
      if (chart.position[chart.triangle[t][i]] != former.position[former_triangle[t]][i]) return false;
    }
  }
  return true;
}

/// A chart after its outline has changed; false when it does not lie as well as before. One that did not change stays
/// where it was when it would come to lie over itself on its way down.
bool settle(Chart& chart, const std::vector<uint32_t>& former_triangle, const FormerLayout& former,
            const Standing& before, double target_energy, bool changed) {
  constexpr uint32_t kStraightSteps = 30;
  if (!carry_layout(chart, former_triangle, former) && !embed_on_circle(chart)) return false;
  if (!changed) {
    const std::vector<Point2> places = chart.uv;
    chart_energy(chart).minimise(chart.uv, kStraightSteps, 1e-6);
    if (crossing_edges(chart, outline_loop(chart))) chart.uv = places;
    return true;
  }
  chart_energy(chart).minimise(chart.uv, kStraightSteps, 1e-6);
  return is_as_good(standing_of(chart, target_energy), before) && !crossing_edges(chart, outline_loop(chart));
}

}  // namespace

ChartedSurface straighten_layout(const CutSurface& cut, const Sheet& sheet, const std::vector<Chart>& charts,
                                 const CutPreferences& prefer, double target_energy) {
  const FormerLayout former = layout_of(cut, charts);
  std::vector<Standing> standing;
  standing.reserve(charts.size());
  for (const Chart& c : charts) standing.push_back(standing_of(c, target_energy));
  std::vector<size_t> failures(charts.size(), 0);
  std::vector<uint32_t> rings(charts.size(), kRings.front());
  for (int round = 0;; ++round) {
    for (size_t c = 0; c < charts.size(); ++c) {
      rings[c] = round == kRounds ? kRings.back() : kRings.at(std::min(failures[c], kRings.size() - 1));
    }
    auto [mesh, lines] = sewn_together(cut, sheet, charts, rings);
    hold_wished_cuts(mesh, prefer, lines);
    straighten_cuts(mesh, lines);
    ChartedSurface result{open_along(mesh, lines.cut), {}};
    if (!cut.hole.empty()) {
      for (const uint32_t t : result.cut.clean_triangle) result.cut.hole.push_back(cut.hole[t]);
    }
    for (std::vector<uint32_t>& part : triangles_of_components(result.cut)) {
      result.charts.push_back(extract_chart(result.cut, std::move(part)));
    }
    std::vector<uint32_t> was(result.charts.size());
    std::vector<uint8_t> good(result.charts.size(), 0);
    tbb::parallel_for(size_t{0}, result.charts.size(), [&](size_t i) {
      Chart& chart = result.charts[i];
      std::vector<uint32_t> former_triangle;
      former_triangle.reserve(chart.triangle.size());
      for (const uint32_t t : chart.global_triangle) former_triangle.push_back(result.cut.clean_triangle[t]);
      was[i] = former_chart(chart, former_triangle, former);
      const bool changed = !same_triangles(chart, charts[was[i]], former_triangle, former);
      good[i] = settle(chart, former_triangle, former, standing[was[i]], target_energy, changed) ? 1 : 0;
    });
    for (size_t i = 0; i < good.size(); ++i) {
      if (good[i] == 0) ++failures[was[i]];
    }
    if (round < kRounds && std::find(good.begin(), good.end(), uint8_t{0}) != good.end()) continue;
    for (uint32_t& t : result.cut.clean_triangle) t = cut.clean_triangle[t];
    return result;
  }
}

}  // namespace geocloth
