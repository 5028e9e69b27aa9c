// SPDX-License-Identifier: Apache-2.0
// Vectors in double precision, for geometry that is worked out once.
#pragma once

#include <cmath>

#include "geocloth/asset/vec.h"

namespace geocloth {

struct Vec3d {
  double x = 0, y = 0, z = 0;
};

[[nodiscard]] inline Vec3d to_double(const Vec3& v) {
  return {v.x, v.y, v.z};
}
[[nodiscard]] inline Vec3 to_float(const Vec3d& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
[[nodiscard]] inline Vec3d operator+(const Vec3d& a, const Vec3d& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vec3d& operator+=(Vec3d& a, const Vec3d& b) {
  return a = a + b;
}
[[nodiscard]] inline Vec3d operator-(const Vec3d& a, const Vec3d& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
[[nodiscard]] inline Vec3d operator*(const Vec3d& a, double s) {
  return {a.x * s, a.y * s, a.z * s};
}
[[nodiscard]] inline Vec3d operator*(double s, const Vec3d& a) {
  return a * s;
}
[[nodiscard]] inline double dot(const Vec3d& a, const Vec3d& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline double length(const Vec3d& a) {
  return std::sqrt(dot(a, a));
}
/// a / |a|, or `otherwise` when a has no direction.
[[nodiscard]] inline Vec3d unit(const Vec3d& a, const Vec3d& otherwise) {
  const double l = length(a);
  return l > 0 ? a * (1 / l) : otherwise;
}
/// Some unit vector across the unit vector n.
[[nodiscard]] inline Vec3d any_across(const Vec3d& n) {
  return unit(cross(n, std::abs(n.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}), {0, 0, 1});
}

}  // namespace geocloth
