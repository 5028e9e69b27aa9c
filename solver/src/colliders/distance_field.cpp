// SPDX-License-Identifier: Apache-2.0
// A body as a grid of signed distances, so that a point of the cloth finds its surface with eight reads. The distance
// is exact at the nodes (a tree of boxes over the triangles). The sign comes from the winding number, which needs no
// closed surface: Barill, Dickson, Schmidt, Levin, Jacobson 2018, "Fast Winding Numbers for Soups and Clouds": a branch
// that is far away counts as one dipole. It is evaluated near the surface only; farther away neighbours have the same
// sign.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "colliders/surface_bounds.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/solver/solid.h"

namespace geocloth {
namespace {

constexpr uint32_t kLeafTriangles = 4;
constexpr double kFarRatio = 2.5;   ///< a branch is a dipole from this many of its radii on
constexpr uint32_t kRoomNodes = 3;  ///< around the body

struct Corners {
  Vec3d a, b, c;
};

/// Ericson 2005, "Real-Time Collision Detection", 5.1.5: the region of the triangle's plane that the point lies over.
Vec3d closest_on_triangle(const Corners& t, const Vec3d& p) {
  const Vec3d ab = t.b - t.a, ac = t.c - t.a, ap = p - t.a, bp = p - t.b, cp = p - t.c;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
               d6 = dot(ac, cp);
  if (d1 <= 0 && d2 <= 0) return t.a;
  if (d3 >= 0 && d4 <= d3) return t.b;
  if (d6 >= 0 && d5 <= d6) return t.c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return t.a + (d1 / (d1 - d3)) * ab;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return t.a + (d2 / (d2 - d6)) * ac;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return t.b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (t.c - t.b);
  const double sum = va + vb + vc;
  return t.a + (vb / sum) * ab + (vc / sum) * ac;
}

/// Solid angle of a triangle / 4 pi (Van Oosterom and Strackee 1983).
double winding_of_triangle(const Corners& t, const Vec3d& p) {
  const Vec3d a = t.a - p, b = t.b - p, c = t.c - p;
  const double la = length(a), lb = length(b), lc = length(c);
  const double above = dot(a, cross(b, c));
  const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return std::atan2(above, below) / (2 * std::numbers::pi);
}

/// Triangles in a tree of boxes, halved at the median along the longest side.
class TriangleTree {
 public:
  explicit TriangleTree(const TriangleSurface& surface) {
    triangles_.reserve(surface.triangle.size());
    const auto at = [&](uint32_t i) {
      const Vec3& p = surface.position[i];
      return to_double(p);
    };
    for (const auto& t : surface.triangle) triangles_.push_back({at(t[0]), at(t[1]), at(t[2])});
    build(0, static_cast<uint32_t>(triangles_.size()));
  }

  /// Distance to the nearest triangle if it is below `bound`, else `bound`.
  [[nodiscard]] double distance(const Vec3d& p, double bound) const {
    double best = bound * bound;
    std::array<uint32_t, 64> stack{};
    size_t top = 1;
    while (top > 0) {
      const Node& node = nodes_[stack[--top]];
      if (outside(node, p) >= best) continue;
      if (node.count > 0) {
        for (uint32_t i = node.first; i < node.first + node.count; ++i) {
          const Vec3d d = p - closest_on_triangle(triangles_[i], p);
          best = std::min(best, dot(d, d));
        }
        continue;
      }
      // The nearer child last, so that it is looked at first.
      const bool left_nearer = outside(nodes_[node.left], p) < outside(nodes_[node.right], p);
      stack[top++] = left_nearer ? node.right : node.left;
      stack[top++] = left_nearer ? node.left : node.right;
    }
    return std::sqrt(best);
  }

