// SPDX-License-Identifier: GPL-3.0-or-later
// Borders that lie along each other are sewn: points of them that nearly meet become one, and edges are split where the
// other border has a point on them (T-junctions).
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "mesh/point_math.h"
#include "mesh/point_tree.h"
#include "repair/near_groups.h"
#include "repair/soup.h"

namespace geocloth {
namespace {

/// Two vertices of a seam that are nearer to each other than this share of the edges there failed to meet: a split
/// would leave a sliver between them.
constexpr double kMeant = 0.1;
/// What is left that is nearer to an end of an edge splits it all the same, down to slivers of this share.
constexpr double kSliver = 0.02;

/// What the border of a soup looks like around its points. One round of splitting: at most one side of every triangle.
class TJunctions {
 public:
  /// @param shortest  per point: its shortest border edge [m]; empty: as it is now
  TJunctions(Soup& soup, double tolerance, std::vector<double> shortest = {})
      : soup_(soup),
        tolerance_(tolerance),
        border_(border_sides(soup.triangle)),
        shortest_(shortest.empty() ? shortest_edges() : std::move(shortest)),
        tree_(soup.position, border_points()) {}

  const std::vector<double>& shortest() const { return shortest_; }

  /// Joins points that failed to meet. The new point stands in the middle of them, whichever comes first in the file.
  /// @param vertex_point  per vertex of the file: its point @returns whether there were any
  bool join(std::vector<uint32_t>& vertex_point) {
    const std::vector<double> shortest = shortest_sides();
    const std::vector<NearPair> pairs = pairs_that_failed(shortest);
    std::vector<double> reach = shortest;
    for (double& r : reach) r *= 0.5;  // so that nothing collapses
    const std::vector<Point3> place = soup_.position;
    NearGroups groups(place, reach);
    bool any = false;
    for (const NearPair& pair : pairs) any = groups.join(pair) || any;
    if (!any) return false;
    for (const NearPair& pair : pairs) {
      const uint32_t root = groups.find(pair.a);
      soup_.position[root] = middle(place, groups.members(root));
    }
    for (Triangle& t : soup_.triangle) {
      for (uint32_t& p : t) p = groups.find(p);
    }
    for (uint32_t& p : vertex_point) p = p == kNone ? kNone : groups.find(p);
    return true;
  }

  /// @returns how many points were put on sides
  uint64_t split() {
    struct Met {
      BorderSide side;
      std::vector<OnSide> points;
    };
    std::vector<Met> all;
    for (const BorderSide& side : border_) {
      std::vector<OnSide> points = points_on(side);
      if (points.empty()) continue;
      if (is_covered(side, points)) covered_.insert(edge_of(start(side), end(side)));
      all.push_back({side, std::move(points)});
    }
    uint64_t met = 0;
    uint32_t done = kNone;
    for (auto& [side, points] : all) {
      if (side.triangle == done) continue;
      if (!is_covered(side, points)) keep_of_seams(side, points);
      if (points.empty()) continue;
      split_side(side, points);
      met += points.size();
      done = side.triangle;
    }
    return met;
  }

 private:
  struct OnSide {
    double at;
    uint32_t point;
    bool operator<(const OnSide& o) const { return at != o.at ? at < o.at : point < o.point; }
  };

  /// Per point: its shortest border edge; the largest number where there is none.
  std::vector<double> shortest_edges() const {
    std::vector<double> shortest(soup_.position.size(), std::numeric_limits<double>::max());
    for (const BorderSide& side : border_) {
      const double l = distance(place(start(side)), place(end(side)));
      for (const uint32_t p : {start(side), end(side)}) shortest[p] = std::min(shortest[p], l);
    }
    return shortest;
  }

  /// Points on the border, ascending; fills neighbours_ on the way.
  std::vector<uint32_t> border_points() {
    std::vector<uint32_t> points;
    for (const BorderSide& side : border_) {
      const uint32_t a = start(side), b = end(side);
      neighbours_.push_back({a, b});
      neighbours_.push_back({b, a});
    }
    std::sort(neighbours_.begin(), neighbours_.end());
    for (const auto& [a, b] : neighbours_) {
      if (points.empty() || points.back() != a) points.push_back(a);
    }
    return points;
  }

  const Point3& place(uint32_t point) const { return soup_.position[point]; }
  uint32_t start(const BorderSide& side) const { return soup_.triangle[side.triangle][side.corner]; }
  uint32_t end(const BorderSide& side) const { return soup_.triangle[side.triangle][(side.corner + 1) % 3]; }
  uint32_t apex(const BorderSide& side) const { return soup_.triangle[side.triangle][(side.corner + 2) % 3]; }

