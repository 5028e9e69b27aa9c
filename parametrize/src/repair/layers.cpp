// SPDX-License-Identifier: GPL-3.0-or-later
//
// Modelling programs give cloth a thickness: a second side within, and walls that join the two along hems. Simulated as
// it is that is two cloths, which fold each by itself and show through each other. So the sides are told apart: a
// triangle whose normal, followed inwards, soon meets one that faces the other way has its partner there, on the other
// side, and goes on flatly into neighbours on its own. What has no partner, as walls and the corners of a bevel, goes
// with the side that it continues smoothly.

#include "repair/layers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "geocloth/asset/error.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "mesh/triangle_tree.h"
#include "repair/chosen_triangles.h"
#include "repair/part_words.h"

namespace geocloth {
namespace {

constexpr double kThickest = 0.03;    // share of the diagonal: what is farther is no other side of the same cloth
constexpr double kFacing = -0.5;      // cosine of partners' normals, at most
constexpr double kSharp = -0.5;       // and of neighbours across an edge that may join two sides
constexpr double kSmooth = 0.5;       // and of those that continue each other
constexpr double kWithPartner = 0.6;  // share of a component's area: less is no thick cloth
constexpr double kOpen = 0.3;         // length of a component's border / the root of its area: more are openings
constexpr double kCrumb = 0.01;       // share of a component's area: smaller regions of one side are mistakes
constexpr double kUnlike = 2;         // ratio of the ways from a triangle to its partner and from there on

constexpr uint32_t kSampled = 2000;  // triangles
constexpr double kNearlyAll = 0.9;

struct Partner {
  uint32_t triangle = kNone;
  double way = 0;  // [m]
};

/// A surface with what is asked of its triangles again and again.
class ThickCloth {
 public:
  explicit ThickCloth(const CleanSurface& surface)
      : surface_(surface),
        opposite_(opposite_half_edges(surface.triangle)),
        tree_(surface.position, surface.triangle),
        reach_(kThickest * bounding_diagonal(surface.position)),
        is_open_(surface.component_count, 0),
        inwards_(surface.component_count, -1) {
    std::vector<double> border(surface.component_count, 0), area(surface.component_count, 0);
    for (uint32_t t = 0; t < size(); ++t) {
      const Point3 &a = corner(t, 0), n = cross(corner(t, 1) - a, corner(t, 2) - a);
      normal_.push_back(direction_of(n).value_or(Point3{0, 0, 0}));
      area_.push_back(length(n) / 2);
      area[surface.component[t]] += area_.back();
      for (uint32_t k = 0; k < 3; ++k)
        if (opposite_[3 * t + k] == kNone)
          border[surface.component[t]] += distance(corner(t, k), corner(t, (k + 1) % 3));
    }
    for (uint32_t c = 0; c < surface.component_count; ++c) is_open_[c] = border[c] > kOpen * std::sqrt(area[c]) ? 1 : 0;
    find_inwards();
  }

  [[nodiscard]] uint32_t size() const { return static_cast<uint32_t>(surface_.triangle.size()); }
  [[nodiscard]] double area(uint32_t t) const { return area_[t]; }
  [[nodiscard]] const std::vector<uint32_t>& opposite() const { return opposite_; }
  [[nodiscard]] double cosine(uint32_t t, uint32_t u) const { return dot(normal_[t], normal_[u]); }

  [[nodiscard]] Point3 inwards(uint32_t t) const { return normal_[t] * inwards_[surface_.component[t]]; }

  [[nodiscard]] Partner partner_of(uint32_t t) const {
    const Point3 middle = (corner(t, 0) + corner(t, 1) + corner(t, 2)) * (1.0 / 3);
    if (area_[t] == 0) return {};
    const auto hit = tree_.first_hit(middle, inwards(t), t);
    if (!hit || hit->distance > reach_ || cosine(t, hit->triangle) > kFacing) return {};
    // The front and the back of a garment that lies flat.
    const uint32_t c = surface_.component[t];
    if (is_open_[c] != 0 && surface_.component[hit->triangle] == c) return {};
    return {hit->triangle, hit->distance};
  }

 private:
  /// Against the normals, but for components that are wound inside out: where a sample of triangles has more partners.
  void find_inwards() {
    const uint32_t step = 1 + size() / kSampled;
    std::vector<double> gain(surface_.component_count, 0);
    for (const double direction : {-1.0, 1.0}) {
      std::ranges::fill(inwards_, direction);
      for (uint32_t t = 0; t < size(); t += step)
        if (partner_of(t).triangle != kNone) gain[surface_.component[t]] += direction * area_[t];
    }
    for (uint32_t c = 0; c < gain.size(); ++c) inwards_[c] = gain[c] > 0 ? 1 : -1;
  }

