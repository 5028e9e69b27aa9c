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

#include "colliders/closest.h"
#include "colliders/surface_bounds.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/solver/solid.h"

namespace geocloth {
namespace {

constexpr uint32_t kLeafTriangles = 4;
constexpr uint32_t kNoTriangle = 0xFFFFFFFF;
constexpr double kFarRatio = 2.5;   ///< a branch is a dipole from this many of its radii on
constexpr uint32_t kRoomNodes = 3;  ///< around the body

/// Solid angle of a triangle / 4 pi (Van Oosterom and Strackee 1983).
double winding_of_triangle(const TriangleCorners& t, const Vec3d& p) {
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
    for (const auto& t : surface.triangle)
      triangles_.push_back({corners_of(t, surface.position), static_cast<uint32_t>(triangles_.size())});
    build(0, static_cast<uint32_t>(triangles_.size()));
  }

  struct Nearest {
    double distance;
    uint32_t triangle;  ///< in the surface's order; kNoTriangle: none within the bound
  };
  /// The nearest triangle if it is below `bound`.
  [[nodiscard]] Nearest nearest(const Vec3d& p, double bound) const {
    double best = bound * bound;
    uint32_t found = kNoTriangle;
    std::array<uint32_t, 64> stack{};
    size_t top = 1;
    while (top > 0) {
      const Node& node = nodes_[stack[--top]];
      if (outside(node, p) >= best) continue;
      if (node.count > 0) {
        for (uint32_t i = node.first; i < node.first + node.count; ++i) {
          const Vec3d d = p - closest_on_triangle(triangles_[i].corners, p);
          const double away = dot(d, d);
          if (!(away < best)) continue;  // nor where a triangle is too flat for a number
          best = away;
          found = triangles_[i].index;
        }
        continue;
      }
      // The nearer child last, so that it is looked at first.
      const bool left_nearer = outside(nodes_[node.left], p) < outside(nodes_[node.right], p);
      stack[top++] = left_nearer ? node.right : node.left;
      stack[top++] = left_nearer ? node.left : node.right;
    }
    return {std::sqrt(best), found};
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
        for (uint32_t i = node.first; i < node.first + node.count; ++i) sum += winding_of_triangle(triangles_[i].corners, p);
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

  static Vec3d middle(const TriangleCorners& t) { return (1.0 / 3) * (t.a + t.b + t.c); }

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
    const auto along = [&](const Indexed& t) {
      const Vec3d m = middle(t.corners);
      return side.x >= side.y && side.x >= side.z ? m.x : side.y >= side.z ? m.y : m.z;
    };
    const uint32_t half = first + (last - first) / 2;
    std::nth_element(triangles_.begin() + first, triangles_.begin() + half, triangles_.begin() + last,
                     [&](const Indexed& a, const Indexed& b) { return along(a) < along(b); });
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
      const TriangleCorners& t = triangles_[i].corners;
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
      const TriangleCorners& t = triangles_[i].corners;
      for (const Vec3d& p : {t.a, t.b, t.c}) n.radius = std::max(n.radius, length(p - n.center));
    }
    return n;
  }

