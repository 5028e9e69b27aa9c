// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[nodiscard]] inline Point3 operator+(const Point3& a, const Point3& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
[[nodiscard]] inline Point3 operator-(const Point3& a, const Point3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
[[nodiscard]] inline Point3 operator*(const Point3& a, double s) {
  return {a[0] * s, a[1] * s, a[2] * s};
}
[[nodiscard]] inline double dot(const Point3& a, const Point3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] inline Point3 cross(const Point3& a, const Point3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
[[nodiscard]] inline double length(const Point3& a) {
  return std::sqrt(dot(a, a));
}
[[nodiscard]] inline double distance(const Point3& a, const Point3& b) {
  return length(a - b);
}
[[nodiscard]] inline Point3 to_double(const Vec3& a) {
  return {a.x, a.y, a.z};
}
[[nodiscard]] inline Vec3 to_single(const Point3& a) {
  return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}
[[nodiscard]] inline Vec2 to_single(const Point2& a) {
  return {static_cast<float>(a[0]), static_cast<float>(a[1])};
}
/// a / |a|, or nothing when a has no direction.
[[nodiscard]] inline std::optional<Point3> direction_of(const Point3& a) {
  const double l = length(a);
  if (!std::isfinite(l) || !(l > 0)) return std::nullopt;
  return a * (1 / l);
}
[[nodiscard]] inline double triangle_area(const Point3& a, const Point3& b, const Point3& c) {
  return 0.5 * length(cross(b - a, c - a));
}

/// Of all triangles [m^2].
[[nodiscard]] inline double surface_area(const std::vector<Point3>& position, const std::vector<Triangle>& triangle) {
  double area = 0;
  for (const Triangle& t : triangle) area += triangle_area(position[t[0]], position[t[1]], position[t[2]]);
  return area;
}

/// Where along the line a-b (a: 0, b: 1) the point nearest to p lies, and how far p is from the line.
struct Foot {
  double at, height;
};
[[nodiscard]] inline Foot foot_on(const Point3& a, const Point3& b, const Point3& p) {
  const Point3 d = b - a;
  const double at = dot(p - a, d) / dot(d, d);
  return {at, distance(p, a + d * at)};
}

[[nodiscard]] inline Point2 operator-(const Point2& a, const Point2& b) {
  return {a[0] - b[0], a[1] - b[1]};
}
[[nodiscard]] inline double dot(const Point2& a, const Point2& b) {
  return a[0] * b[0] + a[1] * b[1];
}

/// Barycentric coordinates of the point of a triangle's plane below p; the first corner's for a triangle without area.
[[nodiscard]] inline Point3 weights_in_space(const std::array<Point3, 3>& t, const Point3& p) {
  const Point3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double whole = dot(normal, normal);
  if (!(whole > 0)) return {1, 0, 0};
  const double second = dot(cross(p - t[0], t[2] - t[0]), normal) / whole;
  const double third = dot(cross(t[1] - t[0], p - t[0]), normal) / whole;
  return {1 - second - third, second, third};
}

/// Diagonal of the box around the points; 0 when there are none.
[[nodiscard]] inline double bounding_diagonal(const std::vector<Point3>& points) {
  if (points.empty()) return 0;
  Point3 low = points[0], high = points[0];
  for (const Point3& p : points) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  return distance(low, high);
}

/// Twice the signed area of a triangle in a chart; positive when it is counter-clockwise seen with v up. Stored v runs
/// down, hence the sign.
[[nodiscard]] inline double signed_area_twice(const Point2& a, const Point2& b, const Point2& c) {
  return (c[0] - a[0]) * (b[1] - a[1]) - (b[0] - a[0]) * (c[1] - a[1]);
}

}  // namespace geocloth
