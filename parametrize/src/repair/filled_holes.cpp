// SPDX-License-Identifier: GPL-3.0-or-later
// A chart is a disk, so that every border of a part but one costs a cut. But an eyelet or a hole that moths made needs
// none: the cloth around it lies flat as if it were not there. Neck, hem and sleeves are other borders: what would
// close them stands across the cloth.
#include "repair/filled_holes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/triangle_middles.h"
#include "repair/border_loops.h"

namespace geocloth {
namespace {

constexpr double kMostOfPart = 0.1;  // of a component's area, that one filling may have
constexpr double kGoesOn = 0.9;      // mean cosine between cloth and filling
constexpr double kMostTurn = 0.35;   // [rad] that the angles around a filling's middle may lack to a whole turn

double angle_between(const Point3& a, const Point3& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

/// Mean cosine between the filling and the cloth around it, as far from its middle as the rim twice: a hem that is
/// folded inwards is no more than an edge of that.
double cosine_around(const CleanSurface& filled, std::span<const uint32_t> opposite, const std::vector<uint32_t>& loop,
                     const Point3& filling, std::vector<uint8_t>& met) {
  const Point3& middle = filled.position.back();
  double reach = 0;
  for (const uint32_t h : loop)
    reach = std::max(reach, 2 * distance(filled.position[tail(filled.triangle, h)], middle));
  std::vector<uint32_t> found;
  const auto visit = [&](uint32_t t) {
    if (met[t] != 0) return;
    met[t] = 1;
    found.push_back(t);
  };
  for (const uint32_t h : loop) visit(h / 3);
  const std::size_t beside = found.size();
  Point3 sum{};
  double area = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Triangle& t = filled.triangle[found[i]];
    const Point3 centre = (filled.position[t[0]] + filled.position[t[1]] + filled.position[t[2]]) * (1.0 / 3);
    if (i >= beside && distance(centre, middle) > reach) continue;
    const Point3 normal = normal_of(filled, found[i]);
    sum = sum + normal;
    area += length(normal);
    for (uint32_t h = 3 * found[i]; h < 3 * found[i] + 3; ++h) {
      if (opposite[h] != kNone) visit(opposite[h] / 3);
    }
  }
  for (const uint32_t t : found) met[t] = 0;
  const double sizes = area * length(filling);
  return sizes > 0 ? dot(sum, filling) / sizes : 0;
}

/// Does the cloth go on over the fan, whose triangles are the last ones?
bool goes_on(const CleanSurface& filled, std::span<const uint32_t> opposite, const std::vector<uint32_t>& loop,
             std::vector<uint8_t>& met) {
  const size_t first = filled.triangle.size() - loop.size();
  const Point3& middle = filled.position.back();
  Point3 whole{};
  double along = 0, cosines = 0, turn = 0;
  for (size_t k = 0; k < loop.size(); ++k) {
    const Point3 &a = filled.position[tail(filled.triangle, loop[k])],
                 &b = filled.position[head(filled.triangle, loop[k])];
    const Point3 cloth = normal_of(filled, loop[k] / 3), filling = normal_of(filled, first + k);
    const double l = distance(a, b), sizes = length(cloth) * length(filling);
    along += l;
    if (sizes > 0) cosines += l * dot(cloth, filling) / sizes;
    turn += angle_between(a - middle, b - middle);
    whole = whole + filling;
  }
  return cosines >= kGoesOn * along && std::abs(turn - 2 * std::numbers::pi) <= kMostTurn &&
         cosine_around(filled, opposite, loop, whole, met) >= kGoesOn;
}

void take_back(CleanSurface& filled, size_t triangles) {
  filled.triangle.resize(filled.triangle.size() - triangles);
  filled.component.resize(filled.triangle.size());
  filled.source_triangle.resize(filled.triangle.size());
  if (!filled.uv.empty()) filled.uv.resize(filled.triangle.size());
  filled.position.pop_back();
  filled.point.pop_back();
  --filled.point_count;
}

}  // namespace

FilledSurface fill_holes(const CleanSurface& clean, std::span<const uint32_t> left_open) {
  FilledSurface filled{clean, {}, {}};
  CleanSurface& surface = filled.surface;
  const std::vector<BorderLoop> loops = all_border_loops(clean);
  std::vector<double> around;
  around.reserve(loops.size());
  for (const BorderLoop& loop : loops) around.push_back(length_around(clean, loop.edge));
  std::vector<uint32_t> order(loops.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return around[a] < around[b]; });
  const std::vector<uint32_t> opposite = opposite_half_edges(clean.triangle);
  std::vector<uint8_t> met(clean.triangle.size(), 0);
  std::vector<uint32_t> loops_not_met(clean.component_count, 0);
  std::vector<double> area(clean.component_count, 0);
  for (const BorderLoop& loop : loops) ++loops_not_met[clean.component[loop.edge[0] / 3]];
  for (size_t t = 0; t < clean.triangle.size(); ++t) area[clean.component[t]] += length(normal_of(clean, t)) / 2;
  for (const uint32_t k : order) {
    const std::vector<uint32_t>& loop = loops[k].edge;
    const uint32_t component = clean.component[loop[0] / 3];
    --loops_not_met[component];
    if (loops[k].tied || loops_not_met[component] == 0) continue;
    if (std::binary_search(left_open.begin(), left_open.end(), tail(clean.triangle, loop[0]))) continue;
    if (fill_with_fan(surface, loop, kMostOfPart * area[component]) <= 0) continue;
    if (!goes_on(surface, opposite, loop, met)) {
      take_back(surface, loop.size());
      continue;
    }
    filled.hole.insert(filled.hole.end(), loop.size(), static_cast<uint32_t>(filled.rim.size()));
    filled.rim.push_back(tail(clean.triangle, loop[0]));
  }
  return filled;
}

}  // namespace geocloth
