// SPDX-License-Identifier: GPL-3.0-or-later
// Texture coordinates belong to corners; charts have one place per vertex. After the cut along their seams the two are
// the same but for rounding. A piece without flips whose outline does not cross itself covers nothing twice.
#include "flatten/uv_layout.h"

#include <cmath>
#include <string>

#include "develop/chart_overlap.h"
#include "develop/embed_chart.h"
#include "develop/symmetric_dirichlet.h"
#include "geocloth/asset/error.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorCode::unsupported, why + "; use --layout panels, which cuts and flattens the cloth itself");
}

/// Texture coordinates at a place on a triangle of the clean surface.
Point2 uv_at(const CleanSurface& clean, uint32_t t, const Point3& p) {
  const auto& [a, b, c] = clean.triangle[t];
  const Point3 weight = weights_in_space({clean.position[a], clean.position[b], clean.position[c]}, p);
  Point2 result{0, 0};
  for (size_t j = 0; j < 3; ++j) {
    for (size_t k = 0; k < 2; ++k) result[k] += weight[j] * clean.uv[t][j][k];
  }
  return result;
}

/// The island that a chart is part of.
uint32_t island_of(const CutSurface& cut, const Chart& chart, const UvPattern& pattern) {
  const uint32_t island = pattern.island_of[cut.clean_triangle[chart.global_triangle[0]]];
  for (const uint32_t t : chart.global_triangle) {
    if (pattern.island_of[cut.clean_triangle[t]] == island) continue;
    throw Error(ErrorCode::invalid_argument, "the surface is not cut along the seams of its texture coordinates");
  }
  return island;
}

std::vector<Point2> places_in_texture(const CleanSurface& clean, const CutSurface& cut, const Chart& chart,
                                      const UvPattern::Island& island) {
  std::vector<Point2> places(chart.position.size());
  for (size_t t = 0; t < chart.triangle.size(); ++t) {
    for (const uint32_t v : chart.triangle[t]) {
      const Point2 uv = uv_at(clean, cut.clean_triangle[chart.global_triangle[t]], chart.position[v]);
      places[v] = {(island.mirrored ? -island.scale : island.scale) * uv[0], -island.scale * uv[1]};
    }
  }
  return places;
}

/// Turns and moves `places` so that they lie over `aim` as well as a rigid motion allows.
void lay_over(std::vector<Point2>& places, const std::vector<Point2>& aim) {
  const auto n = static_cast<double>(places.size());
  Point2 from{0, 0}, to{0, 0};
  for (size_t v = 0; v < places.size(); ++v) {
    for (size_t k = 0; k < 2; ++k) {
      from[k] += places[v][k] / n;
      to[k] += aim[v][k] / n;
    }
  }
  double cosine = 0, sine = 0;
  for (size_t v = 0; v < places.size(); ++v) {
    const double x = places[v][0] - from[0], y = places[v][1] - from[1], a = aim[v][0] - to[0], b = aim[v][1] - to[1];
    cosine += x * a + y * b;
    sine += x * b - y * a;
  }
  const double l = std::hypot(cosine, sine);
  cosine = l > 0 ? cosine / l : 1;
  sine = l > 0 ? sine / l : 0;
  for (Point2& p : places) {
    const double x = p[0] - from[0], y = p[1] - from[1];
    p = {to[0] + cosine * x - sine * y, to[1] + sine * x + cosine * y};
  }
}

double area_in_plane(const Chart& chart, const Triangle& t) {
  const Point2 &a = chart.uv[t[0]], &b = chart.uv[t[1]], &c = chart.uv[t[2]];
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Evens out the vertices around flipped triangles, in circles that grow: each goes to the mean of its neighbours.
/// Outline vertices stay.
void smooth_flips(Chart& chart) {
  constexpr int kLargestCircle = 5, kSweeps = 60;
  const std::vector<uint8_t> fixed = on_outline(chart);
  const std::vector<std::vector<ChartNeighbour>> around = neighbours(chart);
  std::vector<uint8_t> near(chart.position.size(), 0);
  for (int circle = 0; circle < kLargestCircle && !flip_free(chart); ++circle) {
    std::vector<uint8_t> wider = near;
    for (const Triangle& t : chart.triangle) {
      const bool reached = near[t[0]] != 0 || near[t[1]] != 0 || near[t[2]] != 0;
      if (!reached && area_in_plane(chart, t) > 0) continue;
      for (const uint32_t v : t) wider[v] = 1;
    }
    near = std::move(wider);
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (uint32_t v = 0; v < near.size(); ++v) {
        if (near[v] == 0 || fixed[v] != 0) continue;
        Point2 sum{0, 0};
        for (const ChartNeighbour& n : around[v])
          sum = {sum[0] + chart.uv[n.vertex][0], sum[1] + chart.uv[n.vertex][1]};
        const auto count = static_cast<double>(around[v].size());
        chart.uv[v] = {sum[0] / count, sum[1] / count};
      }
    }
  }
}

bool overlaps(const Chart& chart) {
  return crossing_edges(chart, outline_loop(chart)).has_value();
}

/// A chart without flips that lies where the given one does.
void untangle(Chart& chart) {
  constexpr uint32_t kIterations = 100;
  const std::vector<Point2> aim = chart.uv;
  smooth_flips(chart);
  if (flip_free(chart)) return;
  const bool laid = embed_on_circle(chart);
  if (laid) SymmetricDirichlet(chart.position, chart.triangle, {}).minimise(chart.uv, kIterations);
  if (!laid || overlaps(chart)) refuse("triangles are flipped in the texture coordinates");
  lay_over(chart.uv, aim);
}

}  // namespace

UvPattern usable_uv_pattern(const CleanSurface& clean) {
  UvPattern pattern = read_uv_pattern(clean);
  if (!pattern.refusal.empty()) refuse(pattern.refusal);
  return pattern;
}

DevelopedSurface take_uv(const CleanSurface& clean, const CutSurface& cut, const UvPattern& pattern) {
  DevelopedSurface result{cut, std::vector<Point2>(cut.position.size()), {}};
  for (std::vector<uint32_t>& triangles : triangles_of_components(cut)) {
    Chart chart = extract_chart(cut, std::move(triangles));
    chart.uv = places_in_texture(clean, cut, chart, pattern.island[island_of(cut, chart, pattern)]);
    if (!flip_free(chart)) untangle(chart);
    if (overlaps(chart)) refuse("the texture coordinates overlap within a piece");
    for (size_t v = 0; v < chart.uv.size(); ++v) result.uv[chart.cut_vertex[v]] = chart.uv[v];
    result.energy.push_back(SymmetricDirichlet(chart.position, chart.triangle, {}).energy(chart.uv));
  }
  return result;
}

}  // namespace geocloth