  [[nodiscard]] const Point3& corner(uint32_t t, size_t k) const { return surface_.position[surface_.triangle[t][k]]; }

  const CleanSurface& surface_;
  std::vector<uint32_t> opposite_;
  TriangleTree tree_;
  double reach_;
  std::vector<uint8_t> is_open_;  // of each component: it has openings, as cloth has and thick cloth has not
  std::vector<double> inwards_;   // of each component: along the normals, 1, or against them, -1
  std::vector<Point3> normal_;
  std::vector<double> area_;
};

enum class Side : uint8_t { unknown, kept, other };

/// Sets of elements that are known to be on the same side, or on opposite sides, of each other.
class TwoSidedSets {
 public:
  explicit TwoSidedSets(uint32_t size) : parent_(size), across_(size, 0) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  struct Root {
    uint32_t set;
    uint8_t across;  ///< 1: on the other side than the set's root
  };
  [[nodiscard]] Root find(uint32_t i) const {
    uint8_t across = 0;
    for (; parent_[i] != i; i = parent_[i]) across ^= across_[i];
    return {i, across};
  }
  /// Nothing happens where it is known already, or contradicts what is known.
  void join(uint32_t a, uint32_t b, bool across) {
    Root ra = find(a), rb = find(b);
    if (ra.set == rb.set) return;
    if (size_[ra.set] < size_[rb.set]) std::swap(ra, rb);
    parent_[rb.set] = ra.set;
    across_[rb.set] = static_cast<uint8_t>(ra.across ^ rb.across ^ (across ? 1 : 0));
    size_[ra.set] += size_[rb.set];
  }

 private:
  std::vector<uint32_t> parent_;
  std::vector<uint8_t> across_;
  std::vector<uint32_t> size_ = std::vector<uint32_t>(parent_.size(), 1);
};

class LayerFinder {
 public:
  explicit LayerFinder(const CleanSurface& surface)
      : surface_(surface), cloth_(surface), partner_(cloth_.size()), side_(cloth_.size(), Side::unknown) {
    for (uint32_t t = 0; t < cloth_.size(); ++t) partner_[t] = cloth_.partner_of(t);
    leave_unlike_partners();
  }

  std::optional<Layers> find() {
    keep_thin_components();
    choose_sides();
    grow_smoothly();
    close_regions();
    turn_crumbs();
    Layers layers;
    double way = 0, area = 0;
    for (uint32_t t = 0; t < cloth_.size(); ++t) {
      const bool is_other = side_[t] == Side::other;
      layers.is_other.push_back(is_other ? 1 : 0);
      if (!is_other || !has_partner(t)) continue;
      way += cloth_.area(t) * partner_[t].way;
      area += cloth_.area(t);
    }
    if (!(area > 0)) return std::nullopt;
    layers.thickness = way / area;
    layers.across = ways_across();
    return layers;
  }

 private:
  [[nodiscard]] bool has_partner(uint32_t t) const { return partner_[t].triangle != kNone; }

  /// From a wall the way inwards is along the cloth: what it meets in the end has its own partner much nearer.
  void leave_unlike_partners() {
    const std::vector<Partner> found = partner_;
    for (Partner& p : partner_) {
      if (p.triangle == kNone) continue;
      const Partner& back = found[p.triangle];
      if (back.triangle == kNone || back.way > kUnlike * p.way || p.way > kUnlike * back.way) p = {};
    }
  }

  /// What has no thickness stays as it is.
  void keep_thin_components() {
    std::vector<double> area(surface_.component_count, 0), thick(surface_.component_count, 0);
    for (uint32_t t = 0; t < cloth_.size(); ++t) {
      area[surface_.component[t]] += cloth_.area(t);
      if (has_partner(t)) thick[surface_.component[t]] += cloth_.area(t);
    }
    std::vector<uint8_t> is_thin(cloth_.size());
    for (uint32_t t = 0; t < cloth_.size(); ++t) {
      const uint32_t c = surface_.component[t];
      is_thin[t] = thick[c] < kWithPartner * area[c] ? 1 : 0;
      if (is_thin[t] != 0) side_[t] = Side::kept;
    }
    for (uint32_t t = 0; t < cloth_.size(); ++t)
      if (has_partner(t) && (is_thin[t] != 0 || is_thin[partner_[t].triangle] != 0)) partner_[t] = {};
  }

