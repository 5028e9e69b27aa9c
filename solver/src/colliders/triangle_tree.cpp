// SPDX-License-Identifier: Apache-2.0
#include "colliders/triangle_tree.h"

#include <algorithm>
#include <array>
#include <limits>

namespace geocloth {
namespace {

/// Squared distance to a box.
double outside(const Box3d& box, const Vec3d& p) {
  const auto over = [](double least, double most, double v) { return std::max({least - v, 0.0, v - most}); };
  const Vec3d d{over(box.low.x, box.high.x, p.x), over(box.low.y, box.high.y, p.y), over(box.low.z, box.high.z, p.z)};
  return dot(d, d);
}

}  // namespace

TriangleTree::TriangleTree(std::span<const TriangleCorners> triangles) {
  triangles_.reserve(triangles.size());
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    const TriangleCorners& t = triangles[i];
    const Vec3d normal = cross(t.b - t.a, t.c - t.a);
    if (dot(normal, normal) > 0) triangles_.push_back({t, i});
  }
  nodes_ = tree_of_boxes(triangles_);
}

std::optional<uint32_t> TriangleTree::nearest(const Vec3d& p) const {
  return nearest(p, {});
}

std::optional<uint32_t> TriangleTree::nearest(const Vec3d& p, const MayTake& may_take) const {
  if (nodes_.empty()) return {};
  const auto away = [&](const BoxNode& node) { return outside(node.box, p); };
  double least = std::numeric_limits<double>::infinity();
  std::optional<uint32_t> found;
  std::array<uint32_t, 64> stack{};
  size_t top = 1;
  while (top > 0) {
    const BoxNode& node = nodes_[stack[--top]];
    if (away(node) > least) continue;
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Indexed& t = triangles_[i];
      const Vec3d d = p - closest_on_triangle(t.corners, p);
      const double square = dot(d, d);
      if (square > least || (square == least && found < t.index)) continue;
      if (may_take && !may_take(t.index)) continue;
      least = square;
      found = t.index;
    }
    if (node.count > 0) continue;
    // The nearer child last, so that it is looked at first.
    const bool left_nearer = away(nodes_[node.left]) < away(nodes_[node.right]);
    stack[top++] = left_nearer ? node.right : node.left;
    stack[top++] = left_nearer ? node.left : node.right;
  }
  return found;
}

}  // namespace geocloth
