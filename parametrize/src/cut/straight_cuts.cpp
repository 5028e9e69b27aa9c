// SPDX-License-Identifier: GPL-3.0-or-later
//
// A path of cut edges is taken out and the shortest way between its ends is put in its place, found among the vertices
// and a few places on every edge (Lanthier, Maheshwari, Sack 1997, Steiner points; with Hart, Nilsson, Raphael's A*).
// Its crossings then slide along their edges until the way is straight in the unfolded faces. The faces beside a path
// form a disk, or an annulus that the path opens, as long as no other cut is crossed and both ends are reached from the
// same side as before: every simple way does there what the old one did.

#include "cut/straight_cuts.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>

#include "cut/cut_graph.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr uint32_t kPlaces = 3;        // places per edge that the search knows
constexpr double kSnap = 0.12;         // share of an edge; nearer to its end the path goes through the vertex
constexpr double kClear = 0.3;         // share of an edge that stays between the path and a vertex of another cut
constexpr double kWorthWhile = 0.995;  // of the old length
constexpr int kSlides = 60;
constexpr double kMostSlide = 0.3;  // of the length of the path whose end slides

/// A place on the path: a vertex, or a share of the edge from `vertex` to `other`.
struct Stop {
  uint32_t vertex, other = kNone;
  double share = 0;
  [[nodiscard]] bool on_edge() const { return other != kNone; }
};

