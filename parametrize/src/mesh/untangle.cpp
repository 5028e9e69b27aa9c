// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/untangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <CGAL/Box_intersection_d/Box_with_info_d.h>
#include <CGAL/box_intersection_d.h>

#include "geocloth/asset/error.h"
#include "mesh/point_math.h"
#include "mesh/users.h"

namespace geocloth {
namespace {

constexpr int kRounds = 400, kMostInVain = 100;
constexpr double kStep = 0.2;         // of the edges there, that a crossing moves at most in a round
constexpr double kClearSlope = 0.2;   // length of a gradient that says clearly where to
constexpr double kSteepest = 0.05;    // sine between an edge and a plane: below, the gradient is as there
constexpr double kStiffness = 0.3;    // of edges, towards their lengths
constexpr double kToNeighbors = 0.4;  // of a move, that neighbours share
constexpr int kSharings = 3;
constexpr double kReach = 1;  // of a triangle's edges, around it, within which others are listed
constexpr std::size_t kMostNear = std::size_t{1} << 25U;  // pairs in that list: 256 MB

using PointPair = std::array<uint32_t, 2>;

/// An edge goes through a triangle.
struct Crossing {
  uint32_t edge, triangle;
  double along;   ///< the edge, 0..1
  Point3 weight;  ///< in the triangle
};

class Untangler {
 public:
  Untangler(const std::vector<Triangle>& triangle, std::vector<Point3>& place)
      : place_(place), start_(place), is_moved_(place.size(), 0) {
    const auto has_three_corners = [](const Triangle& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; };
    std::copy_if(triangle.begin(), triangle.end(), std::back_inserter(triangle_), has_three_corners);
    find_edges();
  }

  Untangled run() {
    Untangled result;
    if (edge_.empty()) return result;
    find_near();
    uint32_t pairs = find_crossings();
    result.before = result.after = pairs;
    std::vector<Point3> best = place_;
    int in_vain = 0;
    for (int round = 0; round < kRounds && pairs > 0 && in_vain < kMostInVain; ++round) {
      move();
      if (has_left_list()) find_near();
      pairs = find_crossings();
      ++in_vain;
      if (pairs >= result.after) continue;
      result.after = pairs;
      best = place_;
      in_vain = 0;
    }
    place_ = std::move(best);
    for (std::size_t p = 0; p < place_.size(); ++p)
      result.farthest = std::max(result.farthest, distance(place_[p], start_[p]));
    return result;
  }

 private:
  void find_edges() {
    std::vector<PointPair> sides;
    sides.reserve(3 * triangle_.size());
    for (const Triangle& t : triangle_)
      for (std::size_t k = 0; k < 3; ++k) sides.push_back(side(t, k));
    edge_ = sides;
    std::sort(edge_.begin(), edge_.end());
    edge_.erase(std::unique(edge_.begin(), edge_.end()), edge_.end());
    edge_of_.resize(triangle_.size());
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const auto found = std::lower_bound(edge_.begin(), edge_.end(), sides[i]);
      edge_of_[i / 3][i % 3] = static_cast<uint32_t>(found - edge_.begin());
    }
    double sum = 0;
    for (const auto& [a, b] : edge_) {
      length_.push_back(distance(place_[a], place_[b]));
      sum += length_.back();
    }
    const double mean = edge_.empty() ? 0 : sum / static_cast<double>(edge_.size());
    reach_.resize(triangle_.size());
    reach_at_.assign(place_.size(), mean);
    for (uint32_t t = 0; t < triangle_.size(); ++t) {
      reach_[t] = kReach * std::min(mean, size_of(t));
      for (const uint32_t p : triangle_[t]) reach_at_[p] = std::min(reach_at_[p], reach_[t]);
    }
    triangles_at_.emplace(edge_.size(), edge_of_);
    edges_at_.emplace(place_.size(), edge_);
  }

  static PointPair side(const Triangle& t, std::size_t k) {
    const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
    return {a, b};
  }

  /// [m] Mean length of its edges.
  [[nodiscard]] double size_of(uint32_t t) const {
    double sum = 0;
    for (const uint32_t e : edge_of_[t]) sum += length_[e];
    return sum / 3;
  }

  [[nodiscard]] CGAL::Bbox_3 box_of(uint32_t t, double beyond) const {
    const Point3 &a = place_[triangle_[t][0]], &b = place_[triangle_[t][1]], &c = place_[triangle_[t][2]];
    const auto least = [&](std::size_t x) { return std::min({a[x], b[x], c[x]}) - beyond; };
    const auto most = [&](std::size_t x) { return std::max({a[x], b[x], c[x]}) + beyond; };
    return {least(0), least(1), least(2), most(0), most(1), most(2)};
  }