  /// Partners are on opposite sides; neighbours on the same one, the flatter their edge the surer. Of each set the
  /// larger side is kept.
  void choose_sides() {
    TwoSidedSets sets(cloth_.size());
    for (uint32_t t = 0; t < cloth_.size(); ++t)
      if (has_partner(t)) sets.join(t, partner_[t].triangle, true);
    std::vector<uint32_t> flattest;  // half-edges
    for (uint32_t h = 0; h < cloth_.opposite().size(); ++h) {
      const uint32_t o = cloth_.opposite()[h];
      if (o == kNone || o < h || !has_partner(h / 3) || !has_partner(o / 3)) continue;
      if (cloth_.cosine(h / 3, o / 3) > kSharp) flattest.push_back(h);
    }
    std::ranges::stable_sort(flattest, [&](uint32_t a, uint32_t b) {
      return cloth_.cosine(a / 3, cloth_.opposite()[a] / 3) > cloth_.cosine(b / 3, cloth_.opposite()[b] / 3);
    });
    for (const uint32_t h : flattest) sets.join(h / 3, cloth_.opposite()[h] / 3, false);
    std::vector<std::array<double, 2>> area(cloth_.size());
    for (uint32_t t = 0; t < cloth_.size(); ++t) {
      const auto [set, across] = sets.find(t);
      if (has_partner(t)) area[set].at(across) += cloth_.area(t);
    }
    for (uint32_t t = 0; t < cloth_.size(); ++t) {
      if (!has_partner(t)) continue;
      const auto [set, across] = sets.find(t);
      const uint8_t larger = area[set][1] > area[set][0] ? 1 : 0;
      side_[t] = across == larger ? Side::kept : Side::other;
    }
  }

  /// Both sides go on into what continues them, a ring of triangles at a time, until they meet.
  void grow_smoothly() {
    std::vector<uint32_t> front;
    for (uint32_t t = 0; t < cloth_.size(); ++t)
      if (side_[t] != Side::unknown) front.push_back(t);
    while (!front.empty()) {
      std::map<uint32_t, Side> next;  // what both claim stays
      for (const uint32_t t : front) {
        for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          const uint32_t u = cloth_.opposite()[h] == kNone ? kNone : cloth_.opposite()[h] / 3;
          if (u == kNone || side_[u] != Side::unknown || cloth_.cosine(t, u) < kSmooth) continue;
          const auto [found, is_new] = next.emplace(u, side_[t]);
          if (!is_new && found->second != side_[t]) found->second = Side::kept;
        }
      }
      front.clear();
      for (const auto& [u, side] : next) {
        side_[u] = side;
        front.push_back(u);
      }
    }
  }

  /// Walls between the sides are of the other one, what is inside one side of that.
  void close_regions() {
    const Components region = connected_on_sides();
    std::vector<uint8_t> touches_other(region.count, 0);
    for (uint32_t h = 0; h < cloth_.opposite().size(); ++h) {
      const uint32_t o = cloth_.opposite()[h];
      if (o != kNone && side_[o / 3] == Side::other) touches_other[region.of_triangle[h / 3]] = 1;
    }
    for (uint32_t t = 0; t < cloth_.size(); ++t)
      if (side_[t] == Side::unknown) side_[t] = touches_other[region.of_triangle[t]] != 0 ? Side::other : Side::kept;
  }

  /// What is small and lies within the other side, or apart from its own, has been misjudged.
  void turn_crumbs() {
    const Components region = connected_on_sides();
    std::vector<double> of_region(region.count, 0), of_component(surface_.component_count, 0);
    for (uint32_t t = 0; t < cloth_.size(); ++t) {
      of_region[region.of_triangle[t]] += cloth_.area(t);
      of_component[surface_.component[t]] += cloth_.area(t);
    }
    for (uint32_t t = 0; t < cloth_.size(); ++t)
      if (of_region[region.of_triangle[t]] < kCrumb * of_component[surface_.component[t]])
        side_[t] = side_[t] == Side::kept ? Side::other : Side::kept;
  }

  /// Regions of one side.
  [[nodiscard]] Components connected_on_sides() const {
    std::vector<uint32_t> opposite = cloth_.opposite();
    for (uint32_t h = 0; h < opposite.size(); ++h)
      if (opposite[h] != kNone && side_[h / 3] != side_[opposite[h] / 3]) opposite[h] = kNone;
    return connected_components(opposite);
  }

