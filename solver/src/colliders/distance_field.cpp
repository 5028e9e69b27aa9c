// SPDX-License-Identifier: Apache-2.0
// A body as a grid of signed distances, so that a point of the cloth finds its surface with eight reads. The sign comes
// from the winding number, which needs no closed surface.

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "colliders/closest.h"
#include "colliders/enclosure.h"
#include "colliders/nearest_nodes.h"
#include "colliders/node_grid.h"
#include "colliders/surface_bounds.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"
#include "geocloth/solver/solid.h"

namespace geocloth {
namespace {

constexpr uint32_t kRoomNodes = 3;  ///< around the body

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

void check_spacing(float spacing) {
  if (!(spacing > 0 && std::isfinite(spacing)))
    throw Error(ErrorCode::invalid_argument, "the spacing of a field must be above 0");
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
    std::ostringstream text;
    text << "the body of a collider is too large for nodes " << spacing << " m apart; "
         << spacing_for(bounds.high - bounds.low, kMostFieldNodes) << " m is about the least for it";
    throw Error(ErrorCode::invalid_argument, text.str());
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

/// Measures the nodes of a field.
class Filler {
 public:
  /// @param before  see make_deforming_field(); empty: the body keeps its shape
  Filler(DistanceField& field, std::span<const Vec3> before)
      : field_(field),
        before_(before),
        grid_{field.size, to_double(field.low), field.spacing},
        enclosure_(grid_, field.surface) {}

  void fill() {
    inside_ = enclosure_.nodes_inside();
    if (std::ranges::none_of(inside_, [](char inside) { return inside != 0; })) {
      throw Error(ErrorCode::invalid_argument,
                  "the mesh of a collider encloses nothing; close its surface, or make it thicker than " +
                      std::to_string(field_.spacing) + " m");
    }
    const std::vector<uint32_t> shown = shown_triangles();
    std::vector<TriangleCorners> corners;
    corners.reserve(shown.size());
    for (const uint32_t i : shown) corners.push_back(corners_at(i));
    // A body that deforms is measured anew in every frame, near its surface only: farther outside a lower bound of the
    // distance will do.
    const double band = before_.empty() ? std::numeric_limits<double>::infinity() : kBand;
    nearest_ = nearest_points(grid_, corners, inside_, band);
    for (uint32_t& n : nearest_.triangle) n = n == kNoTriangle ? n : shown[n];
    measure();
    if (!before_.empty()) carry_ways();
  }

 private:
  static constexpr double kBand = 4;  ///< spacings

  [[nodiscard]] TriangleCorners corners_at(uint32_t triangle) const {
    return corners_of(field_.surface.triangle[triangle], field_.surface.position);
  }

  /// Bodies are made of pieces that go into one another, as an arm that ends inside the trunk. What lies in there is no
  /// surface to push cloth to, unless nothing else is.
  [[nodiscard]] std::vector<uint32_t> shown_triangles() {
    std::vector<char> hidden(field_.surface.triangle.size());
    std::vector<uint32_t> doubtful;
    std::vector<TriangleCorners> corners;
    for (uint32_t i = 0; i < hidden.size(); ++i) {
      const TriangleCorners t = corners_at(i);
      if (!all_inside_around((1.0 / 3) * (t.a + t.b + t.c), 0)) continue;
      doubtful.push_back(i);
      corners.push_back(t);
    }
    if (!doubtful.empty()) {
      enclosure_.index(corners);
      tbb::parallel_for(size_t{0}, doubtful.size(),
                        [&](size_t k) { hidden[doubtful[k]] = is_hidden(corners[k]) ? 1 : 0; });
    }
    const bool all = std::ranges::none_of(hidden, [](char h) { return h == 0; });
    std::vector<uint32_t> shown;
    shown.reserve(hidden.size());
    for (uint32_t i = 0; i < hidden.size(); ++i) {
      if (hidden[i] == 0 || all) shown.push_back(i);
    }
    return shown;
  }

  /// Whether all nodes of the cell around a point are inside, and so many layers of nodes around it.
  [[nodiscard]] bool all_inside_around(const Vec3d& p, uint32_t layers) const {
    const auto range = [&](double at, double low, uint32_t size) {
      const auto cell =
          static_cast<uint32_t>(std::clamp((at - low) / grid_.spacing, 0.0, static_cast<double>(size - 2)));
      return std::pair(cell - std::min(cell, layers), std::min(cell + 2 + layers, size));
    };
    const auto [x0, x1] = range(p.x, grid_.low.x, grid_.size[0]);
    const auto [y0, y1] = range(p.y, grid_.low.y, grid_.size[1]);
    const auto [z0, z1] = range(p.z, grid_.low.z, grid_.size[2]);
    for (uint32_t z = z0; z < z1; ++z) {
      for (uint32_t y = y0; y < y1; ++y) {
        const char* const row = &inside_[grid_.at(x0, y, z)];
        if (std::any_of(row, row + (x1 - x0), [](char inside) { return inside == 0; })) return false;
      }
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
    const Vec3d off = (kOff * grid_.spacing / size) * normal, middle = (1.0 / 3) * (t.a + t.b + t.c);
    const auto covered = [&](const Vec3d& p) {
      return all_inside_around(p, 1) || (enclosure_.encloses(p + off) && enclosure_.encloses(p - off));
    };
    const auto near = [&](const Vec3d& corner) { return covered(kNear * corner + (1 - kNear) * middle); };
    return covered(middle) && near(t.a) && near(t.b) && near(t.c);
  }

  template <class Body>
  void for_layers(const Body& body) const {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, grid_.size[2]), [&](const tbb::blocked_range<uint32_t>& layers) {
      for (uint32_t z = layers.begin(); z < layers.end(); ++z) body(z);
    });
  }

  /// Distances, and ways where the nearest triangle is known.
  void measure() {
    field_.distance.resize(grid_.count());
    if (!before_.empty()) field_.way.resize(grid_.count());
    for_layers([&](uint32_t z) {
      for (uint32_t y = 0; y < grid_.size[1]; ++y) {
        for (uint32_t x = 0; x < grid_.size[0]; ++x) measure_node(grid_.at(x, y, z), grid_.place(x, y, z));
      }
    });
  }

  void measure_node(size_t node, const Vec3d& p) {
    const uint32_t triangle = nearest_.triangle[node];
    if (triangle == kNoTriangle) {
      field_.distance[node] = static_cast<float>(kBand * grid_.spacing);
      return;
    }
    const Vec3d off = grid_.spacing * to_double(nearest_.off[node]);
    const double d = length(off);
    field_.distance[node] = static_cast<float>(inside_[node] != 0 ? -d : d);
    if (!before_.empty()) field_.way[node] = way_of(triangle, corner_shares(corners_at(triangle), p + off));
  }

  /// How far a point of a triangle went.
  [[nodiscard]] Vec3 way_of(uint32_t triangle, const Vec3d& share) const {
    const std::array<uint32_t, 3>& corner = field_.surface.triangle[triangle];
    const auto way = [&](size_t k) {
      return to_double(field_.surface.position[corner[k]]) - to_double(before_[corner[k]]);
    };
    return to_float(share.x * way(0) + share.y * way(1) + share.z * way(2));
  }

  /// To where the nearest triangle is not known the ways go on from there: along rows, then from row to row, then from
  /// layer to layer.
  void carry_ways() {
    const size_t row = grid_.size[0], layer = row * grid_.size[1];
    std::vector<char> has_row(size_t{grid_.size[1]} * grid_.size[2]), has_layer(grid_.size[2]);
    for_layers([&](uint32_t z) {
      for (uint32_t y = 0; y < grid_.size[1]; ++y)
        has_row[size_t{z} * grid_.size[1] + y] = carry_along(grid_.at(0, y, z)) ? 1 : 0;
      char* const rows = &has_row[size_t{z} * grid_.size[1]];
      has_layer[z] = carry_over(rows, grid_.size[1], &field_.way[layer * z], row) ? 1 : 0;
    });
    carry_over(has_layer.data(), grid_.size[2], field_.way.data(), layer);
  }

  /// @return whether anything in the row is known
  bool carry_along(size_t first) {
    const size_t end = first + grid_.size[0];
    size_t from = first;
    while (from < end && nearest_.triangle[from] == kNoTriangle) ++from;
    if (from == end) return false;
    std::fill(&field_.way[first], &field_.way[from], field_.way[from]);
    for (size_t node = from + 1; node < end; ++node) {
      if (nearest_.triangle[node] == kNoTriangle) field_.way[node] = field_.way[node - 1];
    }
    return true;
  }

  /// Copies pieces, each `length` long, to those before and after it that have nothing.
  static bool carry_over(const char* has, uint32_t count, Vec3* way, size_t length) {
    uint32_t from = 0;
    while (from < count && has[from] == 0) ++from;
    if (from == count) return false;
    const auto copy = [&](uint32_t a, uint32_t b) { std::copy_n(way + a * length, length, way + b * length); };
    for (uint32_t k = 0; k < from; ++k) copy(from, k);
    for (uint32_t k = from + 1; k < count; ++k) {
      if (has[k] == 0) copy(k - 1, k);
    }
    return true;
  }

  DistanceField& field_;
  std::span<const Vec3> before_;
  NodeGrid grid_;
  Enclosure enclosure_;
  std::vector<char> inside_;  ///< by node
  NearestPoints nearest_;
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
  if (nodes > kMostFieldNodes) {
    throw Error(ErrorCode::invalid_argument, "a field of " + std::to_string(nodes) +
                                                 " nodes is wanted for the body of a collider; it may have " +
                                                 std::to_string(kMostFieldNodes));
  }
  DistanceField field = grid_around(std::move(surface), nodes);
  Filler(field, {}).fill();
  return field;
}

DistanceField make_distance_field(TriangleSurface surface, FieldSpacing spacing) {
  check_surface(surface);
  check_spacing(spacing.metres);
  DistanceField field = fixed_grid_around(std::move(surface), spacing.metres);
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
  check_spacing(spacing);
  DistanceField field = fixed_grid_around(std::move(surface), spacing);
  Filler(field, before).fill();
  return field;
}

}  // namespace geocloth