  [[nodiscard]] double winding(const Vec3d& p) const {
    double sum = 0;
    std::array<uint32_t, 64> stack{};
    size_t top = 1;
    while (top > 0) {
      const Node& node = nodes_[stack[--top]];
      const Vec3d d = node.center - p;
      const double far = length(d);
      if (far > kFarRatio * node.radius) {
        sum += dot(node.area, d) / (4 * std::numbers::pi * far * far * far);
      } else if (node.count > 0) {
        for (uint32_t i = node.first; i < node.first + node.count; ++i) sum += winding_of_triangle(triangles_[i], p);
      } else {
        stack[top++] = node.left;
        stack[top++] = node.right;
      }
    }
    return sum;
  }

 private:
  struct Node {
    Vec3d low, high;
    Vec3d center, area;             ///< of the dipole: weighted by area; sum of the area vectors
    double radius = 0;              ///< about the centre
    uint32_t first = 0, count = 0;  ///< triangles of a leaf
    uint32_t left = 0, right = 0;
  };

  static Vec3d middle(const Corners& t) { return (1.0 / 3) * (t.a + t.b + t.c); }

  /// Squared distance to the node's box.
  static double outside(const Node& n, const Vec3d& p) {
    const auto over = [](double low, double high, double v) { return std::max({low - v, 0.0, v - high}); };
    const Vec3d d{over(n.low.x, n.high.x, p.x), over(n.low.y, n.high.y, p.y), over(n.low.z, n.high.z, p.z)};
    return dot(d, d);
  }

  uint32_t build(uint32_t first, uint32_t last) {
    const auto index = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back(measure(first, last));
    if (last - first <= kLeafTriangles) {
      nodes_[index].first = first;
      nodes_[index].count = last - first;
      return index;
    }
    const Vec3d side = nodes_[index].high - nodes_[index].low;
    const auto along = [&](const Corners& t) {
      const Vec3d m = middle(t);
      return side.x >= side.y && side.x >= side.z ? m.x : side.y >= side.z ? m.y : m.z;
    };
    const uint32_t half = first + (last - first) / 2;
    std::nth_element(triangles_.begin() + first, triangles_.begin() + half, triangles_.begin() + last,
                     [&](const Corners& a, const Corners& b) { return along(a) < along(b); });
    const uint32_t left = build(first, half);
    const uint32_t right = build(half, last);
    nodes_[index].left = left;
    nodes_[index].right = right;
    return index;
  }

  [[nodiscard]] Node measure(uint32_t first, uint32_t last) const {
    constexpr double kHuge = std::numeric_limits<double>::max();
    Node n;
    n.low = {kHuge, kHuge, kHuge};
    n.high = {-kHuge, -kHuge, -kHuge};
    double weight = 0;
    for (uint32_t i = first; i < last; ++i) {
      const Corners& t = triangles_[i];
      for (const Vec3d& p : {t.a, t.b, t.c}) {
        n.low = {std::min(n.low.x, p.x), std::min(n.low.y, p.y), std::min(n.low.z, p.z)};
        n.high = {std::max(n.high.x, p.x), std::max(n.high.y, p.y), std::max(n.high.z, p.z)};
      }
      const Vec3d area = 0.5 * cross(t.b - t.a, t.c - t.a);
      n.area = n.area + area;
      n.center = n.center + length(area) * middle(t);
      weight += length(area);
    }
    n.center = weight > 0 ? (1 / weight) * n.center : 0.5 * (n.low + n.high);
    for (uint32_t i = first; i < last; ++i) {
      const Corners& t = triangles_[i];
      for (const Vec3d& p : {t.a, t.b, t.c}) n.radius = std::max(n.radius, length(p - n.center));
    }
    return n;
  }

  std::vector<Corners> triangles_;
  std::vector<Node> nodes_;  ///< the root first
};

void check_surface(const TriangleSurface& surface) {
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::invalid_argument, what); };
  if (surface.triangle.empty()) refuse("the mesh of a collider has no triangles");
  for (const auto& t : surface.triangle) {
    for (const uint32_t i : t) {
      if (i >= surface.position.size())
        refuse("a triangle of a collider's mesh refers to vertex " + std::to_string(i) + ", but there are " +
               std::to_string(surface.position.size()));
      if (!is_finite(surface.position[i])) {
        refuse("vertex " + std::to_string(i) + " of a collider's mesh is not finite");
      }
    }
  }
}