  [[nodiscard]] bool share_a_point(uint32_t s, uint32_t t) const {
    return std::any_of(triangle_[s].begin(), triangle_[s].end(), [&](uint32_t p) {
      return std::find(triangle_[t].begin(), triangle_[t].end(), p) != triangle_[t].end();
    });
  }

  /// Pairs of triangles that may meet before one of their points has left its triangles' reach.
  void find_near() {
    using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, uint32_t>;
    std::vector<Box> boxes;
    boxes.reserve(triangle_.size());
    for (uint32_t t = 0; t < triangle_.size(); ++t) boxes.emplace_back(box_of(t, reach_[t]), t);
    near_.clear();
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
      if (share_a_point(a.info(), b.info())) return;
      if (near_.size() == kMostNear) {
        throw Error(ErrorCode::limit, "too many triangles lie at the same places to draw layers apart (more than " +
                                          std::to_string(kMostNear) + " pairs); leave --untangle out, or parts of " +
                                          "the mesh with --parts");
      }
      near_.push_back({a.info(), b.info()});
    });
    listed_at_ = place_;
  }

  [[nodiscard]] bool has_left_list() const {
    for (std::size_t p = 0; p < place_.size(); ++p)
      if (distance(place_[p], listed_at_[p]) > reach_at_[p]) return true;
    return false;
  }

  /// @returns how many pairs of triangles cut through each other
  uint32_t find_crossings() {
    crossing_.clear();
    box_.clear();
    for (uint32_t t = 0; t < triangle_.size(); ++t) box_.push_back(box_of(t, 0));
    uint32_t pairs = 0;
    for (const auto& [s, t] : near_) {
      if (!CGAL::do_overlap(box_[s], box_[t])) continue;
      const bool s_through_t = add_crossings(s, t), t_through_s = add_crossings(t, s);
      if (s_through_t || t_through_s) ++pairs;
    }
    // An edge was met once for each triangle beside it, and pairs come in any order.
    const auto key = [](const Crossing& c) { return std::pair(c.edge, c.triangle); };
    std::sort(crossing_.begin(), crossing_.end(),
              [&](const Crossing& a, const Crossing& b) { return key(a) < key(b); });
    crossing_.erase(std::unique(crossing_.begin(), crossing_.end(),
                                [&](const Crossing& a, const Crossing& b) { return key(a) == key(b); }),
                    crossing_.end());
    return pairs;
  }

  /// Of the edges of one triangle through another one.
  bool add_crossings(uint32_t of, uint32_t through) {
    const Triangle& t = triangle_[through];
    const Point3 &p = place_[t[0]], &q = place_[t[1]], &r = place_[t[2]];
    const Point3 normal = cross(q - p, r - p);
    const double squared = dot(normal, normal);
    if (!(squared > 0)) return false;
    bool found = false;
    for (const uint32_t e : edge_of_[of]) {
      const Point3 &a = place_[edge_[e][0]], &b = place_[edge_[e][1]];
      const double over_a = dot(normal, a - p), over_b = dot(normal, b - p);
      if ((over_a > 0) == (over_b > 0) || over_a == over_b) continue;
      const double along = over_a / (over_a - over_b);
      const Point3 x = a + (b - a) * along;
      const double u = dot(normal, cross(r - q, x - q)) / squared, v = dot(normal, cross(p - r, x - r)) / squared;
      const Point3 weight{u, v, 1 - u - v};
      if (!(*std::min_element(weight.begin(), weight.end()) >= 0)) continue;
      crossing_.push_back({e, through, along, weight});
      found = true;
    }
    return found;
  }

  /// The way of the edge, against the triangle, on which the lines that begin at the crossing become shorter: on each
  /// side of the edge one runs on along the triangle there.
  [[nodiscard]] Point3 gradient(const Crossing& c) const {
    const auto& [a, b] = edge_[c.edge];
    const std::optional<Point3> along = direction_of(place_[b] - place_[a]), normal = normal_of(c.triangle);
    if (!along || !normal) return {};
    double steep = dot(*along, *normal);
    if (std::abs(steep) < kSteepest) steep = std::copysign(kSteepest, steep);
    Point3 sum{};
    for (const uint32_t beside : (*triangles_at_)[c.edge]) {
      const std::optional<Point3> beside_normal = normal_of(beside);
      if (!beside_normal) continue;
      const std::optional<Point3> line = direction_of(cross(*normal, *beside_normal));
      if (!line) continue;
      const Triangle& t = triangle_[beside];
      const Point3 inwards = place_[t[0] + t[1] + t[2] - a - b] - place_[a];
      const double side = dot(*line, inwards - *along * dot(inwards, *along));
      const Point3 way = *line * (side < 0 ? -1.0 : 1.0);
      sum = sum + way - *normal * (dot(*along, way) / steep);
    }
    return sum;
  }

  [[nodiscard]] std::optional<Point3> normal_of(uint32_t t) const {
    const Point3 &a = place_[triangle_[t][0]], &b = place_[triangle_[t][1]], &c = place_[triangle_[t][2]];
    return direction_of(cross(b - a, c - a));
  }

  /// [m] How large triangles are at a crossing.
  [[nodiscard]] double size_at(const Crossing& c) const { return std::min(length_[c.edge], size_of(c.triangle)); }

  void move() {
    std::vector<Point3> shift(place_.size(), Point3{});
    std::vector<double> weight(place_.size(), 0);
    for (const Crossing& c : crossing_) {
      const Point3 way = gradient(c);
      const Point3 whole = way * (kStep * size_at(c) / std::sqrt(dot(way, way) + kClearSlope * kClearSlope));
      const auto pull = [&](uint32_t p, double w, double share) {
        shift[p] = shift[p] + whole * (share * w);
        weight[p] += w;
      };
      pull(edge_[c.edge][0], 1 - c.along, 0.5);
      pull(edge_[c.edge][1], c.along, 0.5);
      for (std::size_t k = 0; k < 3; ++k) pull(triangle_[c.triangle][k], c.weight[k], -0.5);
    }
    constexpr double kLeastWeight = 0.3;  // of a point that is hardly meant
    for (std::size_t p = 0; p < place_.size(); ++p)
      if (weight[p] > 0) shift[p] = shift[p] * (1 / std::max(weight[p], kLeastWeight));
    for (int i = 0; i < kSharings; ++i) share(shift);
    for (std::size_t p = 0; p < place_.size(); ++p) {
      if (shift[p] == Point3{}) continue;
      place_[p] = place_[p] + shift[p];
      is_moved_[p] = 1;
    }
    keep_lengths();
  }

  /// Points follow their neighbours a little: a dent is wider than a point.
  void share(std::vector<Point3>& shift) const {
    const std::vector<Point3> own = shift;
    for (uint32_t p = 0; p < place_.size(); ++p) {
      const std::span<const uint32_t> edges = (*edges_at_)[p];
      if (edges.empty()) continue;
      Point3 sum{};
      for (const uint32_t e : edges) sum = sum + own[edge_[e][0] == p ? edge_[e][1] : edge_[e][0]];
      shift[p] = own[p] * (1 - kToNeighbors) + sum * (kToNeighbors / static_cast<double>(edges.size()));
    }
  }

  /// As distance constraints (Mueller et al. 2007, Position based dynamics), of points that crossings have moved. What
  /// lies around them is held.
  void keep_lengths() {
    for (std::size_t e = 0; e < edge_.size(); ++e) {
      const auto& [a, b] = edge_[e];
      if (is_moved_[a] == 0 && is_moved_[b] == 0) continue;
      const double l = distance(place_[a], place_[b]);
      if (!(l > 0)) continue;
      const double share = is_moved_[a] != 0 && is_moved_[b] != 0 ? 0.5 : 1;
      const Point3 way = (place_[b] - place_[a]) * (share * kStiffness * (l - length_[e]) / l);
      if (is_moved_[a] != 0) place_[a] = place_[a] + way;
      if (is_moved_[b] != 0) place_[b] = place_[b] - way;
    }
  }

  std::vector<Triangle> triangle_;  // with three corners
  std::vector<Point3>& place_;
  std::vector<Point3> start_;
  std::vector<uint8_t> is_moved_;                 // per point: by a crossing, ever
  std::vector<PointPair> edge_;                   // of points, ascending
  std::vector<std::array<uint32_t, 3>> edge_of_;  // per triangle
  std::optional<Users> triangles_at_, edges_at_;  // of edges, of points
  std::vector<double> length_;                    // [m] per edge, at the start
  std::vector<double> reach_, reach_at_;          // [m] per triangle, and the least of those of a point
  std::vector<PointPair> near_;                   // of triangles
  std::vector<Point3> listed_at_;                 // where points were when near_ was made
  std::vector<CGAL::Bbox_3> box_;                 // per triangle, as it is
  std::vector<Crossing> crossing_;
};

}  // namespace

Untangled untangle(const std::vector<Triangle>& triangle, std::vector<Point3>& place) {
  return Untangler(triangle, place).run();
}

}  // namespace geocloth