  /// The border edges that start in a point, as (point, next point).
  std::span<const std::array<uint32_t, 2>> edges_from(uint32_t a) const {
    const auto first = std::lower_bound(neighbours_.begin(), neighbours_.end(), std::array<uint32_t, 2>{a, 0});
    return {first, std::find_if(first, neighbours_.end(), [&](const auto& edge) { return edge[0] != a; })};
  }

  /// How far from the edge a-b the point p may be to lie on it.
  double most_height(uint32_t a, uint32_t b, uint32_t p) const {
    return std::min(tolerance_, 0.5 * std::min(distance(place(a), place(b)), shortest_[p]));
  }

  // --- points that failed to meet ------------------------------------------------------------------------------------

  /// Per point, the shortest side of its triangles.
  std::vector<double> shortest_sides() const {
    std::vector<double> shortest(soup_.position.size(), std::numeric_limits<double>::max());
    for (const Triangle& t : soup_.triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        const uint32_t a = t[k], b = t[(k + 1) % 3];
        const double l = distance(place(a), place(b));
        shortest[a] = std::min(shortest[a], l);
        shortest[b] = std::min(shortest[b], l);
      }
    }
    return shortest;
  }

  /// Pairs of points next to each other on borders that run together, where the numbers of their points differ: those
  /// of seams with like numbers are apart because they are not drawn together, and only partly so within the tolerance.
  std::vector<NearPair> pairs_that_failed(const std::vector<double>& shortest) const {
    const std::vector<NearPair> near = near_pairs(shortest);
    std::map<std::array<uint32_t, 2>, std::size_t> number;
    for (std::size_t i = 0; i < near.size(); ++i) number[{near[i].a, near[i].b}] = i;
    std::vector<bool> taken(near.size(), false);
    std::vector<std::size_t> queue;
    const auto take = [&](std::size_t i) {
      if (!taken[i]) queue.push_back(i);
      taken[i] = true;
    };
    for (std::size_t i = 0; i < near.size(); ++i) {
      if (is_before_t_junction(near[i].a, near[i].b)) take(i);
    }
    std::vector<NearPair> pairs;
    for (std::size_t at = 0; at < queue.size(); ++at) {
      const auto& [d, a, p] = near[queue[at]];
      pairs.push_back(near[queue[at]]);
      for (const auto& [from_a, b] : edges_from(a)) {
        for (const auto& [from_p, q] : edges_from(p)) {
          const auto next = number.find({std::min(b, q), std::max(b, q)});
          if (next != number.end()) take(next->second);
        }
      }
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

  std::vector<NearPair> near_pairs(const std::vector<double>& shortest) const {
    std::vector<NearPair> pairs;
    for (std::size_t i = 0; i < neighbours_.size(); ++i) {
      const uint32_t a = neighbours_[i][0];
      if (i > 0 && neighbours_[i - 1][0] == a) continue;
      tree_.near_segment(place(a), place(a), kMeant * shortest[a] + std::min(tolerance_, shortest[a]), [&](uint32_t p) {
        const double most = kMeant * std::min(shortest[a], shortest[p]);
        if (p > a && (lies_next(a, p, most) || lies_next(p, a, most))) {
          pairs.push_back({distance(place(a), place(p)), a, p});
        }
      });
    }
    return pairs;
  }

  /// Whether p lies on a border edge at a, near a.
  bool lies_next(uint32_t a, uint32_t p, double most_along) const {
    const auto edges = edges_from(a);
    return std::any_of(edges.begin(), edges.end(), [&](const auto& edge) {
      const Foot foot = foot_on(place(a), place(edge[1]), place(p));
      return foot.at >= 0 && foot.at * distance(place(a), place(edge[1])) <= most_along &&
             foot.height <= most_height(a, edge[1], p);
    });
  }

  /// Whether a border edge at a and one at p run the same way and the shorter ends on the other, well before its end.
  bool is_before_t_junction(uint32_t a, uint32_t p) const {
    for (const auto& [from_a, b] : edges_from(a)) {
      for (const auto& [from_p, q] : edges_from(p)) {
        if (between(a, b, q, kMeant) || between(p, q, b, kMeant)) return true;
      }
    }
    return false;
  }

  static Point3 middle(const std::vector<Point3>& place, const std::vector<uint32_t>& group) {
    std::vector<Point3> places(group.size());
    std::transform(group.begin(), group.end(), places.begin(), [&](uint32_t i) { return place[i]; });
    std::sort(places.begin(), places.end());
    Point3 sum{0, 0, 0};
    for (const Point3& p : places) sum = sum + p;
    return sum * (1 / static_cast<double>(places.size()));
  }

  // --- points on sides -----------------------------------------------------------------------------------------------

  /// Where p lies on a-b, if it does, farther from its ends than a share of the edges there.
  std::optional<double> between(uint32_t a, uint32_t b, uint32_t p, double share) const {
    const Foot foot = foot_on(place(a), place(b), place(p));
    const double l = distance(place(a), place(b));
    const double margin = share * std::min(l, shortest_[p]) / l;
    if (foot.height > most_height(a, b, p) || foot.at <= margin || foot.at >= 1 - margin) return std::nullopt;
    return foot.at;
  }

  std::vector<OnSide> points_on(const BorderSide& side) const {
    const uint32_t a = start(side), b = end(side), c = apex(side);
    std::vector<OnSide> found;
    tree_.near_segment(place(a), place(b), std::min(tolerance_, distance(place(a), place(b))), [&](uint32_t p) {
      if (p == a || p == b || p == c) return;
      if (const auto at = between(a, b, p, kSliver)) found.push_back({*at, p});
    });
    std::sort(found.begin(), found.end());
    return found;
  }

  static std::array<uint32_t, 2> edge_of(uint32_t a, uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

  enum class Cover { none, by_a_part, by_a_whole };
  /// Whether a border edge that starts in `from` begins with the piece from-to, and all of it lies on borders.
  Cover cover_from(uint32_t from, uint32_t to) const {
    Cover cover = Cover::none;
    for (const auto& [a, b] : edges_from(from)) {
      if (b != to && !between(a, b, to, kSliver)) continue;
      cover = std::max(cover, b == to || covered_.contains(edge_of(a, b)) ? Cover::by_a_whole : Cover::by_a_part);
    }
    return cover;
  }

  /// Of the piece that ends at point i of a side.
  Cover cover_at(const BorderSide& side, const std::vector<OnSide>& points, std::size_t i) const {
    const uint32_t from = i == 0 ? start(side) : points[i - 1].point;
    const uint32_t to = i == points.size() ? end(side) : points[i].point;
    // The side itself covers the first piece from its start, and likewise the last: ask from the other end there.
    const Cover forth = i > 0 ? cover_from(from, to) : Cover::none;
    return std::max(forth, i < points.size() ? cover_from(to, from) : Cover::none);
  }

  /// Whether points make a side a seam: every piece between them lies along another border edge. Points that only touch
  /// the side from the air make none: sheets that rest on each other would be tacked together there.
  bool is_covered(const BorderSide& side, const std::vector<OnSide>& points) const {
    for (std::size_t i = 0; i <= points.size(); ++i) {
      if (cover_at(side, points, i) == Cover::none) return false;
    }
    return true;
  }

  /// Keeps the points where a seam ends in the midst of a side: one of the pieces there lies along a whole edge.
  void keep_of_seams(const BorderSide& side, std::vector<OnSide>& points) const {
    for (bool more = true; more;) {
      std::vector<OnSide> kept;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::max(cover_at(side, points, i), cover_at(side, points, i + 1)) == Cover::by_a_whole) {
          kept.push_back(points[i]);
        }
      }
      more = kept.size() < points.size();
      points = std::move(kept);
    }
  }

  void split_side(const BorderSide& side, const std::vector<OnSide>& points) {
    const uint32_t c = apex(side), last = end(side);
    uint32_t from = start(side);
    for (std::size_t i = 0; i <= points.size(); ++i) {
      const uint32_t to = i < points.size() ? points[i].point : last;
      if (i == 0) {
        soup_.triangle[side.triangle] = {from, to, c};
      } else {
        soup_.triangle.push_back({from, to, c});
        soup_.source.push_back(soup_.source[side.triangle]);
      }
      from = to;
    }
  }

  Soup& soup_;
  double tolerance_;
  std::vector<BorderSide> border_;
  std::vector<double> shortest_;                     ///< per point: its shortest border edge [m]
  std::vector<std::array<uint32_t, 2>> neighbours_;  ///< (border point, next border point), ascending
  PointTree tree_;
  std::set<std::array<uint32_t, 2>>
      covered_;  ///< border edges all along which others lie, as (lower point, higher point)
};

}  // namespace

uint64_t sew_borders(Soup& soup, std::vector<uint32_t>& vertex_point, double tolerance) {
  uint64_t met = 0;
  if (!(tolerance > 0)) return met;
  std::optional<TJunctions> border(std::in_place, soup, tolerance);
  while (border->join(vertex_point)) border.emplace(soup, tolerance);  // what was moved may be near others now
  // As it is before the first split: what lies on a side has to stay there while the others get shorter.
  const std::vector<double> shortest = border->shortest();
  // A triangle can be met on each of its sides, and its parts again; sides only get shorter.
  for (uint64_t more = 1, round = 0; more > 0 && round < 32; ++round) {
    if (round > 0) border.emplace(soup, tolerance, shortest);
    met += more = border->split();
  }
  return met;
}

}  // namespace geocloth
