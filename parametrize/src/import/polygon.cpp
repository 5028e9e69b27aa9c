// SPDX-License-Identifier: GPL-3.0-or-later
// Triangulation of one polygon by ear clipping (Meisters 1975) in the plane of its Newell normal.
// Of all valid ears the one with the shortest diagonal goes first, which gives quads their better diagonal; ties are
// broken by position, so that the same polygon listed from another corner gives the same triangles.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "import/import_detail.h"

namespace geocloth::import_detail {
namespace {

struct Plane {
  Point3 normal;
  double length;
};

/// Newell's normal: twice the vector area, right for any simple polygon.
Plane newell_plane(std::span<const Point3> corner) {
  Point3 n{};
  const Point3 o = corner[0];
  for (std::size_t i = 0; i < corner.size(); ++i) {
    const Point3 &p = corner[i], &q = corner[(i + 1) % corner.size()];
    const Point3 a{p[0] - o[0], p[1] - o[1], p[2] - o[2]}, b{q[0] - o[0], q[1] - o[1], q[2] - o[2]};
    n[0] += a[1] * b[2] - a[2] * b[1];
    n[1] += a[2] * b[0] - a[0] * b[2];
    n[2] += a[0] * b[1] - a[1] * b[0];
  }
  return {n, std::hypot(n[0], n[1], n[2])};
}

/// Drops the coordinate along which the normal is greatest; keeps counter-clockwise polygons counter-clockwise.
std::vector<Point2> project(std::span<const Point3> corner, const Point3& normal) {
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  }
  std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  if (normal[axis] < 0) std::swap(u, v);
  std::vector<Point2> flat(corner.size());
  std::transform(corner.begin(), corner.end(), flat.begin(), [&](const Point3& p) { return Point2{p[u], p[v]}; });
  return flat;
}

double area_twice(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double distance_squared(const Point3& a, const Point3& b) {
  const double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
  return x * x + y * y + z * z;
}

class EarClipper {
 public:
  EarClipper(std::span<const Point3> corner, const std::vector<Point2>& flat)
      : corner_(corner), flat_(flat), alive_(corner.size()), next_(corner.size()), prev_(corner.size()) {
    const auto n = static_cast<uint32_t>(corner.size());
    std::iota(alive_.begin(), alive_.end(), 0U);
    for (uint32_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      prev_[i] = (i + n - 1) % n;
    }
    ear_.resize(n);
    for (uint32_t i = 0; i < n; ++i) ear_[i] = is_ear(i);
  }

  void clip_all(std::vector<Triangle>& out) {
    while (alive_.size() > 3) {
      const uint32_t tip = best_ear();
      out.push_back({prev_[tip], tip, next_[tip]});
      alive_.erase(std::find(alive_.begin(), alive_.end(), tip));
      next_[prev_[tip]] = next_[tip];
      prev_[next_[tip]] = prev_[tip];
      ear_[prev_[tip]] = is_ear(prev_[tip]);
      ear_[next_[tip]] = is_ear(next_[tip]);
    }
    out.push_back({alive_[0], alive_[1], alive_[2]});
  }

 private:
  bool is_ear(uint32_t tip) const {
    const uint32_t before = prev_[tip], after = next_[tip];
    const Point2 &a = flat_[before], &b = flat_[tip], &c = flat_[after];
    if (area_twice(a, b, c) <= 0) return false;
    return std::none_of(alive_.begin(), alive_.end(), [&](uint32_t i) {
      const Point2& p = flat_[i];
      // Corners that coincide with the ear's own are the two sides of a bridge to a hole.
      if (p == a || p == b || p == c) return false;
      return area_twice(a, b, p) >= 0 && area_twice(b, c, p) >= 0 && area_twice(c, a, p) >= 0;
    });
  }

  /// The valid ear with the shortest diagonal. A polygon that crosses itself may have none: then the shortest diagonal.
  uint32_t best_ear() const {
    uint32_t best = alive_[0];
    for (const uint32_t i : alive_) {
      if (i != best && better(i, best)) best = i;
    }
    return best;
  }

  bool better(uint32_t i, uint32_t j) const {
    if (ear_[i] != ear_[j]) return ear_[i];
    const double a = distance_squared(corner_[prev_[i]], corner_[next_[i]]);
    const double b = distance_squared(corner_[prev_[j]], corner_[next_[j]]);
    if (std::abs(a - b) > 1e-9 * std::max(a, b)) return a < b;
    const auto low = [&](uint32_t k) { return std::min(corner_[prev_[k]], corner_[next_[k]]); };
    return low(i) != low(j) ? low(i) < low(j) : corner_[i] < corner_[j];
  }

  std::span<const Point3> corner_;
  const std::vector<Point2>& flat_;
  std::vector<uint32_t> alive_, next_, prev_;
  std::vector<bool> ear_;
};

}  // namespace

void triangulate_polygon(std::span<const Point3> corner, std::vector<Triangle>& out) {
  if (corner.size() == 3) {
    out.push_back({0, 1, 2});
    return;
  }
  const std::vector<Point2> flat = project(corner, newell_plane(corner).normal);
  EarClipper(corner, flat).clip_all(out);
}

}  // namespace geocloth::import_detail
