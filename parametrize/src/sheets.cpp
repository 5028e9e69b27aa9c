// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets out of a triangle complex. Faces are joined side by side: over an edge with two faces both, over an edge with
// more the most coplanar pair. A walk over the joints orients every sheet and tears the joints that contradict it.
// A vertex is one fan: the corners at a point that joints connect. So detached sheets, tears and bow-tie vertices are
// all the same thing, vertices with one point. CGAL's orient_polygon_soup tears the shirt where a pocket is sewn to it
// (three faces on an edge), because it opens the whole edge; hence our own.
#include "sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "point_math.h"

namespace geocloth {
namespace {

/// Side k of triangle t has number 3 t + k and runs from corner k to the next.
uint32_t next_side(uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0U); }
  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

class SheetMaker {
 public:
  SheetMaker(const Soup& soup, const std::vector<std::array<uint32_t, 2>>& part, SheetRepairs& repairs)
      : soup_(soup),
        part_(part),
        repairs_(repairs),
        sides_(static_cast<uint32_t>(soup.triangle.size() * 3)),
        joint_(sides_, kNone),
        flipped_(soup.triangle.size(), 0) {}

  CleanSurface make() {
    join_sides();
    orient();
    settle_vertices();
    number_components();
    choose_outside();
    return collect();
  }

 private:
  uint32_t point(uint32_t corner) const { return soup_.triangle[corner / 3][corner % 3]; }
  const Point3& place(uint32_t corner) const { return soup_.position[point(corner)]; }

  /// Sides sorted by the points of their edge, so that the faces of an edge stand together.
  struct Side {
    uint64_t edge;
    uint32_t side;
  };
  template <typename Key>
  std::vector<Side> sorted_sides(Key&& end_of) const {
    std::vector<Side> all(sides_);
    for (uint32_t s = 0; s < sides_; ++s) {
      const uint32_t a = end_of(s), b = end_of(next_side(s));
      all[s] = {uint64_t{std::min(a, b)} << 32U | std::max(a, b), s};
    }
    std::sort(all.begin(), all.end(),
              [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.side < b.side; });
    return all;
  }
  template <typename Visit>
  static void for_each_edge(const std::vector<Side>& all, Visit&& visit) {
    for (std::size_t i = 0; i < all.size();) {
      std::size_t end = i;
      while (end < all.size() && all[end].edge == all[i].edge) ++end;
      visit(std::span<const Side>(all).subspan(i, end - i));
      i = end;
    }
  }

  void join(uint32_t a, uint32_t b) {
    joint_[a] = b;
    joint_[b] = a;
  }
  void part_with(uint32_t a) {
    if (joint_[a] == kNone) return;
    joint_[joint_[a]] = kNone;
    joint_[a] = kNone;
  }

  // --- which faces continue each other -----------------------------------------------------------------------------

  void join_sides() {
    crowded_.assign(soup_.position.size(), false);
    for_each_edge(sorted_sides([&](uint32_t s) { return point(s); }), [&](std::span<const Side> faces) {
      if (faces.size() == 2) {
        join(faces[0].side, faces[1].side);
      } else if (faces.size() > 2) {
        crowded_[point(faces[0].side)] = crowded_[point(next_side(faces[0].side))] = true;
        repairs_.detached_sheets += faces.size() - 2;
        pair_up(faces);
      }
    });
  }

  /// Unit vector in the plane of the side's face, away from the edge a-b.
  Point3 wing(uint32_t side, const Point3& a, const Point3& b) const {
    const Point3 d = b - a, to_apex = place(next_side(next_side(side))) - a;
    const Point3 w = to_apex - d * (dot(to_apex, d) / dot(d, d));
    return w * (1 / length(w));
  }