  /// Per point: the mean of the ways of the triangles around it that are of the other side.
  [[nodiscard]] std::vector<Point3> ways_across() const {
    std::vector<Point3> sum(surface_.point_count, Point3{0, 0, 0});
    std::vector<double> area(surface_.point_count, 0);
    for (uint32_t t = 0; t < cloth_.size(); ++t) {
      if (side_[t] != Side::other || !has_partner(t)) continue;
      for (const uint32_t v : surface_.triangle[t]) {
        const uint32_t point = surface_.point[v];
        sum[point] = sum[point] + cloth_.inwards(t) * (partner_[t].way * cloth_.area(t));
        area[point] += cloth_.area(t);
      }
    }
    for (uint32_t p = 0; p < sum.size(); ++p)
      if (area[p] > 0) sum[p] = sum[p] * (1 / area[p]);
    return sum;
  }

  const CleanSurface& surface_;
  ThickCloth cloth_;
  std::vector<Partner> partner_;
  std::vector<Side> side_;
};

/// Of the file's triangles those that are mostly on one side.
struct SourceSides {
  std::vector<uint32_t> kept, other;
};
SourceSides sides_of_source(const TriangleMesh& mesh, const CleanSurface& surface, const Layers& layers) {
  std::vector<double> balance(mesh.triangle.size(), 0);
  for (uint32_t t = 0; t < surface.triangle.size(); ++t) {
    if (surface.source_triangle[t] == kNone) continue;
    const Triangle& v = surface.triangle[t];
    const double area = triangle_area(surface.position[v[0]], surface.position[v[1]], surface.position[v[2]]);
    balance[surface.source_triangle[t]] += layers.is_other[t] != 0 ? -area : area;
  }
  SourceSides sides;
  for (uint32_t t = 0; t < balance.size(); ++t) {
    if (balance[t] > 0) sides.kept.push_back(t);
    if (balance[t] < 0) sides.other.push_back(t);
  }
  return sides;
}

std::vector<CarriedPart> other_sides(const TriangleMesh& mesh, const std::vector<uint32_t>& other, double thickness) {
  const double total = surface_area(mesh.position, mesh.triangle);
  std::vector<CarriedPart> carried;
  for (uint32_t p = 0; p < mesh.part.size(); ++p) {
    const SourcePart& part = mesh.part[p];
    const auto first = std::ranges::lower_bound(other, part.first_triangle);
    const auto last = std::ranges::lower_bound(other, part.first_triangle + part.triangle_count);
    if (first == last) continue;
    double area = 0;
    for (auto t = first; t != last; ++t) {
      const Triangle& v = mesh.triangle[*t];
      area += triangle_area(mesh.position[v[0]], mesh.position[v[1]], mesh.position[v[2]]);
    }
    carried.push_back(
        {p, static_cast<uint32_t>(last - first), area / total,
         "a side" + of_part(mesh, p) + ": the other side of cloth that is " + rounded(thickness) + " m thick", true});
  }
  return carried;
}

}  // namespace

std::optional<Layers> find_layers(const CleanSurface& surface) {
  return LayerFinder(surface).find();
}

std::optional<double> find_thickness(const CleanSurface& surface) {
  const ThickCloth cloth(surface);
  const uint32_t step = 1 + cloth.size() / kSampled;
  double area = 0, thick = 0, way = 0;
  for (uint32_t t = 0; t < cloth.size(); t += step) {
    const Partner partner = cloth.partner_of(t);
    area += cloth.area(t);
    if (partner.triangle == kNone) continue;
    thick += cloth.area(t);
    way += cloth.area(t) * partner.way;
  }
  if (!(thick > kNearlyAll * area)) return std::nullopt;
  return way / thick;
}

OneLayer leave_one_layer(const TriangleMesh& mesh, const CleanSurface& surface, const RepairOptions& repair) {
  const std::optional<Layers> layers = find_layers(surface);
  if (!layers) {
    throw Error(ErrorCode::invalid_argument,
                "no part of the mesh is cloth with a thickness, whose second side could ride on the first one; convert "
                "it without --one-layer");
  }
  const SourceSides sides = sides_of_source(mesh, surface, *layers);
  OneLayer result;
  result.surface = repair_mesh(with_triangles(mesh, sides.kept, {}), repair).surface;
  for (uint32_t& t : result.surface.source_triangle)
    if (t != kNone) t = sides.kept[t];
  result.carried = other_sides(mesh, sides.other, layers->thickness);
  result.beside = mesh.position;
  for (size_t v = 0; v < mesh.position.size(); ++v)
    if (const uint32_t p = surface.source_point[v]; p != kNone) result.beside[v] = result.beside[v] + layers->across[p];
  return result;
}

}  // namespace geocloth
