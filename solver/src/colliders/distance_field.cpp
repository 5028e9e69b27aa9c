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

/// Triangles in a tree of boxes, halved at the median along the longest side.
class TriangleTree {
 public:
  /// @param left_out  by triangle, not all of them; empty: none
  TriangleTree(const TriangleSurface& surface, const std::vector<char>& left_out) {
    triangles_.reserve(surface.triangle.size());
    for (uint32_t i = 0; i < surface.triangle.size(); ++i) {
      if (left_out.empty() || left_out[i] == 0)
        triangles_.push_back({corners_of(surface.triangle[i], surface.position), i});
    }
    build(0, static_cast<uint32_t>(triangles_.size()));
  }

  struct Nearest {
    double distance;
    uint32_t place;  ///< of the triangle in the tree; kNoTriangle: none within the bound
  };
  /// The nearest triangle if it is below `bound`.
  /// @param guess  a triangle that may well be it, by its place in the tree; or kNoTriangle
  [[nodiscard]] Nearest nearest(const Vec3d& p, double bound, uint32_t guess) const {
    double best = bound * bound;
    uint32_t found = kNoTriangle;
    const auto look = [&](uint32_t i) {
      const Vec3d d = p - closest_on_triangle(triangles_[i].corners, p);
      const double away = dot(d, d);
      if (!(away < best)) return;  // nor where a triangle is too flat for a number
      best = away;
      found = i;
    };
    if (guess != kNoTriangle) look(guess);
    std::array<uint32_t, 64> stack{};
    size_t top = 1;
    while (top > 0) {
      const Node& node = nodes_[stack[--top]];
      if (outside(node, p) >= best) continue;
      if (node.count > 0) {
        for (uint32_t i = node.first; i < node.first + node.count; ++i) look(i);
        continue;
      }
      // The nearer child last, so that it is looked at first.
      const bool left_nearer = outside(nodes_[node.left], p) < outside(nodes_[node.right], p);
      stack[top++] = left_nearer ? node.right : node.left;
      stack[top++] = left_nearer ? node.left : node.right;
    }
    return {std::sqrt(best), found};
  }
  /// In the surface's order.
  [[nodiscard]] uint32_t triangle_at(uint32_t place) const { return triangles_[place].index; }

  /// Whether the surface winds around a point.
  [[nodiscard]] bool encloses(const Vec3d& p) const { return std::abs(winding(p)) > 0.5; }

 private:
  [[nodiscard]] double winding(const Vec3d& p) const {
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
        for (uint32_t i = node.first; i < node.first + node.count; ++i) near.add(triangles_[i].corners, p);
      } else {
        stack[top++] = node.left;
        stack[top++] = node.right;
      }
    }
    return sum + near.winding();
  }

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
  return to_float(share.x * way(0) + share.y * way(1) + share.z * way(2));
}

/// Measures the nodes of a field.
class Filler {
 public:
  /// @param before  see make_deforming_field(); empty: the body keeps its shape
  Filler(DistanceField& field, std::span<const Vec3> before)
      : field_(field), before_(before), tree_(field.surface, {}) {}

  void fill() {
    const size_t nodes = size_t{field_.size[0]} * field_.size[1] * field_.size[2];
    field_.distance.resize(nodes);
    if (!before_.empty()) field_.way.resize(nodes);
    nearest_.resize(nodes, kNoTriangle);
    for_rows([&](uint32_t y, uint32_t z) { measure_row(y, z); });
    if (std::ranges::none_of(field_.distance, [](float d) { return d < 0; })) {
      throw Error(ErrorCode::invalid_argument,
                  "the mesh of a collider encloses nothing; close its surface, or make it thicker than " +
                      std::to_string(field_.spacing) + " m");
    }
    find_hidden();
    const auto hidden = std::ranges::count(hidden_, 1);
    if (hidden == 0 || static_cast<size_t>(hidden) == hidden_.size()) return;
    const TriangleTree shown(field_.surface, hidden_);
    for_rows([&](uint32_t y, uint32_t z) { deepen_row(shown, y, z); });
  }

