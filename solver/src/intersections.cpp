// SPDX-License-Identifier: Apache-2.0
// Two triangles that are not in one plane cut each other where a side of one goes through the other one. Pairs are
// found in a tree of boxes.

#include "geocloth/solver/intersections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "colliders/halve.h"
#include "geocloth/asset/disjoint_sets.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"

namespace geocloth {
namespace {

struct ClothTriangle {
  TriangleCorners corners;
  std::array<uint32_t, 3> point{};  // numbers that no two points of all cloths share
  uint32_t cloth = 0;
  friend const TriangleCorners& corners_in(const ClothTriangle& t) { return t.corners; }
};

/// For every pixel the least one of those that are the same point, or are to be.
std::vector<uint32_t> points_of(const ClothAsset& asset) {
  DisjointSets points(asset.pixel_count());
  const std::vector<uint32_t> first = first_copies(asset);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) points.join(p, first[p]);
  for (const auto& [a, b] : asset.sewing) points.join(a, b);
  std::vector<uint32_t> point(asset.pixel_count());
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) point[p] = points.find(p);
  return point;
}

std::vector<ClothTriangle> triangles_of(std::span<const PosedCloth> cloths) {
  std::vector<ClothTriangle> triangles;
  uint32_t first = 0;
  for (uint32_t c = 0; c < cloths.size(); ++c) {
    const ClothAsset& asset = cloths[c].asset;
    const std::span<const Vec3> position = cloths[c].position;
    const std::vector<uint32_t> point = points_of(asset);
    for (const Triangle& t : pixel_triangles(asset)) {
      if (!std::ranges::all_of(t, [&](uint32_t p) { return is_finite(position[p]); })) continue;
      triangles.push_back({.corners = corners_of(t, position),
                           .point = {first + point[t[0]], first + point[t[1]], first + point[t[2]]},
                           .cloth = c});
    }
    first += asset.pixel_count();
  }
  return triangles;
}

/// Six times the volume of a tetrahedron.
double volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return dot(b - a, cross(c - a, d - a));
}

/// Whether the segment from p to q does. Ends that lie in the triangle's plane, but for the rounding of single
/// precision, touch it: where all is in one plane, nobody knows on which side anything is.
bool goes_through(const Vec3d& p, const Vec3d& q, const TriangleCorners& t) {
  constexpr double kRounding = 4 * 6e-8;  // of the largest coordinate
  const Vec3d normal = cross(t.b - t.a, t.c - t.a);
  const double over_p = dot(normal, p - t.a), over_q = dot(normal, q - t.a);
  const double largest = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double touching = kRounding * largest * length(normal);
  if ((over_p > 0) == (over_q > 0) || std::abs(over_p) <= touching || std::abs(over_q) <= touching) return false;
  const bool beside = volume(p, q, t.a, t.b) > 0;
  return (volume(p, q, t.b, t.c) > 0) == beside && (volume(p, q, t.c, t.a) > 0) == beside;
}

bool cut_each_other(const TriangleCorners& s, const TriangleCorners& t) {
  const auto a_side_goes_through = [](const TriangleCorners& a, const TriangleCorners& b) {
    return goes_through(a.a, a.b, b) || goes_through(a.b, a.c, b) || goes_through(a.c, a.a, b);
  };
  return a_side_goes_through(s, t) || a_side_goes_through(t, s);
}

bool overlap(const Box3d& a, const Box3d& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

class IntersectionCounter {
 public:
  explicit IntersectionCounter(std::vector<ClothTriangle> triangles)
      : triangles_(std::move(triangles)), nodes_(tree_of_boxes(triangles_)) {}

  /// Those of a triangle with others behind it in the tree's order, so that each pair counts once.
  void count(uint32_t triangle, Intersections& sum) const {
    const ClothTriangle& s = triangles_[triangle];
    const Box3d box = box_around(std::span(&s, 1));
    std::array<uint32_t, 64> stack{};
    size_t top = 1;
    while (top > 0) {
      const BoxNode& node = nodes_[stack[--top]];
      if (!overlap(box, node.box)) continue;
      for (uint32_t i = std::max(node.first, triangle + 1); i < node.first + node.count; ++i) {
        const ClothTriangle& t = triangles_[i];
        const auto is_of_t = [&](uint32_t p) { return std::ranges::find(t.point, p) != t.point.end(); };
        if (std::ranges::any_of(s.point, is_of_t) || !cut_each_other(s.corners, t.corners)) continue;
        ++(s.cloth == t.cloth ? sum.within : sum.between);
      }
      if (node.count > 0) continue;
      stack[top++] = node.right;
      stack[top++] = node.left;
    }
  }

 private:
  std::vector<ClothTriangle> triangles_;
  std::vector<BoxNode> nodes_;
};

}  // namespace

Intersections count_intersections(std::span<const PosedCloth> cloths) {
  for (const PosedCloth& cloth : cloths) {
    if (cloth.position.size() == cloth.asset.pixel_count()) continue;
    throw Error(ErrorCode::invalid_argument, "count_intersections needs one position for each of the cloth's " +
                                                 std::to_string(cloth.asset.pixel_count()) + " pixels, not " +
                                                 std::to_string(cloth.position.size()));
  }
  std::vector<ClothTriangle> triangles = triangles_of(cloths);
  if (triangles.empty()) return {};
  const auto count = static_cast<uint32_t>(triangles.size());
  const IntersectionCounter counter(std::move(triangles));
  return tbb::parallel_reduce(
      tbb::blocked_range<uint32_t>(0, count), Intersections{},
      [&](const tbb::blocked_range<uint32_t>& range, Intersections sum) {
        for (uint32_t t = range.begin(); t != range.end(); ++t) counter.count(t, sum);
        return sum;
      },
      [](const Intersections& a, const Intersections& b) {
        return Intersections{a.within + b.within, a.between + b.between};
      });
}

}  // namespace geocloth
