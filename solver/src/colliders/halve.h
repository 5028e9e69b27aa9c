// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "colliders/closest.h"

namespace geocloth {

struct Box3d {
  Vec3d low, high;
};
/// Of at least one triangle.
template <class Item>
[[nodiscard]] Box3d box_around(std::span<const Item> items) {
  constexpr double kHuge = std::numeric_limits<double>::max();
  Box3d box{{kHuge, kHuge, kHuge}, {-kHuge, -kHuge, -kHuge}};
  for (const Item& item : items) {
    const TriangleCorners& t = corners_in(item);
    for (const Vec3d& p : {t.a, t.b, t.c}) {
      box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
    }
  }
  return box;
}

/// Branches of a tree over triangles, and the triangles of a leaf: the base of its nodes.
struct HalvedNode {
  uint32_t first = 0, count = 0;  ///< triangles of a leaf
  uint32_t left = 0, right = 0;   ///< else nodes
};

/// Builds a tree over some triangles, which it puts in order: halved at the median along the longest side.
/// @param items    first .. last - 1 of them, at least one; corners_in(Item) gives the triangle
/// @param measure  measure(items) of a node gives it
/// @return the number of its root
template <class Item, class Node, class Measure>
uint32_t halve(std::vector<Item>& items, uint32_t first, uint32_t last, std::vector<Node>& nodes,
               const Measure& measure) {
  constexpr uint32_t kLeafTriangles = 4;
  const std::span<const Item> own(items.data() + first, last - first);
  const auto index = static_cast<uint32_t>(nodes.size());
  nodes.push_back(measure(own));
  if (last - first <= kLeafTriangles) {
    nodes[index].first = first;
    nodes[index].count = last - first;
    return index;
  }
  const Box3d box = box_around(own);
  const Vec3d side = box.high - box.low;
  const auto along = [&](const Item& item) {
    const TriangleCorners& t = corners_in(item);
    const Vec3d sum = t.a + t.b + t.c;
    return side.x >= side.y && side.x >= side.z ? sum.x : side.y >= side.z ? sum.y : sum.z;
  };
  const uint32_t half = first + (last - first) / 2;
  std::nth_element(items.begin() + first, items.begin() + half, items.begin() + last,
                   [&](const Item& a, const Item& b) { return along(a) < along(b); });
  const uint32_t left = halve(items, first, half, nodes, measure), right = halve(items, half, last, nodes, measure);
  nodes[index].left = left;
  nodes[index].right = right;
  return index;
}

/// A node of a tree of boxes.
struct BoxNode : HalvedNode {
  Box3d box;  ///< around its triangles
};
/// A tree of boxes over triangles, which it puts in order; the root first. None over none.
template <class Item>
[[nodiscard]] std::vector<BoxNode> tree_of_boxes(std::vector<Item>& items) {
  std::vector<BoxNode> nodes;
  if (items.empty()) return nodes;
  halve(items, 0, static_cast<uint32_t>(items.size()), nodes, [](std::span<const Item> own) {
    BoxNode node;
    node.box = box_around(own);
    return node;
  });
  return nodes;
}

}  // namespace geocloth
