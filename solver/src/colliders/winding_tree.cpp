// SPDX-License-Identifier: Apache-2.0
#include "colliders/winding_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace geocloth {
namespace {

constexpr double kFarRatio = 2.5;  ///< a branch is a dipole from this many of its radii on

/// Solid angles of triangles, seen from a point (Van Oosterom and Strackee 1983), added as the arguments of complex
/// numbers are by their product, so that only one arctangent is needed.
class SolidAngle {
 public:
  void add(const TriangleCorners& t, const Vec3d& p) {
    const Vec3d a = t.a - p, b = t.b - p, c = t.c - p;
    const double la = length(a), lb = length(b), lc = length(c);
    const double y = dot(a, cross(b, c));
    const double x = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    const double scale = std::abs(x) + std::abs(y);
    if (!(scale > 0)) return;  // from a corner of it
    const double re = (x_ * x - y_ * y) / scale, im = (x_ * y + y_ * x) / scale;
    // Two halves of a turn are one.
    if (y_ >= 0 && y >= 0 && im < 0) ++turns_;
    if (y_ < 0 && y < 0 && im >= 0) --turns_;
    x_ = re;
    y_ = im;
  }
  /// The sum / 4 pi.
  [[nodiscard]] double winding() const { return turns_ + std::atan2(y_, x_) / (2 * std::numbers::pi); }

 private:
  double x_ = 1, y_ = 0;  ///< its argument is half the sum, less whole turns
  int turns_ = 0;
};

Vec3d middle(const TriangleCorners& t) {
  return (1.0 / 3) * (t.a + t.b + t.c);
}

}  // namespace

WindingTree::WindingTree(std::vector<TriangleCorners> triangles) : triangles_(std::move(triangles)) {
  halve(triangles_, 0, static_cast<uint32_t>(triangles_.size()), nodes_, measure);
}

double WindingTree::winding(const Vec3d& p) const {
  double sum = 0;
  SolidAngle near;
  std::array<uint32_t, 64> stack{};
  size_t top = 1;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    const Vec3d d = node.center - p;
    const double far = length(d);
    if (far > kFarRatio * node.radius) {
      sum += dot(node.area, d) / (4 * std::numbers::pi * far * far * far);
    } else if (node.count > 0) {
      for (uint32_t i = node.first; i < node.first + node.count; ++i) near.add(triangles_[i], p);
    } else {
      stack[top++] = node.left;
      stack[top++] = node.right;
    }
  }
  return sum + near.winding();
}

WindingTree::Node WindingTree::measure(std::span<const TriangleCorners> triangles) {
  Node n;
  double weight = 0;
  for (const TriangleCorners& t : triangles) {
    const Vec3d area = 0.5 * cross(t.b - t.a, t.c - t.a);
    n.area = n.area + area;
    n.center = n.center + length(area) * middle(t);
    weight += length(area);
  }
  n.center = weight > 0 ? (1 / weight) * n.center : middle(triangles.front());
  for (const TriangleCorners& t : triangles) {
    for (const Vec3d& p : {t.a, t.b, t.c}) n.radius = std::max(n.radius, length(p - n.center));
  }
  return n;
}

}  // namespace geocloth
