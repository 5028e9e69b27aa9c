// SPDX-License-Identifier: GPL-3.0-or-later
// Gu, Gortler, Hoppe, Geometry Images, SIGGRAPH 2002, section 3. A disk of triangles grows from a seed in order of
// geodesic distance; the edges that it never crosses are a cut graph (tree-cotree: Eppstein 2003). Dead ends are
// pruned, then every path between two nodes is taken out, which leaves an annulus, and the shortest path between the
// annulus' two outlines is put in its place; its ends may slide along the outlines. What repair tied (borders, edges of
// more than two triangles, bow ties) is part of the graph from the start and never moves.
#include "cut/cut_graph.h"

#include <algorithm>
#include <numeric>
#include <queue>
#include <string>

#include "cut/edge_wishes.h"
#include "geocloth/asset/error.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr int kStraightenPasses = 2;

class CutGraphFinder {
 public:
  CutGraphFinder(const CleanSurface& surface, const CutOptions& options, const Progress& progress)
      : surface_(surface), progress_(progress), triangle_(surface.triangle) {
    graph_.opposite = opposite_half_edges(triangle_);
    first_half_edge_.assign(surface.position.size(), kNone);
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      // A border vertex starts at the border half-edge that leaves it, so that one turn visits its whole fan.
      uint32_t& first = first_half_edge_[tail(triangle_, h)];
      if (first == kNone || opposite(h) == kNone) first = h;
    }
    fixed_.assign(half_edge_count(), 0);
    required_.assign(surface.position.size(), 0);
    degree_.assign(surface.position.size(), 0);
    distance_.assign(surface.position.size(), kInfinity);
    parent_.assign(surface.position.size(), kNone);
    mark_tied_edges();
    mark_extra_edges(options);
    mark_tied_vertices();
    set_prices(options.prefer);
  }

  CutGraph find() {
    grow_disks();
    prune();
    open_spheres();
    watch_cuts();
    for (int pass = 0; pass < kStraightenPasses; ++pass) straighten(pass);
    graph_.fixed = std::move(fixed_);
    graph_.node = std::move(required_);
    return std::move(graph_);
  }

 private:
  // --- half-edges around a vertex -------------------------------------------------------------------------------
  [[nodiscard]] uint32_t half_edge_count() const { return static_cast<uint32_t>(triangle_.size() * 3); }
  [[nodiscard]] uint32_t opposite(uint32_t h) const { return graph_.opposite[h]; }
  [[nodiscard]] uint32_t from(uint32_t h) const { return tail(triangle_, h); }
  [[nodiscard]] uint32_t to(uint32_t h) const { return head(triangle_, h); }
  [[nodiscard]] double edge_length(uint32_t h) const {
    return distance(surface_.position[from(h)], surface_.position[to(h)]);
  }
  /// The next half-edge that leaves the same vertex, counter-clockwise; kNone across a border.
  [[nodiscard]] uint32_t turn_left(uint32_t h) const { return opposite(previous_half_edge(h)); }
  /// Same, clockwise.
  [[nodiscard]] uint32_t turn_right(uint32_t h) const {
    return opposite(h) == kNone ? kNone : next_half_edge(opposite(h));
  }

  /// Calls visit(h) for every half-edge h that leaves v, and visit_last(g) for the border half-edge g that ends in v.
  template <typename Visit, typename VisitLast>
  void around(uint32_t v, const Visit& visit, const VisitLast& visit_last) const {
    const uint32_t first = first_half_edge_[v];
    if (first == kNone) return;
    uint32_t h = first;
    do {
      visit(h);
      if (turn_left(h) == kNone) {
        visit_last(previous_half_edge(h));
        return;
      }
      h = turn_left(h);
    } while (h != first);
  }

  void set_cut(uint32_t h, bool value) {
    const char flag = value ? 1 : 0;
    if (graph_.cut[h] == flag) return;
    graph_.cut[h] = flag;
    if (opposite(h) != kNone) graph_.cut[opposite(h)] = flag;
    const uint32_t a = from(h), b = to(h);
    degree_[a] = value ? degree_[a] + 1 : degree_[a] - 1;
    degree_[b] = value ? degree_[b] + 1 : degree_[b] - 1;
    if (!near_cut_.empty()) watch(h, value ? 1 : -1);
  }

  void fix(uint32_t h) {
    fixed_[h] = 1;
    if (opposite(h) != kNone) fixed_[opposite(h)] = 1;
  }

  // --- what must be on the graph ---------------------------------------------------------------------------------
  void mark_tied_edges() {
    std::vector<std::pair<uint64_t, uint32_t>> edge;  // point pair, half-edge; one entry per edge
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      if (opposite(h) == kNone) fix(h);
      if (opposite(h) != kNone && opposite(h) < h) continue;
      const auto [low, high] = std::minmax({surface_.point[from(h)], surface_.point[to(h)]});
      edge.emplace_back((uint64_t{low} << 32U) | high, h);
    }
    std::sort(edge.begin(), edge.end());
    for (size_t i = 0; i + 1 < edge.size(); ++i) {
      if (edge[i].first != edge[i + 1].first) continue;
      fix(edge[i].second);
      fix(edge[i + 1].second);
    }
  }

  void mark_extra_edges(const CutOptions& options) {
    for (const auto& edge : options.extra_edges) {
      const uint32_t a = edge[0], b = edge[1];
      uint32_t found = kNone;
      if (a < first_half_edge_.size() && b < first_half_edge_.size()) {
        around(
            a, [&](uint32_t h) { found = to(h) == b ? h : found; },
            [&](uint32_t h) { found = from(h) == b ? h : found; });
      }
      if (found == kNone) {
        throw Error(ErrorCode::invalid_argument,
                    "extra cut edge " + std::to_string(a) + "-" + std::to_string(b) + " is no edge of the surface");
      }
      fix(found);
    }
  }

  void mark_tied_vertices() {
    std::vector<uint32_t> copies(surface_.point_count, 0);
    for (uint32_t v = 0; v < surface_.point.size(); ++v) {
      if (first_half_edge_[v] != kNone) ++copies[surface_.point[v]];
    }
    for (uint32_t v = 0; v < surface_.point.size(); ++v) required_[v] = copies[surface_.point[v]] > 1 ? 1 : 0;
  }

  // --- where cuts are wanted -------------------------------------------------------------------------------------
  void set_prices(const CutPreferences& prefer) {
    std::vector<uint32_t> vertex(surface_.position.size());
    std::iota(vertex.begin(), vertex.end(), 0U);
    const std::vector<double> wished = wished_discounts(surface_.position, triangle_, vertex, prefer);
    price_.resize(half_edge_count());
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      double discount = wished[h];
      if (prefer.creases && opposite(h) != kNone) {
        const double crease = sharp_crease_between(surface_.position, triangle_[h / 3], triangle_[opposite(h) / 3]);
        discount = std::max(discount, kCreaseDiscount * crease);
      }
      price_[h] = edge_length(h) * (1 - discount);
    }
    if (prefer.mirror) mirror_vertex_ = mirror_vertices(surface_.position, triangle_, *prefer.mirror);
  }

  /// Length of an edge, less what speaks for a cut there: a crease, a seam of the garment, the mirror plane, or that
  /// there is one on the other side of that.
  [[nodiscard]] double price(uint32_t h) const {
    if (!is_mirror_of_cut(from(h)) || !is_mirror_of_cut(to(h))) return price_[h];
    return std::min(price_[h], (1 - kMirrorDiscount) * edge_length(h));
  }

  [[nodiscard]] bool is_mirror_of_cut(uint32_t v) const {
    return !mirror_vertex_.empty() && mirror_vertex_[v] != kNone && near_cut_[mirror_vertex_[v]] > 0;
  }

  /// From now on near_cut_ counts, per vertex, the cut edges inside the surface on it or one edge away.
  void watch_cuts() {
    if (mirror_vertex_.empty()) return;
    near_cut_.assign(surface_.position.size(), 0);
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      if (graph_.cut[h] && opposite(h) != kNone && h < opposite(h)) watch(h, 1);
    }
  }

  void watch(uint32_t h, int32_t change) {
    for (const uint32_t v : {from(h), to(h)}) {
      near_cut_[v] += change;
      around(
          v, [&](uint32_t out) { near_cut_[to(out)] += change; }, [&](uint32_t in) { near_cut_[from(in)] += change; });
    }
  }

  // --- the first graph -------------------------------------------------------------------------------------------
  void grow_disks() {
    graph_.cut.assign(half_edge_count(), 0);
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      if (opposite(h) == kNone || h < opposite(h)) set_cut(h, true);
    }
    std::vector<Point3> centroid(triangle_.size());
    for (size_t t = 0; t < triangle_.size(); ++t) {
      const auto& [a, b, c] = triangle_[t];
      centroid[t] = (surface_.position[a] + surface_.position[b] + surface_.position[c]) * (1.0 / 3.0);
    }
    region_.assign(triangle_.size(), kNone);
    using Candidate = std::pair<double, uint32_t>;  // distance of the triangle behind, half-edge to be crossed
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
    for (uint32_t seed = 0; seed < triangle_.size(); ++seed) {
      if (region_[seed] != kNone) continue;
      const auto region = static_cast<uint32_t>(region_seed_.size());
      region_seed_.push_back(seed);
      const auto add = [&](uint32_t t, double so_far) {
        region_[t] = region;
        for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          if (fixed_[h] || region_[opposite(h) / 3] != kNone) continue;
          queue.emplace(so_far + distance(centroid[t], centroid[opposite(h) / 3]), h);
        }
      };
      add(seed, 0);
      while (!queue.empty()) {
        const double so_far = queue.top().first;
        const uint32_t h = queue.top().second;
        queue.pop();
        if (region_[opposite(h) / 3] != kNone) continue;
        set_cut(h, false);
        add(opposite(h) / 3, so_far);
      }
    }
  }

  [[nodiscard]] uint32_t single_free_cut_edge(uint32_t v) const {
    uint32_t found = kNone;
    const auto take = [&](uint32_t h) { found = graph_.cut[h] && !fixed_[h] ? h : found; };
    around(v, take, take);
    return found;
  }

  void prune() {
    std::vector<uint32_t> stack;
    for (uint32_t v = 0; v < degree_.size(); ++v) {
      if (degree_[v] == 1 && !required_[v]) stack.push_back(v);
    }
    while (!stack.empty()) {
      const uint32_t v = stack.back();
      stack.pop_back();
      if (degree_[v] != 1) continue;
      const uint32_t h = single_free_cut_edge(v);
      if (h == kNone) continue;
      const uint32_t other = from(h) == v ? to(h) : from(h);
      set_cut(h, false);
      if (degree_[other] == 1 && !required_[other]) stack.push_back(other);
    }
  }

  // --- regions without an outline ----------------------------------------------------------------------------------
  /// Distances along edges from `start` through vertices that are not on the graph; returns the farthest vertex.
  uint32_t flood(uint32_t start, uint32_t blocked) {
    forget_distances();
    std::priority_queue<std::pair<double, uint32_t>, std::vector<std::pair<double, uint32_t>>, std::greater<>> queue;
    reach(start, 0, kNone);
    queue.emplace(0.0, start);
    uint32_t farthest = start;
    while (!queue.empty()) {
      const double so_far = queue.top().first;
      const uint32_t v = queue.top().second;
      queue.pop();
      if (so_far > distance_[v]) continue;
      if (so_far > distance_[farthest]) farthest = v;
      around(
          v,
          [&](uint32_t h) {
            const uint32_t w = to(h);
            const double through = so_far + edge_length(h);
            if (w == blocked || !(through < distance_[w])) return;
            reach(w, through, h);
            queue.emplace(through, w);
          },
          [](uint32_t) {});
    }
    return farthest;
  }

  void reach(uint32_t v, double so_far, uint32_t by) {
    if (distance_[v] == kInfinity) touched_.push_back(v);
    distance_[v] = so_far;
    parent_[v] = by;
  }

  void forget_distances() {
    for (const uint32_t v : touched_) {
      distance_[v] = kInfinity;
      parent_[v] = kNone;
    }
    touched_.clear();
  }

  /// Cuts the way from v back to where the flood started; both stay cut ends.
  void cut_back_from(uint32_t v) {
    required_[v] = 1;
    for (; parent_[v] != kNone; v = from(parent_[v])) set_cut(parent_[v], true);
    required_[v] = 1;
  }

  /// A closed sphere, whole or joined to others at one point, has no outline yet: cut along a path between two far
  /// vertices. An outline of a single edge is no polygon: it gets longer.
  void open_spheres() {
    struct Region {
      uint32_t edges = 0, edge = kNone, tied_vertex = kNone;
    };
    std::vector<Region> region(region_seed_.size());
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      Region& r = region[region_[h / 3]];
      if (required_[from(h)]) r.tied_vertex = from(h);
      if (!graph_.cut[h]) continue;
      ++r.edges;
      r.edge = h;
    }
    for (uint32_t i = 0; i < region.size(); ++i) {
      Region& r = region[i];
      if (r.edges == 0) {
        const uint32_t any = from(3 * region_seed_[i]);
        const uint32_t start = r.tied_vertex != kNone ? r.tied_vertex : flood(any, kNone);
        const uint32_t end = flood(start, kNone);
        cut_back_from(end);
        if (parent_[end] != kNone && from(parent_[end]) == start) {
          r.edge = parent_[end];
          r.edges = 2;
        }
      }
      if (r.edges == 2 && opposite(r.edge) != kNone && region_[opposite(r.edge) / 3] == i) {
        cut_back_from(flood(to(r.edge), from(r.edge)));
      }
    }
  }

  // --- straightening -----------------------------------------------------------------------------------------------
  [[nodiscard]] bool passes_through(uint32_t v) const { return degree_[v] == 2 && !required_[v]; }

  /// The other free cut edge at a vertex of degree 2, as a half-edge or border half-edge in either direction.
  [[nodiscard]] uint32_t other_cut_edge(uint32_t v, uint32_t edge) const {
    uint32_t found = kNone;
    around(
        v,
        [&](uint32_t h) {
          if (graph_.cut[h] && h != edge && opposite(h) != edge) found = h;
        },
        [](uint32_t) {});
    return found;
  }

  /// The maximal free path through h, as half-edges in order from one end to the other.
  [[nodiscard]] std::vector<uint32_t> path_through(uint32_t h) const {
    std::vector<uint32_t> forward{h};
    const auto extend = [&](std::vector<uint32_t>& path) {
      while (passes_through(to(path.back()))) {
        const uint32_t next = other_cut_edge(to(path.back()), path.back());
        if (next == kNone || fixed_[next] || next == path.front()) return;
        path.push_back(next);
      }
    };
    std::vector<uint32_t> backward{opposite(h)};
    extend(backward);
    extend(forward);
    std::vector<uint32_t> path;
    for (size_t i = backward.size(); i-- > 1;) path.push_back(opposite(backward[i]));
    path.insert(path.end(), forward.begin(), forward.end());
    return path;
  }

  /// Walks along the outline that bounds the sector into which a half-edge leads, which leaves a vertex and is no
  /// longer cut. Where the vertex has no cut edge left, the outline is that vertex.
  class OutlineWalk {
   public:
    OutlineWalk(const CutGraphFinder& finder, uint32_t start) : finder_(finder) {
      uint32_t h = start;
      do {
        if (finder.graph_.cut[h]) break;
        h = finder.turn_right(h);
      } while (h != start);
      first_ = at_ = h;
      if (finder.graph_.cut[h]) return;
      finder.around(
          finder.from(start), [&](uint32_t corner) { corners_.push_back(corner); }, [](uint32_t) {});
      is_done_ = true;
    }

    /// Goes on by the corners at a vertex.
    void step() {
      uint32_t corner = at_;
      corners_.push_back(corner);
      while (!finder_.graph_.cut[previous_half_edge(corner)]) {
        corner = finder_.turn_left(corner);
        corners_.push_back(corner);
      }
      // previous_half_edge(corner) runs into the vertex along the outline; go on with the outline half-edge before it.
      at_ = previous_half_edge(corner);
      is_done_ = at_ == first_;
    }

    [[nodiscard]] bool is_done() const { return is_done_; }
    [[nodiscard]] std::vector<uint32_t>& corners() { return corners_; }

   private:
    const CutGraphFinder& finder_;
    std::vector<uint32_t> corners_;
    uint32_t first_ = kNone, at_ = kNone;
    bool is_done_ = false;
  };

  /// Marks the corners along one of the two outlines beside a path that was taken out: the one at its start, unless
  /// that is long and the other one shorter. A net of many holes would be walked around for every one of its threads.
  /// @returns whether it is the one at the start
  bool label_outline(const std::vector<uint32_t>& path) {
    constexpr size_t kLong = 20'000;
    OutlineWalk at_start(*this, path.front()), at_end(*this, opposite(path.back()));
    while (!at_start.is_done() && at_start.corners().size() < kLong) at_start.step();
    while (!at_start.is_done() && !at_end.is_done()) {
      at_end.step();
      if (at_end.corners().size() >= at_start.corners().size()) at_start.step();
    }
    ++label_;
    labelled_ = std::move((at_start.is_done() ? at_start : at_end).corners());
    for (const uint32_t corner : labelled_) corner_label_[corner] = label_;
    return at_start.is_done();
  }

  /// Shortest path from the labelled outline to any other, or to the lone vertex `target`, through vertices that are
  /// not on the graph, by price. Empty when there is none below `limit`.
  std::vector<uint32_t> shortest_connection(uint32_t target, double limit) {
    forget_distances();
    using Candidate = std::pair<double, uint32_t>;  // length, half-edge by which it arrives
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
    const auto offer = [&](uint32_t h, double so_far) {
      const double through = so_far + price(h);
      const uint32_t w = to(h);
      if (!(through < limit)) return;
      if (is_outline(w, target)) {
        if (corner_label_[next_half_edge(h)] != label_) queue.emplace(through, h);
      } else if (through < distance_[w]) {
        reach(w, through, h);
        queue.emplace(through, h);
      }
    };
    for (const uint32_t corner : labelled_) {
      if (!graph_.cut[corner]) offer(corner, 0);
    }
    while (!queue.empty()) {
      const double so_far = queue.top().first;
      const uint32_t h = queue.top().second;
      queue.pop();
      const uint32_t v = to(h);
      if (is_outline(v, target)) return path_back_from(h, target);
      if (parent_[v] != h) continue;
      around(
          v, [&](uint32_t out) { offer(out, so_far); }, [](uint32_t) {});
    }
    return {};
  }

  [[nodiscard]] bool is_outline(uint32_t v, uint32_t target) const {
    return v == target || degree_[v] > 0 || required_[v] != 0;
  }

  [[nodiscard]] std::vector<uint32_t> path_back_from(uint32_t h, uint32_t target) const {
    std::vector<uint32_t> path{h};
    while (!is_outline(from(path.back()), target)) path.push_back(parent_[from(path.back())]);
    return path;
  }

  /// Whether what was taken out between the two only hung in the graph: another path had left `loose` when its end slid
  /// away along the outline.
  [[nodiscard]] bool is_dead_end(uint32_t loose, uint32_t other) const {
    return degree_[loose] == 0 && !required_[loose] && degree_[other] > 0;
  }

  void straighten_path(const std::vector<uint32_t>& path) {
    for (const uint32_t h : path) set_cut(h, false);
    double old_price = 0;
    for (const uint32_t h : path) old_price += price(h);
    const uint32_t start = from(path.front()), end = to(path.back());
    if (is_dead_end(start, end) || is_dead_end(end, start)) return;
    std::vector<uint32_t> shorter;
    // With both ends bare the path was the whole graph of a sphere.
    if (degree_[start] > 0 || degree_[end] > 0) {
      const uint32_t other = label_outline(path) ? end : start;
      shorter = shortest_connection(degree_[other] == 0 ? other : kNone, old_price * (1 - 1e-9));
    }
    for (const uint32_t h : shorter.empty() ? path : shorter) {
      set_cut(h, true);
      straightened_[h] = straightened_[opposite(h)] = 1;
    }
  }

  void straighten(int pass) {
    straightened_.assign(half_edge_count(), 0);
    corner_label_.assign(half_edge_count(), 0);
    label_ = 0;
    std::vector<std::pair<double, uint32_t>> work;  // minus length of its path, half-edge
    std::vector<char> seen(half_edge_count(), 0);
    for (uint32_t h = 0; h < half_edge_count(); ++h) {
      if (!graph_.cut[h] || fixed_[h] || seen[h]) continue;
      double path_length = 0;
      for (const uint32_t edge : path_through(h)) {
        seen[edge] = seen[opposite(edge)] = 1;
        path_length += edge_length(edge);
      }
      work.emplace_back(-path_length, h);
    }
    std::sort(work.begin(), work.end());
    for (size_t i = 0; i < work.size(); ++i) {
      const uint32_t h = work[i].second;
      if (progress_) {
        progress_("cut", (pass + static_cast<double>(i) / static_cast<double>(work.size())) / kStraightenPasses);
      }
      if (!graph_.cut[h] || straightened_[h]) continue;
      straighten_path(path_through(h));
    }
  }

  const CleanSurface& surface_;
  const Progress& progress_;
  const std::vector<Triangle>& triangle_;
  CutGraph graph_;
  std::vector<uint32_t> first_half_edge_;  // per vertex
  std::vector<char> fixed_;                // per half-edge: border or tied
  std::vector<char> required_;             // per vertex: its point has other vertices, or a sphere's cut ends here
  std::vector<uint32_t> degree_;           // per vertex: cut edges around it
  std::vector<uint32_t> region_;           // per triangle
  std::vector<uint32_t> region_seed_;

  std::vector<double> price_;            // per half-edge [m]
  std::vector<uint32_t> mirror_vertex_;  // per vertex; empty without a mirror plane
  std::vector<int32_t> near_cut_;        // per vertex; empty until watch_cuts()

  std::vector<double> distance_;  // per vertex, kInfinity unless in touched_
  std::vector<uint32_t> parent_;  // per vertex: half-edge that reached it
  std::vector<uint32_t> touched_;

  std::vector<char> straightened_;      // per half-edge
  std::vector<uint32_t> corner_label_;  // per half-edge as the corner it leaves
  std::vector<uint32_t> labelled_;
  uint32_t label_ = 0;
};

}  // namespace

CutGraph find_cut_graph(const CleanSurface& surface, const CutOptions& options, const Progress& progress) {
  return CutGraphFinder(surface, options, progress).find();
}

OpenedVertices open_along(std::span<const Triangle> triangle, std::span<const uint32_t> opposite,
                          std::span<const char> cut) {
  OpenedVertices opened;
  opened.triangle.assign(triangle.size(), Triangle{kNone, kNone, kNone});
  const auto corner_vertex = [&](uint32_t h) -> uint32_t& { return opened.triangle[h / 3][h % 3]; };
  for (uint32_t start = 0; start < triangle.size() * 3; ++start) {
    if (corner_vertex(start) != kNone) continue;
    const auto vertex = static_cast<uint32_t>(opened.original.size());
    opened.original.push_back(tail(triangle, start));
    uint32_t h = start;
    while (!cut[h]) {
      h = next_half_edge(opposite[h]);
      if (h == start) break;
    }
    corner_vertex(h) = vertex;
    for (const uint32_t first = h; !cut[previous_half_edge(h)];) {
      h = opposite[previous_half_edge(h)];
      if (h == first) break;
      corner_vertex(h) = vertex;
    }
  }
  return opened;
}

}  // namespace geocloth