/// An empty grid around the body.
DistanceField grid_around(TriangleSurface surface, uint32_t nodes) {
  const SurfaceBounds bounds = bounds_of(surface);
  const Vec3 low = bounds.low, side = bounds.high - bounds.low;
  const double largest = std::max({side.x, side.y, side.z});
  if (!(largest > 0)) throw Error(ErrorCode::invalid_argument, "the mesh of a collider is a single point");
  // The room around takes nodes too: with the wanted number known, halve the interval of spacings a few times.
  const auto count = [&](double spacing) {
    double product = 1;
    for (const float s : {side.x, side.y, side.z})
      product *= std::ceil(static_cast<double>(s) / spacing) + 1 + 2 * kRoomNodes;
    return product;
  };
  double fine = largest / 1024, coarse = largest;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(fine * coarse);
    (count(middle) > nodes ? fine : coarse) = middle;
  }
  DistanceField field;
  field.spacing = static_cast<float>(coarse);
  field.margin = static_cast<float>(kRoomNodes) * field.spacing;
  const auto along = [&](float s) {
    return static_cast<uint32_t>(std::ceil(static_cast<double>(s) / coarse)) + 1 + 2 * kRoomNodes;
  };
  field.size = {along(side.x), along(side.y), along(side.z)};
  field.low = low - Vec3{field.margin, field.margin, field.margin};
  field.distance.resize(size_t{field.size[0]} * field.size[1] * field.size[2]);
  field.surface = std::move(surface);
  return field;
}

/// Row by row along x: a node is at most a spacing farther from the surface than the one before, and where it is
/// farther than that its sign is the same.
void fill_row(DistanceField& field, const TriangleTree& tree, uint32_t y, uint32_t z) {
  const double h = field.spacing;
  double bound = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (uint32_t x = 0; x < field.size[0]; ++x) {
    const Vec3d p{field.low.x + h * x, field.low.y + h * y, field.low.z + h * z};
    const double d = tree.distance(p, std::isfinite(bound) ? 1.0001 * bound : 1e18);
    if (d < 2 * h) inside = std::abs(tree.winding(p)) > 0.5;
    field.distance[(size_t{z} * field.size[1] + y) * field.size[0] + x] = static_cast<float>(inside ? -d : d);
    bound = d + h;
  }
}

}  // namespace

SurfaceBounds bounds_of(const TriangleSurface& surface) {
  SurfaceBounds bounds{surface.position[surface.triangle[0][0]], surface.position[surface.triangle[0][0]]};
  for (const auto& t : surface.triangle) {
    for (const uint32_t i : t) {
      const Vec3& p = surface.position[i];
      bounds.low = {std::min(bounds.low.x, p.x), std::min(bounds.low.y, p.y), std::min(bounds.low.z, p.z)};
      bounds.high = {std::max(bounds.high.x, p.x), std::max(bounds.high.y, p.y), std::max(bounds.high.z, p.z)};
    }
  }
  return bounds;
}

DistanceField make_distance_field(TriangleSurface surface, uint32_t nodes) {
  check_surface(surface);
  DistanceField field = grid_around(std::move(surface), nodes);
  const TriangleTree tree(field.surface);
  const uint32_t rows = field.size[1] * field.size[2];
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, rows), [&](const tbb::blocked_range<uint32_t>& range) {
    for (uint32_t r = range.begin(); r < range.end(); ++r) fill_row(field, tree, r % field.size[1], r / field.size[1]);
  });
  if (std::none_of(field.distance.begin(), field.distance.end(), [](float d) { return d < 0; })) {
    throw Error(ErrorCode::invalid_argument,
                "the mesh of a collider encloses nothing; close its surface, or make it thicker than " +
                    std::to_string(field.spacing) + " m");
  }
  return field;
}

}  // namespace geocloth