  /// Joins pairs of faces at a crowded edge: the best first, then the rest unless they lie on one another.
  void pair_up(std::span<const Side> faces) {
    constexpr std::size_t most = 128;  // beyond it this is no garment, and pairs are too many to look at
    if (faces.size() > most) faces = faces.first(most);
    struct Pair {
      double cost, cosine;
      uint32_t a, b;
    };
    const uint32_t low = std::min(point(faces[0].side), point(next_side(faces[0].side)));
    const uint32_t high = std::max(point(faces[0].side), point(next_side(faces[0].side)));
    std::vector<Point3> wings;
    for (const Side& face : faces) wings.push_back(wing(face.side, soup_.position[low], soup_.position[high]));
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        const uint32_t a = faces[i].side, b = faces[j].side;
        const double cosine = dot(wings[i], wings[j]);  // -1: coplanar, 1: one on the other
        pairs.push_back({(1 + cosine) / 2 + strangeness(a, b), cosine, a, b});
      }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const bool both_free = joint_[pairs[i].a] == kNone && joint_[pairs[i].b] == kNone;
      if (both_free && (i == 0 || pairs[i].cosine < 0.5)) join(pairs[i].a, pairs[i].b);
    }
  }

  /// Faces of different parts, or that run different ways round, are less likely one sheet.
  double strangeness(uint32_t a, uint32_t b) const {
    const auto &p = part_[soup_.source[a / 3]], &q = part_[soup_.source[b / 3]];
    const bool same_way = point(a) == point(b);
    return (p[0] != q[0] ? 0.15 : 0) + (p[1] != q[1] ? 0.15 : 0) + (same_way ? 0.3 : 0);
  }

  // --- orientation ---------------------------------------------------------------------------------------------------

  /// Whether the joined faces run the same way round along their edge, which one sheet must not.
  bool clash(uint32_t side) const {
    const uint32_t other = joint_[side];
    const bool same_way = point(side) == point(other);
    return same_way != (flipped_[side / 3] != flipped_[other / 3]);
  }

  void orient() {
    std::vector<bool> seen(soup_.triangle.size(), false);
    std::vector<uint32_t> queue;
    for (uint32_t seed = 0; seed < seen.size(); ++seed) {
      if (seen[seed]) continue;
      seen[seed] = true;
      queue.assign(1, seed);
      for (std::size_t at = 0; at < queue.size(); ++at) visit_neighbours(queue[at], seen, queue);
    }
    for (uint32_t s = 0; s < sides_; ++s) {
      if (joint_[s] == kNone || !clash(s)) continue;
      mark_crowded(s);
      part_with(s);
      ++repairs_.torn_edges;
    }
  }

  void visit_neighbours(uint32_t triangle, std::vector<bool>& seen, std::vector<uint32_t>& queue) {
    for (uint32_t side = 3 * triangle; side < 3 * triangle + 3; ++side) {
      if (joint_[side] == kNone || seen[joint_[side] / 3]) continue;
      const uint32_t other = joint_[side] / 3;
      if (clash(side)) flipped_[other] ^= 1;
      seen[other] = true;
      queue.push_back(other);
    }
  }

  void mark_crowded(uint32_t side) { crowded_[point(side)] = crowded_[point(next_side(side))] = true; }

  // --- vertices ------------------------------------------------------------------------------------------------------

  /// Fans: corners that joints connect. vertex_[corner] is the first corner of its fan.
  void find_fans() {
    DisjointSets fans(sides_);
    for (uint32_t s = 0; s < sides_; ++s) {
      if (joint_[s] == kNone || joint_[s] < s) continue;
      const uint32_t t = joint_[s];
      const bool same_way = point(s) == point(t);
      fans.join(s, same_way ? t : next_side(t));
      fans.join(next_side(s), same_way ? next_side(t) : t);
    }
    vertex_.resize(sides_);
    for (uint32_t c = 0; c < sides_; ++c) vertex_[c] = fans.find(c);
  }

  /// Fans may meet along an edge twice: then two vertices are the ends of more than one joint or border side, and who
  /// only sees vertex numbers would take them for one edge. Such edges are opened; if that does not part them, free
  /// sides that fit are joined, and at last all joints around one end are opened.
  void settle_vertices() {
    std::set<uint64_t> opened;
    std::set<uint32_t> burst;
    for (bool settled = false; !settled;) {
      find_fans();
      settled = true;
      for_each_edge(sorted_sides([&](uint32_t s) { return vertex_[s]; }), [&](std::span<const Side> faces) {
        if (faces.size() == 1 || (faces.size() == 2 && joint_[faces[0].side] == faces[1].side)) return;
        settled = false;
        settle_edge(faces, opened, burst);
      });
    }
  }

  void settle_edge(std::span<const Side> faces, std::set<uint64_t>& opened, std::set<uint32_t>& burst) {
    const uint32_t a = faces[0].side, b = faces[1].side;
    const bool free = joint_[a] == kNone && joint_[b] == kNone;
    if (faces.size() == 2 && free && (point(a) == point(b)) == (flipped_[a / 3] != flipped_[b / 3])) {
      join(a, b);
      return;
    }
    const uint32_t low = std::min(point(a), point(next_side(a))), high = std::max(point(a), point(next_side(a)));
    mark_crowded(a);
    if (opened.insert(uint64_t{low} << 32U | high).second) {
      for (const Side& face : faces) open(face.side);
      return;
    }
    burst_point(burst.insert(low).second ? low : high, burst);
  }

  void open(uint32_t side) {
    if (joint_[side] == kNone) return;
    mark_crowded(side);
    part_with(side);
    ++repairs_.torn_edges;
  }

  void burst_point(uint32_t p, std::set<uint32_t>& burst) {
    burst.insert(p);
    for (uint32_t s = 0; s < sides_; ++s) {
      if (point(s) == p || point(next_side(s)) == p) open(s);
    }
  }

  // --- components ----------------------------------------------------------------------------------------------------

  void number_components() {
    DisjointSets sets(soup_.triangle.size());
    for (uint32_t s = 0; s < sides_; ++s) {
      if (joint_[s] != kNone) sets.join(s / 3, joint_[s] / 3);
    }
    component_.assign(soup_.triangle.size(), 0);
    for (uint32_t t = 0; t < soup_.triangle.size(); ++t) {
      const uint32_t root = sets.find(t);
      component_[t] = root == t ? component_count_++ : component_[root];
    }
  }

  /// A closed sheet is turned with its outside out; any other keeps the way round that most of it has in the file.
  void choose_outside() {
    struct Sums {
      uint64_t kept = 0, flipped = 0;
      double volume = 0;
      bool closed = true;
      Point3 origin{};
      bool first = true;
    };
    std::vector<Sums> sums(component_count_);
    for (uint32_t t = 0; t < soup_.triangle.size(); ++t) {
      Sums& sum = sums[component_[t]];
      if (sum.first) sum.origin = place(3 * t);
      sum.first = false;
      ++(flipped_[t] != 0 ? sum.flipped : sum.kept);
      const Point3 a = place(3 * t) - sum.origin, b = place(3 * t + 1) - sum.origin, c = place(3 * t + 2) - sum.origin;
      sum.volume += dot(a, cross(b, c)) * (flipped_[t] != 0 ? -1 : 1);
      for (uint32_t s = 3 * t; s < 3 * t + 3; ++s) sum.closed = sum.closed && joint_[s] != kNone;
    }
    for (uint32_t t = 0; t < soup_.triangle.size(); ++t) {
      const Sums& sum = sums[component_[t]];
      const bool turn = sum.closed && sum.volume != 0 ? sum.volume < 0 : sum.flipped > sum.kept;
      flipped_[t] ^= turn ? 1 : 0;
      repairs_.flipped_faces += flipped_[t];
    }
  }

  // --- result
  // ----------------------------------------------------------------------------------------------------------

  CleanSurface collect() {
    CleanSurface out;
    out.point_count = static_cast<uint32_t>(soup_.position.size());
    out.component = component_;
    out.component_count = component_count_;
    out.source_triangle = soup_.source;
    std::vector<uint32_t> number(sides_, kNone);
    for (uint32_t t = 0; t < soup_.triangle.size(); ++t) {
      Triangle triangle{};
      for (uint32_t k = 0; k < 3; ++k) triangle[k] = number_vertex(vertex_[3 * t + k], number, out);
      if (flipped_[t] != 0) std::swap(triangle[1], triangle[2]);
      out.triangle.push_back(triangle);
    }
    count_bow_ties(out);
    return out;
  }

  uint32_t number_vertex(uint32_t fan, std::vector<uint32_t>& number, CleanSurface& out) const {
    if (number[fan] == kNone) {
      number[fan] = static_cast<uint32_t>(out.position.size());
      out.position.push_back(place(fan));
      out.point.push_back(point(fan));
    }
    return number[fan];
  }

  void count_bow_ties(const CleanSurface& out) {
    std::vector<uint32_t> copies(out.point_count, 0);
    for (const uint32_t p : out.point) ++copies[p];
    for (uint32_t p = 0; p < out.point_count; ++p) {
      if (copies[p] > 1 && !crowded_[p]) repairs_.bow_ties += copies[p] - 1;
    }
  }

  const Soup& soup_;
  const std::vector<std::array<uint32_t, 2>>& part_;
  SheetRepairs& repairs_;
  uint32_t sides_;
  std::vector<uint32_t> joint_;  ///< per side: the side it is joined to, or kNone
  std::vector<uint8_t> flipped_;
  std::vector<bool> crowded_;  ///< per point: an edge there has, or had, more than two faces, or was torn
  std::vector<uint32_t> vertex_, component_;
  uint32_t component_count_ = 0;
};

}  // namespace

CleanSurface make_manifold(const Soup& soup, const std::vector<std::array<uint32_t, 2>>& part, SheetRepairs& repairs) {
  return SheetMaker(soup, part, repairs).make();
}

}  // namespace geocloth