class CutStraightener {
 public:
  CutStraightener(RefinedMesh& mesh, CutLines& lines) : mesh_(mesh), lines_(lines) {
    out_.assign(mesh.position.size(), kNone);
    degree_.assign(mesh.position.size(), 0);
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      out_[from(h)] = h;
      if (lines_.cut[h] && (opposite(h) == kNone || h < opposite(h))) {
        ++degree_[from(h)];
        ++degree_[to(h)];
      }
    }
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      // A border vertex starts at the border half-edge that leaves it, so that turning left visits its whole fan.
      if (opposite(h) == kNone)
        out_[from(h)] = h;
      else if (lines_.fixed[h])
        lines_.node[from(h)] = lines_.node[to(h)] = 1;
    }
  }

  void straighten_all() {
    for (const std::vector<uint32_t>& path : free_paths()) straighten(path);
  }

 private:
  // --- the mesh ----------------------------------------------------------------------------------------------------
  [[nodiscard]] uint32_t half_edge_count() const { return static_cast<uint32_t>(mesh_.triangle.size() * 3); }
  [[nodiscard]] uint32_t opposite(uint32_t h) const { return mesh_.opposite[h]; }
  [[nodiscard]] uint32_t from(uint32_t h) const { return tail(mesh_.triangle, h); }
  [[nodiscard]] uint32_t to(uint32_t h) const { return head(mesh_.triangle, h); }

  template <typename Visit>
  void around(uint32_t v, const Visit& visit) const {
    uint32_t h = out_[v];
    do {
      visit(h);
      h = opposite(previous_half_edge(h));
    } while (h != kNone && h != out_[v]);
  }

  /// The half-edge from a to b, or kNone; an edge of a border may exist only the other way round.
  [[nodiscard]] uint32_t half_edge_between(uint32_t a, uint32_t b) const {
    uint32_t found = kNone;
    around(a, [&](uint32_t h) {
      if (to(h) == b) found = h;
    });
    return found;
  }

  void set_cut(uint32_t h, bool value) {
    lines_.cut[h] = lines_.cut[opposite(h)] = value ? 1 : 0;
    const int change = value ? 1 : -1;
    degree_[from(h)] += change;
    degree_[to(h)] += change;
  }

  /// A new vertex on the edge from a to b. The flags of the two edges beyond move to new half-edges.
  uint32_t insert(const Stop& stop) {
    const uint32_t h = half_edge_between(stop.vertex, stop.other), o = opposite(h);
    const Point3 &a = mesh_.position[stop.vertex], &b = mesh_.position[stop.other];
    const uint32_t first_new = half_edge_count();
    const uint32_t m = mesh_.split_edge(h, a + (b - a) * stop.share, mesh_.point_count++);
    for (std::vector<char>* flag : {&lines_.cut, &lines_.fixed}) {
      flag->resize(half_edge_count(), 0);
      uint32_t fresh = first_new;
      for (const uint32_t side : {h, o}) {
        std::swap((*flag)[fresh + 1], (*flag)[next_half_edge(side)]);
        fresh += 3;
      }
    }
    lines_.node.push_back(0);
    if (!lines_.rings.empty()) lines_.rings.push_back(kNone);
    if (!allowed_.empty()) allowed_.push_back(0);
    degree_.push_back(0);
    out_.push_back(first_new);
    for (uint32_t fresh = first_new; fresh < half_edge_count(); fresh += 3) {
      // What left the far end along the edge that moved leaves it along the new half-edge.
      const uint32_t end = from(fresh + 1);
      if (from(out_[end]) != end) out_[end] = fresh + 1;
      if (opposite(fresh + 1) == kNone) out_[end] = fresh + 1;
    }
    return m;
  }

  // --- paths -------------------------------------------------------------------------------------------------------
  [[nodiscard]] bool passes_through(uint32_t v) const { return degree_[v] == 2 && lines_.node[v] == 0; }

  [[nodiscard]] uint32_t next_on_path(uint32_t before, uint32_t v) const {
    uint32_t found = kNone;
    around(v, [&](uint32_t h) {
      if (lines_.cut[h] && !lines_.fixed[h] && to(h) != before) found = to(h);
    });
    return found;
  }

  /// The paths between nodes as lists of vertices, longest first. Closed curves without a node stay as they are.
  [[nodiscard]] std::vector<std::vector<uint32_t>> free_paths() const {
    std::vector<std::pair<double, std::vector<uint32_t>>> found;
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      if (!lines_.cut[h] || lines_.fixed[h] || passes_through(from(h))) continue;
      std::vector<uint32_t> path{from(h), to(h)};
      while (passes_through(path.back())) {
        const uint32_t next = next_on_path(path[path.size() - 2], path.back());
        if (next == kNone) break;
        path.push_back(next);
      }
      // Every path is met from both ends; one that returns to its node has two vertices to be told apart by.
      if (path.back() < path.front()) continue;
      if (path.back() == path.front() && path[path.size() - 2] < path[1]) continue;
      found.emplace_back(-length_of(path), std::move(path));
    }
    std::sort(found.begin(), found.end());
    std::vector<std::vector<uint32_t>> paths;
    paths.reserve(found.size());
    for (auto& [length, path] : found) paths.push_back(std::move(path));
    return paths;
  }

  [[nodiscard]] double length_of(const std::vector<uint32_t>& path) const {
    double sum = 0;
    for (size_t i = 1; i < path.size(); ++i) sum += distance(mesh_.position[path[i - 1]], mesh_.position[path[i]]);
    return sum;
  }

  void straighten(const std::vector<uint32_t>& path) {
    std::vector<uint32_t> edge;
    edge.reserve(path.size());
    for (size_t i = 1; i < path.size(); ++i) edge.push_back(half_edge_between(path[i - 1], path[i]));
    for (const uint32_t h : edge) set_cut(h, false);
    const double old_length = length_of(path);
    stay_near(path);
    const std::vector<Stop> way = straightened(edge.front(), opposite(edge.back()), old_length);
    if (!is_sound(way) || length_of(way) > kWorthWhile * old_length) {
      for (const uint32_t h : edge) set_cut(h, true);
      return;
    }
    uint32_t before = way.front().vertex;
    for (size_t i = 1; i < way.size(); ++i) {
      const uint32_t v = way[i].on_edge() ? insert(way[i]) : way[i].vertex;
      set_cut(half_edge_between(before, v), true);
      before = v;
    }
  }

  /// Only vertices so near to the path as the lines ask for are passed from now on.
  void stay_near(const std::vector<uint32_t>& path) {
    allowed_.clear();
    uint32_t rings = kNone;
    for (size_t i = 1; i + 1 < path.size() && !lines_.rings.empty(); ++i)
      rings = std::min(rings, lines_.rings[path[i]]);
    if (rings == kNone) return;
    allowed_.assign(mesh_.position.size(), 0);
    std::vector<uint32_t> ring = path;
    for (const uint32_t v : ring) allowed_[v] = 1;
    for (uint32_t k = 0; k < rings; ++k) {
      std::vector<uint32_t> next;
      const auto take = [&](uint32_t v) {
        if (allowed_[v] == 0) next.push_back(v);
        allowed_[v] = 1;
      };
      for (const uint32_t v : ring) {
        around(v, [&](uint32_t h) {
          take(to(h));
          take(from(previous_half_edge(h)));
        });
      }
      ring = std::move(next);
    }
  }
  [[nodiscard]] bool is_allowed(uint32_t v) const { return allowed_.empty() || allowed_[v] != 0; }

  /// First the one end slides along the border that it abuts on, then the other.
  std::vector<Stop> straightened(uint32_t start, uint32_t end, double length) {
    const std::vector<Landing> ends = landings(end, kMostSlide * length), starts = landings(start, kMostSlide * length);
    // A loop that could leave and arrive on one side could shrink to nothing.
    for (const Landing& l : ends) {
      if (std::find(l.corner.begin(), l.corner.end(), start) != l.corner.end()) return {};
    }
    const std::vector<Stop> there = shortest_way(starts.front(), ends, length);
    if (there.empty()) return {};
    const auto landed =
        std::find_if(ends.begin(), ends.end(), [&](const Landing& l) { return l.vertex == there.back().vertex; });
    std::vector<Stop> back = shortest_way(*landed, starts, length);
    slide(back);
    return snapped(back);
  }

  // --- search ------------------------------------------------------------------------------------------------------
  /// The corners at the tail of h that can be reached from it without crossing a cut.
  [[nodiscard]] std::vector<uint32_t> sector(uint32_t start) const {
    std::vector<uint32_t> corners;
    for (uint32_t h = start;;) {
      corners.push_back(h);
      const uint32_t last = previous_half_edge(h);
      if (lines_.cut[last]) break;
      h = opposite(last);
      if (h == start) return corners;
    }
    for (uint32_t h = start; !lines_.cut[h];) {
      h = next_half_edge(opposite(h));
      corners.push_back(h);
    }
    return corners;
  }

  /// A vertex where a path may end, and its corners on the path's side.
  struct Landing {
    uint32_t vertex;
    std::vector<uint32_t> corner;
  };

  /// Where the path that leaves along `start` may begin instead: along the line that it abuts on, in both directions,
  /// up to the next node. The path's own place comes first.
  [[nodiscard]] std::vector<Landing> landings(uint32_t start, double reach) const {
    std::vector<Landing> result{{from(start), sector(start)}};
    if (!passes_through(from(start))) return result;
    const uint32_t own = from(start);
    for (const bool left : {true, false}) {
      const std::vector<uint32_t>* corners = &result.front().corner;
      double so_far = 0;
      for (;;) {
        const uint32_t line = line_beside(*corners, left);
        if (line == kNone || opposite(line) != kNone) break;
        so_far += distance(mesh_.position[from(line)], mesh_.position[to(line)]);
        // The corner at the line's other end on the same side.
        const uint32_t corner = left ? line : next_half_edge(line);
        if (so_far > reach || from(corner) == own || !passes_through(from(corner))) break;
        result.push_back({from(corner), sector(corner)});
        corners = &result.back().corner;
      }
    }
    return result;
  }

  /// The cut half-edge that bounds the corners of a sector to the left (it runs into the vertex) or to the right.
  [[nodiscard]] uint32_t line_beside(const std::vector<uint32_t>& corners, bool left) const {
    for (const uint32_t c : corners) {
      const uint32_t h = left ? previous_half_edge(c) : c;
      if (lines_.cut[h]) return h;
    }
    return kNone;
  }

  // Nodes of the search: vertices first, then kPlaces per half-edge, of which the lower of two opposite ones is used.
  [[nodiscard]] uint32_t place_node(uint32_t h, uint32_t place) const {
    const uint32_t o = opposite(h);
    const auto vertices = static_cast<uint32_t>(mesh_.position.size());
    return o < h ? vertices + o * kPlaces + (kPlaces - 1 - place) : vertices + h * kPlaces + place;
  }
  [[nodiscard]] Stop stop_of(uint32_t node) const {
    const auto vertices = static_cast<uint32_t>(mesh_.position.size());
    if (node < vertices) return {node};
    const uint32_t h = (node - vertices) / kPlaces, place = (node - vertices) % kPlaces;
    return {from(h), to(h), (place + 1.0) / (kPlaces + 1.0)};
  }
  [[nodiscard]] Point3 place_of(const Stop& s) const {
    const Point3& a = mesh_.position[s.vertex];
    return s.on_edge() ? a + (mesh_.position[s.other] - a) * s.share : a;
  }
  [[nodiscard]] bool passable(uint32_t v) const { return degree_[v] == 0 && lines_.node[v] == 0; }

  /// From one landing to the nearest of others, leaving and arriving through their corners.
  std::vector<Stop> shortest_way(const Landing& start, const std::vector<Landing>& ends, double limit) {
    const uint32_t source = start.vertex;
    std::vector<std::pair<uint32_t, uint32_t>> arrival;  // vertex, triangle
    for (const Landing& l : ends) {
      for (const uint32_t corner : l.corner) arrival.emplace_back(l.vertex, corner / 3);
    }
    std::sort(arrival.begin(), arrival.end());
    const auto is_target = [&](uint32_t v) {
      const auto at = std::lower_bound(arrival.begin(), arrival.end(), std::pair{v, 0U});
      return at != arrival.end() && at->first == v;
    };
    // No end is nearer than the ball around all of them.
    const Point3 goal = mesh_.position[ends.front().vertex];
    double around_goal = 0;
    for (const Landing& l : ends) around_goal = std::max(around_goal, distance(goal, mesh_.position[l.vertex]));
    const auto to_go = [&](const Point3& place) { return std::max(distance(place, goal) - around_goal, 0.0); };
    limit *= 1 + 1e-9;

    const size_t nodes = mesh_.position.size() + size_t{kPlaces} * half_edge_count();
    reached_.resize(nodes, kInfinity);
    parent_.resize(nodes, kNone);
    for (const uint32_t n : touched_) reached_[n] = kInfinity;
    touched_.clear();
    double at_target = kInfinity;
    uint32_t target = kNone, before_target = kNone;
    using Entry = std::pair<double, uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;

    const auto offer = [&](uint32_t node, const Point3& place, double so_far, uint32_t by) {
      if (!(so_far < reached_[node])) return;
      const double at_best = so_far + to_go(place);
      if (at_best > limit) return;
      if (reached_[node] == kInfinity) touched_.push_back(node);
      reached_[node] = so_far;
      parent_[node] = by;
      queue.emplace(at_best, node);
    };
    const auto offer_vertex = [&](uint32_t v, uint32_t triangle, const Point3& here, double so_far, uint32_t by) {
      if (!is_allowed(v)) return;
      const double through = so_far + distance(here, mesh_.position[v]);
      if (passable(v) && !is_target(v)) {
        offer(v, mesh_.position[v], through, by);
      } else if (through < at_target && through <= limit &&
                 std::binary_search(arrival.begin(), arrival.end(), std::pair{v, triangle})) {
        at_target = through;
        target = v;
        before_target = by;
      }
    };
    const auto offer_edge = [&](uint32_t h, const Point3& here, double so_far, uint32_t by) {
      if (lines_.cut[h] || !is_allowed(from(h)) || !is_allowed(to(h))) return;
      const Point3 &a = mesh_.position[from(h)], &b = mesh_.position[to(h)];
      for (uint32_t k = 0; k < kPlaces; ++k) {
        const Point3 place = a + (b - a) * ((k + 1.0) / (kPlaces + 1.0));
        offer(place_node(h, k), place, so_far + distance(here, place), by);
      }
    };
    const auto offer_from_corner = [&](uint32_t corner, double so_far, uint32_t by) {
      const Point3& here = mesh_.position[from(corner)];
      const uint32_t last = previous_half_edge(corner);
      offer_edge(next_half_edge(corner), here, so_far, by);
      if (!lines_.cut[corner]) offer_vertex(to(corner), corner / 3, here, so_far, by);
      if (!lines_.cut[last]) offer_vertex(from(last), corner / 3, here, so_far, by);
    };

    for (const uint32_t corner : start.corner) offer_from_corner(corner, 0, source);
    while (!queue.empty() && queue.top().first < at_target) {
      const auto [at_best, node] = queue.top();
      queue.pop();
      const Stop stop = stop_of(node);
      const Point3 here = place_of(stop);
      const double so_far = reached_[node];
      if (at_best > so_far + to_go(here)) continue;
      const uint32_t by = node;
      if (!stop.on_edge()) {
        around(stop.vertex, [&](uint32_t corner) { offer_from_corner(corner, so_far, by); });
        continue;
      }
      const uint32_t h = (node - static_cast<uint32_t>(mesh_.position.size())) / kPlaces;
      for (const uint32_t side : {h, opposite(h)}) {
        offer_edge(next_half_edge(side), here, so_far, by);
        offer_edge(previous_half_edge(side), here, so_far, by);
        offer_vertex(from(previous_half_edge(side)), side / 3, here, so_far, by);
      }
    }
    if (at_target == kInfinity) return {};
    std::vector<Stop> way{{target}};
    for (uint32_t n = before_target; n != source; n = parent_[n]) way.push_back(stop_of(n));
    way.push_back({source});
    std::reverse(way.begin(), way.end());
    return way;
  }

  // --- fine position -----------------------------------------------------------------------------------------------
  /// Every crossing to where the line between its neighbours, unfolded about the edge, meets the edge.
  void slide(std::vector<Stop>& way) const {
    for (int round = 0; round < kSlides; ++round) {
      for (size_t i = 1; i + 1 < way.size(); ++i) {
        Stop& s = way[i];
        if (!s.on_edge()) continue;
        const Point3 &a = mesh_.position[s.vertex], &b = mesh_.position[s.other];
        const double l = distance(a, b);
        const Point3 axis = (b - a) * (1 / l);
        const auto along_and_off = [&](const Stop& other) -> Point2 {
          const Point3 to_it = place_of(other) - a;
          const double along = dot(to_it, axis);
          return {along, length(to_it - axis * along)};
        };
        const auto [p, hp] = along_and_off(way[i - 1]);
        const auto [q, hq] = along_and_off(way[i + 1]);
        if (hp + hq > 0) s.share = std::clamp((p + (q - p) * hp / (hp + hq)) / l, 0.0, 1.0);
      }
    }
  }

  [[nodiscard]] std::vector<Stop> snapped(const std::vector<Stop>& way) const {
    std::vector<Stop> result;
    for (Stop s : way) {
      if (s.on_edge()) {
        const bool at_a = s.share < kSnap && passable(s.vertex), at_b = s.share > 1 - kSnap && passable(s.other);
        if (at_a || at_b) {
          s = {at_a ? s.vertex : s.other};
        } else {
          const double low = passable(s.vertex) ? kSnap : kClear, high = 1 - (passable(s.other) ? kSnap : kClear);
          s.share = std::clamp(s.share, low, high);
        }
      }
      if (!s.on_edge()) {
        // A vertex met again: what lay between is a detour.
        const auto again = std::find_if(result.begin(), result.end(),
                                        [&](const Stop& r) { return !r.on_edge() && r.vertex == s.vertex; });
        const bool closes = !result.empty() && result.front().vertex == s.vertex && way.back().vertex == s.vertex;
        if (again != result.end() && !closes) result.erase(again, result.end());
      }
      result.push_back(s);
    }
    return result;
  }

  [[nodiscard]] double length_of(const std::vector<Stop>& way) const {
    double sum = 0;
    for (size_t i = 1; i < way.size(); ++i) sum += distance(place_of(way[i - 1]), place_of(way[i]));
    return sum;
  }

  // --- what can be put in -------------------------------------------------------------------------------------------
  /// The triangle that the path crosses from the stop to an edge, or kNone where it runs along that edge.
  /// @returns nothing where no triangle has both
  [[nodiscard]] std::optional<uint32_t> crossed_triangle(const Stop& stop, const Stop& on_edge) const {
    if (!stop.on_edge() && (stop.vertex == on_edge.vertex || stop.vertex == on_edge.other)) return kNone;
    const uint32_t h = half_edge_between(on_edge.vertex, on_edge.other);
    for (const uint32_t side : {h, opposite(h)}) {
      const Triangle& t = mesh_.triangle[side / 3];
      const auto has = [&](uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; };
      if (has(stop.vertex) && (!stop.on_edge() || has(stop.other))) return side / 3;
    }
    return std::nullopt;
  }

  /// Can the way be put in stop by stop? Stops that follow each other lie in one triangle or are joined by an edge, no
  /// edge is crossed twice, no vertex met twice, no triangle crossed twice or split beside where it is crossed.
  [[nodiscard]] bool can_be_put_in(const std::vector<Stop>& way) const {
    std::vector<uint32_t> vertices;
    std::vector<std::pair<uint32_t, uint32_t>> crossed;                 // edges
    std::vector<std::pair<uint32_t, size_t>> crossed_triangles, split;  // with the stop
    for (size_t i = 0; i < way.size(); ++i) {
      const Stop& s = way[i];
      if (s.on_edge()) {
        crossed.push_back(std::minmax(s.vertex, s.other));
        const uint32_t h = half_edge_between(s.vertex, s.other);
        split.emplace_back(h / 3, i);
        split.emplace_back(opposite(h) / 3, i);
      } else if (i == 0 || i + 1 < way.size() || s.vertex != way.front().vertex) {
        vertices.push_back(s.vertex);
      }
      if (i == 0 || (!s.on_edge() && !way[i - 1].on_edge())) continue;
      const std::optional<uint32_t> triangle =
          s.on_edge() ? crossed_triangle(way[i - 1], s) : crossed_triangle(s, way[i - 1]);
      if (!triangle) return false;
      if (*triangle != kNone) crossed_triangles.emplace_back(*triangle, i);
    }
    for (size_t i = 1; i < way.size(); ++i) {
      if (way[i].on_edge() || way[i - 1].on_edge()) continue;
      const std::pair<uint32_t, uint32_t> edge = std::minmax(way[i - 1].vertex, way[i].vertex);
      const uint32_t h = half_edge_between(way[i - 1].vertex, way[i].vertex);
      if (h == kNone || lines_.cut[h] || std::find(crossed.begin(), crossed.end(), edge) != crossed.end()) return false;
    }
    std::sort(split.begin(), split.end());
    std::sort(crossed_triangles.begin(), crossed_triangles.end());
    for (size_t k = 0; k < split.size(); ++k) {
      const auto [triangle, stop] = split[k];
      const auto at =
          std::lower_bound(crossed_triangles.begin(), crossed_triangles.end(), std::pair{triangle, size_t{0}});
      const bool is_crossed = at != crossed_triangles.end() && at->first == triangle;
      if (is_crossed && stop != at->second && stop + 1 != at->second) return false;
      if (!is_crossed && k + 1 < split.size() && split[k + 1].first == triangle) return false;
    }
    return !has_twice(std::move(vertices)) && !has_twice(std::move(crossed)) &&
           std::adjacent_find(crossed_triangles.begin(), crossed_triangles.end(), [](const auto& a, const auto& b) {
             return a.first == b.first;
           }) == crossed_triangles.end();
  }

  template <typename Value>
  static bool has_twice(std::vector<Value> values) {
    std::sort(values.begin(), values.end());
    return std::adjacent_find(values.begin(), values.end()) != values.end();
  }

  /// A cut that abuts on nothing has an inside: a single edge between two free ends would open nothing.
  [[nodiscard]] bool is_sound(const std::vector<Stop>& way) const {
    if (way.size() < 2) return false;
    if (way.size() == 2 && degree_[way[0].vertex] == 0 && degree_[way[1].vertex] == 0) return false;
    return can_be_put_in(way);
  }

  RefinedMesh& mesh_;
  CutLines& lines_;
  std::vector<uint32_t> out_;    // per vertex: a half-edge that leaves it
  std::vector<int32_t> degree_;  // per vertex: cut edges around it
  std::vector<char> allowed_;    // per vertex: the present path may pass here; empty: everywhere
  std::vector<double> reached_;  // per node of the search
  std::vector<uint32_t> parent_, touched_;
};

}  // namespace

void straighten_cuts(RefinedMesh& mesh, CutLines& lines) {
  CutStraightener(mesh, lines).straighten_all();
}

CutSurface open_along(const RefinedMesh& mesh, const std::vector<char>& cut) {
  OpenedVertices opened = open_along(mesh.triangle, mesh.opposite, cut);
  CutSurface result;
  result.triangle = std::move(opened.triangle);
  result.clean_triangle = mesh.clean_triangle;
  result.point_count = mesh.point_count;
  result.position.reserve(opened.original.size());
  result.point.reserve(opened.original.size());
  result.clean_vertex.reserve(opened.original.size());
  for (const uint32_t v : opened.original) {
    result.position.push_back(mesh.position[v]);
    result.point.push_back(mesh.point[v]);
    result.clean_vertex.push_back(mesh.clean_vertex[v]);
  }
  Components components = connected_components(opposite_half_edges(result.triangle));
  result.component = std::move(components.of_triangle);
  result.component_count = components.count;
  return result;
}

}  // namespace geocloth
