// SPDX-License-Identifier: GPL-3.0-or-later
//
// The largest patch of triangles that lay side by side in one chart before, and still do, keeps its place. Triangles
// that a straightened cut left on the other side are laid against it one by one as they are in space.

#include "develop/carry_layout.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "develop/embed_chart.h"
#include "geocloth/asset/disjoint_sets.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kSamePlace = 1e-6;  // share of the chart's size

/// The place in the plane of a point of a former triangle.
Point2 place_in(const std::array<Point3, 3>& corner, const std::array<Point2, 3>& uv, const Point3& p) {
  for (size_t i = 0; i < 3; ++i) {
    if (p == corner[i]) return uv[i];  // exact, however thin the triangle
  }
  const Point3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const double whole = dot(normal, normal);
  const double w1 = dot(cross(p - corner[0], corner[2] - corner[0]), normal) / whole;
  const double w2 = dot(cross(corner[1] - corner[0], p - corner[0]), normal) / whole;
  return {uv[0][0] + w1 * (uv[1][0] - uv[0][0]) + w2 * (uv[2][0] - uv[0][0]),
          uv[0][1] + w1 * (uv[1][1] - uv[0][1]) + w2 * (uv[2][1] - uv[0][1])};
}

/// The third corner of a triangle whose first two lie at a and b, to the left of a to b, as it is in space.
Point2 unfolded(const Point2& a, const Point2& b, const Point3& pa, const Point3& pb, const Point3& pc) {
  const Point3 edge = pb - pa, side = pc - pa;
  const double l = length(edge);
  const double along = dot(edge, side) / (l * l), height = length(cross(edge, side)) / (l * l);
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  return {a[0] + along * dx - height * dy, a[1] + along * dy + height * dx};
}

/// Every vertex that is not fixed to the weighted mean of where its triangles want it.
void even_out(Chart& chart, const std::vector<uint8_t>& fixed) {
  constexpr int kRounds = 20;
  std::vector<Point2> sum(chart.uv.size());
  std::vector<double> weight(chart.uv.size());
  for (int round = 0; round < kRounds; ++round) {
    std::fill(sum.begin(), sum.end(), Point2{0, 0});
    std::fill(weight.begin(), weight.end(), 0.0);
    for (const Triangle& t : chart.triangle) {
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t a = t[(i + 1) % 3], b = t[(i + 2) % 3], v = t[i];
        if (fixed[v] != 0) continue;
        const Point2 p = unfolded(chart.uv[a], chart.uv[b], chart.position[a], chart.position[b], chart.position[v]);
        // What is unfolded from a short edge is uncertain.
        const Point3 &pa = chart.position[a], &pb = chart.position[b], &pv = chart.position[v];
        const double edge = distance(pa, pb), left = distance(pa, pv), right = distance(pb, pv);
        const double w = edge * edge / (left * left + right * right);
        sum[v] = {sum[v][0] + w * p[0], sum[v][1] + w * p[1]};
        weight[v] += w;
      }
    }
    for (size_t v = 0; v < sum.size(); ++v) {
      if (weight[v] > 0) chart.uv[v] = {sum[v][0] / weight[v], sum[v][1] / weight[v]};
    }
  }
}

}  // namespace

bool carry_layout(Chart& chart, const std::vector<uint32_t>& former_triangle, const FormerLayout& former) {
  const size_t count = chart.triangle.size();
  std::vector<std::array<Point2, 3>> was(count);
  double area = 0;
  std::vector<double> size(count);
  for (size_t t = 0; t < count; ++t) {
    const uint32_t f = former_triangle[t];
    const Triangle& k = chart.triangle[t];
    for (size_t i = 0; i < 3; ++i) was[t][i] = place_in(former.position[f], former.uv[f], chart.position[k[i]]);
    size[t] = triangle_area(chart.position[k[0]], chart.position[k[1]], chart.position[k[2]]);
    area += size[t];
  }
  const double tolerance = kSamePlace * std::sqrt(area);
  const auto together = [&](const Point2& a, const Point2& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1]) < tolerance;
  };
  DisjointSets patch(count);
  for (uint32_t h = 0; h < chart.opposite.size(); ++h) {
    const uint32_t o = chart.opposite[h];
    if (o == kNone || o < h) continue;
    if (former.chart[former_triangle[h / 3]] != former.chart[former_triangle[o / 3]]) continue;
    if (together(was[h / 3][h % 3], was[o / 3][next_half_edge(o) % 3]) &&
        together(was[h / 3][next_half_edge(h) % 3], was[o / 3][o % 3])) {
      patch.join(h / 3, o / 3);
    }
  }
  std::vector<double> patch_area(count, 0);
  for (uint32_t t = 0; t < count; ++t) patch_area[patch.find(t)] += size[t];
  const auto largest =
      static_cast<uint32_t>(std::max_element(patch_area.begin(), patch_area.end()) - patch_area.begin());

  chart.uv.assign(chart.position.size(), Point2{0, 0});
  std::vector<uint8_t> known(chart.position.size(), 0);
  std::vector<uint8_t> placed(count, 0), fixed(chart.position.size(), 0);
  std::vector<uint32_t> next;  // triangles that are in place
  for (uint32_t t = 0; t < count; ++t) {
    if (patch.find(t) != largest) continue;
    next.push_back(t);
    placed[t] = 1;
    for (size_t i = 0; i < 3; ++i) {
      known[chart.triangle[t][i]] = fixed[chart.triangle[t][i]] = 1;
      chart.uv[chart.triangle[t][i]] = was[t][i];
    }
  }
  for (size_t i = 0; i < next.size(); ++i) {
    for (uint32_t h = 3 * next[i]; h < 3 * next[i] + 3; ++h) {
      const uint32_t o = chart.opposite[h];
      if (o == kNone || placed[o / 3] != 0) continue;
      placed[o / 3] = 1;
      next.push_back(o / 3);
      const uint32_t apex = tail(chart.triangle, previous_half_edge(o));
      if (known[apex] != 0) continue;
      const uint32_t a = tail(chart.triangle, o), b = head(chart.triangle, o);
      known[apex] = 1;
      chart.uv[apex] = unfolded(chart.uv[a], chart.uv[b], chart.position[a], chart.position[b], chart.position[apex]);
    }
  }
  even_out(chart, fixed);
  if (std::all_of(known.begin(), known.end(), [](uint8_t k) { return k != 0; }) && flip_free(chart)) return true;
  chart.uv.clear();
  return false;
}

}  // namespace geocloth
