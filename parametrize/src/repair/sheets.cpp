// SPDX-License-Identifier: GPL-3.0-or-later
// Sheets out of a triangle complex. Faces are joined side by side: over an edge with two faces both, over an edge with
// more the most coplanar pair. A walk over the joints orients every sheet and tears the joints that contradict it.
// A vertex is one fan: the corners at a point that joints connect. So detached sheets, tears and bow-tie vertices are
// all the same thing, vertices with one point. CGAL's orient_polygon_soup tears the shirt where a pocket is sewn to it
// (three faces on an edge), because it opens the whole edge; hence our own.
#include "repair/sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

#include "geocloth/asset/disjoint_sets.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

/// Side k of triangle t has number 3 t + k and runs from corner k to the next.
uint32_t next_side(uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

/// Disjoint sets of faces that know which of them run the same way round.
class OrientedSets {
 public:
  explicit OrientedSets(std::size_t size) : parent_(size), size_(size, 1), turned_(size, 0) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  /// States that a and b run opposite ways round, or the same. @returns false, and changes nothing, if that
  /// contradicts what was stated before
  bool relate(uint32_t a, uint32_t b, bool opposite) {
    uint8_t turn = opposite ? 1 : 0;
    for (uint32_t* i : {&a, &b}) {
      for (; parent_[*i] != *i; *i = parent_[*i]) turn ^= turned_[*i];
    }
    if (a == b) return turn == 0;
    if (size_[a] > size_[b]) std::swap(a, b);  // by size, so that the ways up stay short
    parent_[a] = b;
    turned_[a] = turn;
    size_[b] += size_[a];
    return true;
  }

 private:
  std::vector<uint32_t> parent_, size_;
  std::vector<uint8_t> turned_;
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
    const uint64_t joints = count_joints();
    settle_vertices();
    const uint64_t settled = count_joints();
    repairs_.torn_edges += joints > settled ? joints - settled : 0;
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

  uint64_t count_joints() const {
    return (sides_ - static_cast<uint64_t>(std::count(joint_.begin(), joint_.end(), kNone))) / 2;
  }

  // --- which faces continue each other -----------------------------------------------------------------------------

  void join_sides() {
    crowded_.assign(soup_.position.size(), false);
    by_edge_ = sorted_sides([&](uint32_t s) { return point(s); });
    OrientedSets way(soup_.triangle.size());
    std::vector<Pair> pairs;
    for_each_edge(by_edge_, [&](std::span<const Side> faces) {
      if (faces.size() == 2) {
        join(faces[0].side, faces[1].side);
        way.relate(faces[0].side / 3, faces[1].side / 3, same_way(faces[0].side, faces[1].side));
      } else if (faces.size() > 2) {
        mark_crowded(faces[0].side);
        repairs_.detached_sheets += faces.size() - 2;
        list_pairs(faces, pairs);
      }
    });
    join_pairs(pairs, way);
  }

  /// Whether two faces run along their common edge in the same direction, as the file has them.
  bool same_way(uint32_t a, uint32_t b) const { return point(a) == point(b); }

  /// Two faces at an edge with more than two.
  struct Pair {
    double cost, cosine;
    uint64_t edge;
    uint32_t a, b;
  };

  /// Unit vector in the plane of the side's face, away from the edge a-b.
  Point3 wing(uint32_t side, const Point3& a, const Point3& b) const {
    const Point3 d = b - a, to_apex = place(next_side(next_side(side))) - a;
    const Point3 w = to_apex - d * (dot(to_apex, d) / dot(d, d));
    return w * (1 / length(w));
  }

  void list_pairs(std::span<const Side> faces, std::vector<Pair>& pairs) const {
    constexpr std::size_t kMostFaces = 128;  // beyond it this is no garment, and pairs are too many to look at
    if (faces.size() > kMostFaces) faces = faces.first(kMostFaces);
    const Point3 &low = soup_.position[faces[0].edge >> 32U], &high = soup_.position[faces[0].edge & 0xFFFFFFFFU];
    std::vector<Point3> wings;
    for (const Side& face : faces) wings.push_back(wing(face.side, low, high));
    for (std::size_t i = 0; i < faces.size(); ++i) {
      for (std::size_t j = i + 1; j < faces.size(); ++j) {
        const uint32_t a = faces[i].side, b = faces[j].side;
        const double cosine = dot(wings[i], wings[j]);  // -1: coplanar, 1: one on the other
        pairs.push_back({(1 + cosine) / 2 + strangeness(a, b), cosine, faces[0].edge, a, b});
      }
    }
  }

  /// Joins pairs, the best of the whole mesh first: at every edge one, and more unless they lie on one another.
  /// A pair that would make a sheet one-sided stays apart.
  void join_pairs(std::vector<Pair>& pairs, OrientedSets& way) {
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.cost < b.cost; });
    std::set<uint64_t> has_pair;
    for (const Pair& pair : pairs) {
      if (joint_[pair.a] != kNone || joint_[pair.b] != kNone) continue;
      if (pair.cosine >= 0.5 && has_pair.contains(pair.edge)) continue;
      if (!way.relate(pair.a / 3, pair.b / 3, same_way(pair.a, pair.b))) continue;
      join(pair.a, pair.b);
      has_pair.insert(pair.edge);
    }
  }

  /// Faces of different parts, or that run different ways round, are less likely one sheet.
  double strangeness(uint32_t a, uint32_t b) const {
    const auto &p = part_[soup_.source[a / 3]], &q = part_[soup_.source[b / 3]];
    return (p[0] != q[0] ? 0.15 : 0) + (p[1] != q[1] ? 0.15 : 0) + (same_way(a, b) ? 0.3 : 0);
  }

  // --- orientation ---------------------------------------------------------------------------------------------------

  /// Whether the joined faces run the same way round along their edge, which one sheet must not.
  bool clash(uint32_t side) const {
    const uint32_t other = joint_[side];
    return same_way(side, other) != (flipped_[side / 3] != flipped_[other / 3]);
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
      fans.join(s, same_way(s, t) ? t : next_side(t));
      fans.join(next_side(s), same_way(s, t) ? next_side(t) : t);
    }
    vertex_.resize(sides_);
    for (uint32_t c = 0; c < sides_; ++c) vertex_[c] = fans.find(c);
  }

  /// A fan may come by the same edge twice. If that is so at both ends of the edge, two vertices are the ends of more
  /// than one side pair, and who only sees vertex numbers takes them for one edge. Such edges are opened, and joined
  /// again so that the fan falls into two at one end; where that does not help, all joints around one end are opened.
  void settle_vertices() {
    std::set<uint64_t> opened;
    std::vector<bool> burst(soup_.position.size(), false);
    for (std::size_t round = 0;; ++round) {
      find_fans();
      std::set<uint64_t> fresh, stubborn;
      for (const uint64_t edge : edges_met_twice()) (opened.insert(edge).second ? fresh : stubborn).insert(edge);
      if (fresh.empty() && stubborn.empty()) return;
      for (const uint64_t edge : fresh) {
        for (const Side& face : faces_at(edge)) open(face.side);
      }
      for (const uint64_t edge : stubborn) {
        // Some of many ends may do; but the work has to end.
        const auto low = static_cast<uint32_t>(edge >> 32U), high = static_cast<uint32_t>(edge);
        if (burst[low] || round > 8) burst[high] = true;
        burst[low] = true;
      }
      if (!stubborn.empty()) open_around(burst);
      find_fans();
      for (const uint64_t edge : fresh) join_by_fan(faces_at(edge));
    }
  }

  /// Edges, by their points, whose ends are vertices of another edge too.
  std::vector<uint64_t> edges_met_twice() const {
    std::vector<uint64_t> edges;
    for_each_edge(sorted_sides([&](uint32_t s) { return vertex_[s]; }), [&](std::span<const Side> faces) {
      const uint32_t a = faces[0].side;
      if (faces.size() == 1 || (faces.size() == 2 && joint_[a] == faces[1].side)) return;
      const uint32_t p = point(a), q = point(next_side(a));
      edges.push_back(uint64_t{std::min(p, q)} << 32U | std::max(p, q));
    });
    return edges;
  }

  std::span<const Side> faces_at(uint64_t edge) const {
    const auto less = [](const Side& a, const Side& b) { return a.edge < b.edge; };
    const auto [from, to] = std::equal_range(by_edge_.begin(), by_edge_.end(), Side{edge, 0}, less);
    return {from, to};
  }

  /// The vertex of a side at its end with the lower point number, or at the other.
  uint32_t end_vertex(uint32_t side, bool at_low) const {
    const bool starts_low = point(side) < point(next_side(side));
    return vertex_[starts_low == at_low ? side : next_side(side)];
  }

  /// Joins the free faces of an edge that are in one fan at both of its ends, or else at one of them.
  void join_by_fan(std::span<const Side> faces) {
    const auto try_all = [&](auto&& fits) {
      for (std::size_t i = 0; i < faces.size(); ++i) {
        for (std::size_t j = i + 1; j < faces.size(); ++j) {
          const uint32_t a = faces[i].side, b = faces[j].side;
          const bool free = joint_[a] == kNone && joint_[b] == kNone;
          const bool consistent = same_way(a, b) == (flipped_[a / 3] != flipped_[b / 3]);
          if (!free || !consistent || !fits(a, b)) continue;
          join(a, b);
        }
      }
    };
    const auto meet = [&](uint32_t a, uint32_t b, bool at_low) {
      return end_vertex(a, at_low) == end_vertex(b, at_low);
    };
    try_all([&](uint32_t a, uint32_t b) { return meet(a, b, true) && meet(a, b, false); });
    for (const bool at_low : {true, false}) {
      const auto first = joint_[faces[0].side];
      try_all([&](uint32_t a, uint32_t b) { return meet(a, b, at_low); });
      if (joint_[faces[0].side] != first) return;
    }
  }

  void open(uint32_t side) {
    if (joint_[side] == kNone) return;
    mark_crowded(side);
    part_with(side);
  }

  void open_around(const std::vector<bool>& burst) {
    for (uint32_t s = 0; s < sides_; ++s) {
      if (burst[point(s)] || burst[point(next_side(s))]) open(s);
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
    const std::vector<uint32_t> number = number_vertices(out);
    for (uint32_t t = 0; t < soup_.triangle.size(); ++t) {
      Triangle triangle{number[vertex_[3 * t]], number[vertex_[3 * t + 1]], number[vertex_[3 * t + 2]]};
      if (flipped_[t] != 0) std::swap(triangle[1], triangle[2]);
      out.triangle.push_back(triangle);
    }
    count_bow_ties(out);
    return out;
  }

  /// Vertices in the order of their points; the copies of a point by the first triangle they occur in.
  std::vector<uint32_t> number_vertices(CleanSurface& out) const {
    std::vector<uint32_t> fans;
    for (uint32_t c = 0; c < sides_; ++c) {
      if (vertex_[c] == c) fans.push_back(c);
    }
    std::stable_sort(fans.begin(), fans.end(), [&](uint32_t a, uint32_t b) { return point(a) < point(b); });
    std::vector<uint32_t> number(sides_, kNone);
    for (const uint32_t fan : fans) {
      number[fan] = static_cast<uint32_t>(out.position.size());
      out.position.push_back(place(fan));
      out.point.push_back(point(fan));
    }
    return number;
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
  std::vector<Side> by_edge_;    ///< all sides, sorted by the points of their edge
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
