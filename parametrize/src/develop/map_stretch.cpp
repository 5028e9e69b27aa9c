// SPDX-License-Identifier: GPL-3.0-or-later
// How a flat triangle is stretched on its way to space: Sander, Snyder, Gortler, Hoppe, "Texture mapping progressive
// meshes", 2001, equations 1 to 3.
#include "develop/map_stretch.h"

#include <cmath>

#include "mesh/point_math.h"

namespace geocloth {

double map_unit(const FlatSurface& flat) {
  double in_space = 0, in_chart = 0;
  for (const Triangle& t : flat.triangle) {
    in_chart += std::abs(signed_area_twice(flat.uv[t[0]], flat.uv[t[1]], flat.uv[t[2]])) / 2;
    in_space += triangle_area(flat.position[t[0]], flat.position[t[1]], flat.position[t[2]]);
  }
  return in_chart > 0 ? std::sqrt(in_space / in_chart) : 0;
}

std::array<double, 2> singular_values(const FlatSurface& flat, const Triangle& t, double unit) {
  const Point3 e1 = flat.position[t[1]] - flat.position[t[0]], e2 = flat.position[t[2]] - flat.position[t[0]];
  const auto in_chart = [&](uint32_t v) {
    return Point2{flat.uv[v][0] * unit, -flat.uv[v][1] * unit};  // v up
  };
  const Point2 o = in_chart(t[0]), p = in_chart(t[1]), q = in_chart(t[2]);
  const Point2 f1{p[0] - o[0], p[1] - o[1]}, f2{q[0] - o[0], q[1] - o[1]};
  const double d = f1[0] * f2[1] - f1[1] * f2[0];
  if (d == 0) return {0, 0};
  const Point3 xs = (e1 * f2[1] - e2 * f1[1]) * (1 / d), xt = (e2 * f1[0] - e1 * f2[0]) * (1 / d);
  const double a = dot(xs, xs), b = dot(xs, xt), c = dot(xt, xt);
  const double root = std::sqrt((a - c) * (a - c) + 4 * b * b);
  // The small value from the area, because the difference of the formula cancels for needles.
  const double large = std::sqrt((a + c + root) / 2);
  const double small = large > 0 ? length(cross(xs, xt)) / large : 0;
  return {large, small};
}

}  // namespace geocloth