 private:
  template <typename Row>
  void for_rows(const Row& row) const {
    const uint32_t rows = field_.size[1] * field_.size[2];
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, rows), [&](const tbb::blocked_range<uint32_t>& range) {
      for (uint32_t r = range.begin(); r < range.end(); ++r) row(r % field_.size[1], r / field_.size[1]);
    });
  }

  [[nodiscard]] size_t node_at(uint32_t x, uint32_t y, uint32_t z) const {
    return (size_t{z} * field_.size[1] + y) * field_.size[0] + x;
  }
  [[nodiscard]] Vec3d place_of(uint32_t x, uint32_t y, uint32_t z) const {
    const double h = field_.spacing;
    return {field_.low.x + h * x, field_.low.y + h * y, field_.low.z + h * z};
  }

  /// Along x: a node is at most a spacing farther from the surface than the one before, and where it is farther than
  /// that its sign is the same. A body that deforms is measured anew in every frame, near its surface only: farther
  /// outside a lower bound of the distance will do.
  void measure_row(uint32_t y, uint32_t z) {
    constexpr double kBand = 4;  // spacings
    const double h = field_.spacing;
    double bound = 1e18;
    bool inside = false;
    uint32_t guess = kNoTriangle;
    for (uint32_t x = 0; x < field_.size[0]; ++x) {
      const size_t node = node_at(x, y, z);
      const Vec3d p = place_of(x, y, z);
      const TriangleTree::Nearest near = tree_.nearest(p, bound, guess);
      const double d = near.distance;
      if (d < 2 * h) inside = tree_.encloses(p);
      guess = near.place;
      bound = 1.0001 * (d + h);
      field_.distance[node] = static_cast<float>(inside ? -d : d);
      if (near.place == kNoTriangle) continue;
      nearest_[node] = tree_.triangle_at(near.place);
      if (before_.empty()) continue;
      field_.way[node] = way_of_nearest(field_.surface, before_, nearest_[node], p);
      if (inside) continue;
      const auto room = static_cast<double>(field_.size[0] - 1 - x);
      const auto far = static_cast<uint32_t>(std::clamp(d / h - kBand, 0.0, room));
      for (uint32_t k = 1; k <= far; ++k) {
        field_.distance[node + k] = static_cast<float>(d - h * k);
        field_.way[node + k] = field_.way[node];
      }
      x += far;
      bound += h * far;
    }
  }

  /// Bodies are made of pieces that go into one another, as an arm that ends inside the trunk. What lies in there is no
  /// surface to push cloth to.
  void find_hidden() {
    hidden_.resize(field_.surface.triangle.size());
    tbb::parallel_for(size_t{0}, hidden_.size(), [&](size_t i) {
      const TriangleCorners t = corners_of(field_.surface.triangle[i], field_.surface.position);
      hidden_[i] = all_inside_around((1.0 / 3) * (t.a + t.b + t.c)) && is_hidden(t) ? 1 : 0;
    });
  }

  /// Whether all nodes of the cell around a point are inside.
  [[nodiscard]] bool all_inside_around(const Vec3d& p) const {
    const auto cell = [&](double at, float low, uint32_t size) {
      return static_cast<uint32_t>(std::clamp((at - low) / field_.spacing, 0.0, static_cast<double>(size - 2)));
    };
    const uint32_t x = cell(p.x, field_.low.x, field_.size[0]), y = cell(p.y, field_.low.y, field_.size[1]),
                   z = cell(p.z, field_.low.z, field_.size[2]);
    for (uint32_t k = 0; k < 8; ++k) {
      if (field_.distance[node_at(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))] >= 0) return false;
    }
    return true;
  }

  /// Whether a triangle has the body on both sides, in its middle and at its corners.
  [[nodiscard]] bool is_hidden(const TriangleCorners& t) const {
    constexpr double kOff = 0.01;  // spacings: on either side
    constexpr double kNear = 0.8;  // share of the corner
    const Vec3d normal = cross(t.b - t.a, t.c - t.a);
    const double size = length(normal);
    if (!(size > 0)) return true;  // its neighbours have all of its points
    const Vec3d off = (kOff * field_.spacing / size) * normal, middle = (1.0 / 3) * (t.a + t.b + t.c);
    const auto covered = [&](const Vec3d& p) { return tree_.encloses(p + off) && tree_.encloses(p - off); };
    const auto near = [&](const Vec3d& corner) { return covered(kNear * corner + (1 - kNear) * middle); };
    return covered(middle) && near(t.a) && near(t.b) && near(t.c);
  }

  /// Measures the nodes from what is not hidden whose nearest triangle is.
  void deepen_row(const TriangleTree& shown, uint32_t y, uint32_t z) {
    uint32_t guess = kNoTriangle;
    for (uint32_t x = 0; x < field_.size[0]; ++x) {
      const size_t node = node_at(x, y, z);
      if (!(field_.distance[node] < 0) || nearest_[node] == kNoTriangle || hidden_[nearest_[node]] == 0) continue;
      const Vec3d p = place_of(x, y, z);
      const TriangleTree::Nearest near = shown.nearest(p, 1e18, guess);
      guess = near.place;
      if (near.place == kNoTriangle) continue;
      field_.distance[node] = static_cast<float>(-near.distance);
      if (before_.empty()) continue;
      field_.way[node] = way_of_nearest(field_.surface, before_, shown.triangle_at(near.place), p);
    }
  }

  DistanceField& field_;
  std::span<const Vec3> before_;
  TriangleTree tree_;
  std::vector<uint32_t> nearest_;  ///< triangle of each node that was measured
  std::vector<char> hidden_;       ///< by triangle
};

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
  Filler(field, {}).fill();
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
  Filler(field, before).fill();
  return field;
}

}  // namespace geocloth
