// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "geocloth/asset/vec3d.h"

namespace geocloth {

struct TriangleCorners {
  Vec3d a, b, c;
};
[[nodiscard]] inline const TriangleCorners& corners_in(const TriangleCorners& t) {
  return t;
}
[[nodiscard]] inline TriangleCorners corners_of(const std::array<uint32_t, 3>& triangle,
                                                std::span<const Vec3> position) {
  return {to_double(position[triangle[0]]), to_double(position[triangle[1]]), to_double(position[triangle[2]])};
}

[[nodiscard]] inline Vec3d closest_on_segment(const Vec3d& a, const Vec3d& b, const Vec3d& p) {
  const Vec3d way = b - a;
  const double square = dot(way, way);
  return square > 0 ? a + std::clamp(dot(way, p - a) / square, 0.0, 1.0) * way : a;
}

/// Ericson 2005, "Real-Time Collision Detection", 5.1.5: the region of the triangle's plane that the point lies over. A
/// triangle without an area is its longest edge.
[[nodiscard]] inline Vec3d closest_on_triangle(const TriangleCorners& t, const Vec3d& p) {
  const Vec3d ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a, bp = p - t.b, cp = p - t.c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return t.a;
  if (d3 >= 0 && d4 <= d3) return t.b;
  if (d6 >= 0 && d5 <= d6) return t.c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return t.a + (d1 / (d1 - d3)) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return t.a + (d2 / (d2 - d6)) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6 && (d4 - d3) + (d5 - d6) > 0)
    return t.b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (t.c - t.b);
  const double sum = va + vb + vc;
  if (!(sum > 0)) {
    const Vec3d bc = t.c - t.b;
    const double c2 = dot(ab, ab), b2 = dot(ac, ac), a2 = dot(bc, bc);
    return a2 >= b2 && a2 >= c2 ? closest_on_segment(t.b, t.c, p) : closest_on_segment(t.a, b2 > c2 ? t.c : t.b, p);
  }
  return t.a + (vb / sum) * ab + (vc / sum) * ac;
}

/// Shares of the corners in a point of the triangle's plane; of one without area all is the first one's.
[[nodiscard]] inline Vec3d corner_shares(const TriangleCorners& t, const Vec3d& p) {
  const Vec3d ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a, normal = cross(ab, ac);
  const double area2 = dot(normal, normal);
  if (!(area2 > 1e-24 * dot(ab, ab) * dot(ac, ac))) return {1, 0, 0};
  const double v = dot(cross(ap, ac), normal) / area2, w = dot(cross(ab, ap), normal) / area2;
  return {1 - v - w, v, w};
}

}  // namespace geocloth