  struct Indexed {
    TriangleCorners corners;
    uint32_t index;
  };
  std::vector<Indexed> triangles_;
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

/// [m] Between the nodes of a grid of about so many; the room around the body takes nodes too.
double spacing_for(const Vec3& side, uint32_t nodes) {
  const double largest = std::max({side.x, side.y, side.z});
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
  return coarse;
}

void refuse_point(const Vec3& side) {
  if (!(std::max({side.x, side.y, side.z}) > 0))
    throw Error(ErrorCode::invalid_argument, "the mesh of a collider is a single point");
}

/// An empty grid around the body.
DistanceField grid_around(TriangleSurface surface, uint32_t nodes) {
  const SurfaceBounds bounds = bounds_of(surface);
  const Vec3 low = bounds.low, side = bounds.high - bounds.low;
  refuse_point(side);
  const double spacing = spacing_for(side, nodes);
  DistanceField field;
  field.spacing = static_cast<float>(spacing);
  field.margin = static_cast<float>(kRoomNodes) * field.spacing;
  const auto along = [&](float s) {
    return static_cast<uint32_t>(std::ceil(static_cast<double>(s) / spacing)) + 1 + 2 * kRoomNodes;
  };
  field.size = {along(side.x), along(side.y), along(side.z)};
  field.low = low - Vec3{field.margin, field.margin, field.margin};
  field.surface = std::move(surface);
  return field;
}

/// An empty grid around the body whose nodes lie at whole multiples of the spacing, so that what rests has the same
/// distances in every frame.
DistanceField fixed_grid_around(TriangleSurface surface, float spacing) {
  const SurfaceBounds bounds = bounds_of(surface);
  refuse_point(bounds.high - bounds.low);
  const auto first = [&](float low) { return std::floor(double{low} / spacing) - kRoomNodes; };
  const auto nodes = [&](float low, float high) {
    return std::ceil(double{high} / spacing) + kRoomNodes - first(low) + 1;
  };
  const std::array<double, 3> size{nodes(bounds.low.x, bounds.high.x), nodes(bounds.low.y, bounds.high.y),
                                   nodes(bounds.low.z, bounds.high.z)};
  if (!(size[0] * size[1] * size[2] <= static_cast<double>(kMostFieldNodes))) {
    throw Error(ErrorCode::invalid_argument, "the body of a collider is too large for nodes " +
                                                 std::to_string(spacing) + " m apart: it deforms by too much");
  }
  DistanceField field;
  field.spacing = spacing;
  field.margin = static_cast<float>(kRoomNodes) * spacing;
  field.size = {static_cast<uint32_t>(size[0]), static_cast<uint32_t>(size[1]), static_cast<uint32_t>(size[2])};
  const auto place = [&](float low) { return static_cast<float>(first(low) * spacing); };
  field.low = {place(bounds.low.x), place(bounds.low.y), place(bounds.low.z)};
  field.surface = std::move(surface);
  return field;
}

/// How far the point of a triangle that is nearest to p went.
Vec3 way_of_nearest(const TriangleSurface& surface, std::span<const Vec3> before, uint32_t triangle, const Vec3d& p) {
  const std::array<uint32_t, 3>& corner = surface.triangle[triangle];
  const TriangleCorners now = corners_of(corner, surface.position);
  const Vec3d share = corner_shares(now, closest_on_triangle(now, p));
  const auto way = [&](size_t k) { return to_double(surface.position[corner[k]]) - to_double(before[corner[k]]); };
  const Vec3d r = share.x * way(0) + share.y * way(1) + share.z * way(2);
  return {static_cast<float>(r.x), static_cast<float>(r.y), static_cast<float>(r.z)};
}

/// Row by row along x: a node is at most a spacing farther from the surface than the one before, and where it is
/// farther than that its sign is the same. A body that deforms is measured anew in every frame, near its surface only:
/// farther outside a lower bound of the distance will do.
/// @param before  see make_deforming_field(); empty: the body keeps its shape
void fill_row(DistanceField& field, const TriangleTree& tree, std::span<const Vec3> before, uint32_t y, uint32_t z) {
  constexpr double kBand = 4;  // spacings
  const double h = field.spacing;
  double bound = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (uint32_t x = 0; x < field.size[0]; ++x) {
    const size_t node = (size_t{z} * field.size[1] + y) * field.size[0] + x;
    const Vec3d p{field.low.x + h * x, field.low.y + h * y, field.low.z + h * z};
    const TriangleTree::Nearest near = tree.nearest(p, std::isfinite(bound) ? 1.0001 * bound : 1e18);
    const double d = near.distance;
    if (d < 2 * h) inside = std::abs(tree.winding(p)) > 0.5;
    field.distance[node] = static_cast<float>(inside ? -d : d);
    bound = d + h;
    if (before.empty() || near.triangle == kNoTriangle) continue;
    field.way[node] = way_of_nearest(field.surface, before, near.triangle, p);
    if (inside) continue;
    const auto far = static_cast<uint32_t>(std::clamp(d / h - kBand, 0.0, static_cast<double>(field.size[0] - 1 - x)));
    for (uint32_t k = 1; k <= far; ++k) {
      field.distance[node + k] = static_cast<float>(d - h * k);
      field.way[node + k] = field.way[node];
    }
    x += far;
    bound += h * far;
  }
}

void fill(DistanceField& field, std::span<const Vec3> before) {
  const size_t nodes = size_t{field.size[0]} * field.size[1] * field.size[2];
  field.distance.resize(nodes);
  if (!before.empty()) field.way.resize(nodes);
  const TriangleTree tree(field.surface);
  const uint32_t rows = field.size[1] * field.size[2];
  tbb::parallel_for(tbb::blocked_range<uint32_t>(0, rows), [&](const tbb::blocked_range<uint32_t>& range) {
    for (uint32_t r = range.begin(); r < range.end(); ++r)
      fill_row(field, tree, before, r % field.size[1], r / field.size[1]);
  });
  if (std::none_of(field.distance.begin(), field.distance.end(), [](float d) { return d < 0; })) {
    throw Error(ErrorCode::invalid_argument,
                "the mesh of a collider encloses nothing; close its surface, or make it thicker than " +
                    std::to_string(field.spacing) + " m");
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
  fill(field, {});
  return field;
}

DistanceField make_deforming_field(TriangleSurface surface, std::span<const Vec3> before, float spacing) {
  check_surface(surface);
  if (before.size() != surface.position.size()) {
    throw Error(ErrorCode::invalid_argument, "a collider's mesh had " + std::to_string(before.size()) +
                                                 " vertices and has " + std::to_string(surface.position.size()));
  }
  if (!std::ranges::all_of(before, [](const Vec3& p) { return is_finite(p); }))
    throw Error(ErrorCode::invalid_argument, "a vertex of a collider's mesh was not finite");
  if (!(spacing > 0 && std::isfinite(spacing)))
    throw Error(ErrorCode::invalid_argument, "the spacing of a field must be above 0");
  DistanceField field = fixed_grid_around(std::move(surface), spacing);
  fill(field, before);
  return field;
}

}  // namespace geocloth
