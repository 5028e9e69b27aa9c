// SPDX-License-Identifier: GPL-3.0-or-later
//
// Directions without a head are averaged with their angles doubled.
//
// Where the Gaussian curvature of a surface is not zero a map has to stretch, to shear, or both. The symmetric
// Dirichlet energy has no opinion which, since it knows no directions, but woven cloth has two: any surface can be laid
// out with its threads orthogonal everywhere (geodesic coordinates), and about a fifth more of the little stretch that
// near-isometric charts have anyway buys most of the way there.

#include "grain.h"

#include <algorithm>
#include <cmath>

#include "chart_overlap.h"
#include "point_math.h"
#include "symmetric_dirichlet.h"

namespace geocloth {
namespace {

constexpr double kLevel = 0.1;  // strength below which a panel counts as level
constexpr double kSlender = 6;  // ratio of the spreads along and across
constexpr double kShearPrice = 6;
constexpr uint32_t kThreadSteps = 8;
constexpr int kThreadRounds = 2;

struct LongAxis {
  Point2 direction;
  double ratio;  // of the spreads along it and across
};

LongAxis long_axis(const Chart& c) {
  double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
  const auto n = static_cast<double>(c.uv.size());
  for (const Point2& p : c.uv) {
    mx += p[0] / n;
    my += p[1] / n;
  }
  for (const Point2& p : c.uv) {
    xx += (p[0] - mx) * (p[0] - mx);
    xy += (p[0] - mx) * (p[1] - my);
    yy += (p[1] - my) * (p[1] - my);
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  const double mean = (xx + yy) / 2, spread = std::hypot((xx - yy) / 2, xy);
  return {{std::cos(angle), std::sin(angle)}, std::sqrt((mean + spread) / std::max(mean - spread, 1e-12 * mean))};
}

double along(const Point2& a, const Point2& b) {
  return a[0] * b[0] + a[1] * b[1];
}

}  // namespace

Grain grain_of(const Chart& c) {
  Point2 mean{0, 0}, doubled{0, 0};
  double area = 0;
  for (const Triangle& t : c.triangle) {
    const Point2 &a = c.uv[t[0]], &b = c.uv[t[1]], &d = c.uv[t[2]];
    const double h1 = c.position[t[1]][1] - c.position[t[0]][1];
    const double h2 = c.position[t[2]][1] - c.position[t[0]][1];
    // Gradient of the height over the plane, times the triangle's area.
    const Point2 up{(h1 * (d[1] - a[1]) - h2 * (b[1] - a[1])) / 2, (h2 * (b[0] - a[0]) - h1 * (d[0] - a[0])) / 2};
    const double size = std::hypot(up[0], up[1]);
    area += ((b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0])) / 2;
    if (!(size > 0)) continue;
    mean = {mean[0] + up[0], mean[1] + up[1]};
    doubled = {doubled[0] + (up[0] * up[0] - up[1] * up[1]) / size, doubled[1] + 2 * up[0] * up[1] / size};
  }
  const double angle = 0.5 * std::atan2(doubled[1], doubled[0]);
  Grain grain{{std::cos(angle), std::sin(angle)}, std::hypot(doubled[0], doubled[1]) / area};
  if (along(mean, grain.axis) < 0) grain.axis = {-grain.axis[0], -grain.axis[1]};
  return grain;
}

void turn_upright(Chart& c) {
  const Grain grain = grain_of(c);
  Point2 up = grain.axis;
  const LongAxis axis = long_axis(c);
  if (grain.strength < kLevel || axis.ratio > kSlender) {
    // The end that is higher stays up.
    up = axis.direction;
    if (along(grain.axis, up) < 0) up = {-up[0], -up[1]};
  }
  for (Point2& p : c.uv) p = {p[0] * up[1] - p[1] * up[0], along(p, up)};
}

void straighten_threads(Chart& c) {
  const std::vector<Point2> before = c.uv;
  SymmetricDirichlet energy(c.position, c.triangle, {});
  energy.set_shear_price(kShearPrice);
  // The energy knows the plane's axes, so that it turns the chart a little: that is undone, and what it lost regained.
  for (int round = 0; round < kThreadRounds; ++round) {
    if (round > 0) turn_upright(c);
    energy.minimise(c.uv, kThreadSteps, 1e-6);
  }
  if (crossing_edges(c, outline_loop(c))) c.uv = before;
}

}  // namespace geocloth
