// SPDX-License-Identifier: GPL-3.0-or-later
#include "repair/border_loops.h"

#include <algorithm>

#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {

std::vector<BorderLoop> all_border_loops(const CleanSurface& surface) {
  std::vector<uint8_t> copies(surface.point_count, 0);
  for (const uint32_t p : surface.point) copies[p] = static_cast<uint8_t>(std::min(copies[p] + 1, 2));
  const std::vector<uint32_t> opposite = opposite_half_edges(surface.triangle);
  std::vector<uint32_t> leaving(surface.position.size(), kNone);
  for (uint32_t h = 0; h < opposite.size(); ++h) {
    if (opposite[h] == kNone) leaving[tail(surface.triangle, h)] = h;
  }
  std::vector<BorderLoop> loops;
  for (uint32_t start = 0; start < leaving.size(); ++start) {
    BorderLoop loop;
    for (uint32_t v = start; leaving[v] != kNone;) {
      loop.edge.push_back(leaving[v]);
      loop.tied = loop.tied || copies[surface.point[v]] > 1;
      leaving[v] = kNone;
      v = head(surface.triangle, loop.edge.back());
    }
    if (!loop.edge.empty()) loops.push_back(std::move(loop));
  }
  return loops;
}

std::vector<std::vector<uint32_t>> border_loops(const CleanSurface& surface) {
  std::vector<std::vector<uint32_t>> loops;
  for (BorderLoop& loop : all_border_loops(surface)) {
    if (!loop.tied) loops.push_back(std::move(loop.edge));
  }
  return loops;
}

double length_around(const CleanSurface& surface, const std::vector<uint32_t>& loop) {
  double around = 0;
  for (const uint32_t h : loop) {
    around += distance(surface.position[tail(surface.triangle, h)], surface.position[head(surface.triangle, h)]);
  }
  return around;
}

double fill_with_fan(CleanSurface& surface, const std::vector<uint32_t>& loop, double most_area) {
  constexpr double kNeedle = 1e-4;
  const double share = 1 / static_cast<double>(loop.size()), around = length_around(surface, loop);
  Point3 middle{};
  Point2 middle_uv{};
  const bool has_uv = !surface.uv.empty();
  for (const uint32_t h : loop) {
    middle = middle + surface.position[tail(surface.triangle, h)] * share;
    if (has_uv) {
      const Point2& uv = surface.uv[h / 3][h % 3];
      middle_uv = {middle_uv[0] + uv[0] * share, middle_uv[1] + uv[1] * share};
    }
  }
  double area = 0;
  for (const uint32_t h : loop) {
    const double a =
        triangle_area(surface.position[tail(surface.triangle, h)], surface.position[head(surface.triangle, h)], middle);
    if (!(a > kNeedle * around * around)) return 0;
    area += a;
  }
  if (area > most_area) return 0;
  const auto centre = static_cast<uint32_t>(surface.position.size());
  surface.position.push_back(middle);
  surface.point.push_back(surface.point_count++);
  for (const uint32_t h : loop) {
    surface.triangle.push_back({head(surface.triangle, h), tail(surface.triangle, h), centre});
    surface.component.push_back(surface.component[h / 3]);
    surface.source_triangle.push_back(kNone);
    if (!has_uv) continue;
    const uint32_t end = next_half_edge(h);
    surface.uv.push_back({surface.uv[end / 3][end % 3], surface.uv[h / 3][h % 3], middle_uv});
  }
  return area;
}

}  // namespace geocloth
