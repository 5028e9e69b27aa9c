// SPDX-License-Identifier: GPL-3.0-or-later
//
// The other half of what OptCuts (Li et al. 2018) does: cuts that no longer pay are closed. Two disks that share an arc
// of their outlines are a disk again when sewn along it. One is laid beside the other as the arc asks for, rigidly, and
// both are relaxed together.

#include "develop/merge_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>

#include "develop/chart_energy.h"
#include "develop/chart_overlap.h"
#include "develop/embed_chart.h"
#include "develop/grain.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kSameGrain = 0.82;          // least cosine between two charts' grain lines
constexpr double kFaintGrain = 0.3;          // strength below which a chart's grain says nothing
constexpr size_t kMostAttempts = 1'000'000;  // triangles relaxed in attempts
constexpr size_t kFreshStart = 5;            // what a start from Tutte's embedding costs, in attempts
constexpr double kStillFalls = 1e-4;         // that a chart's energy may still fall
constexpr size_t kNarrowTip = 8;             // steps of a new slit near its tip, both sides, that are no matter
constexpr double kLeastShare = 0.05;         // of the shorter outline: shorter arcs make no good seam to keep closed

/// A stretch that two charts' outlines share: places in the loops, that of the first ascending, of the second
/// descending.
struct Arc {
  size_t a, b;  // charts
  size_t first_a, first_b;
  size_t edges;
  double length;
};

/// How many steps of an outline, divided into steps of half the width, come nearer to a far part of it than the width.
size_t narrow_steps(const Chart& c, double width) {
  if (!(width > 0)) return 0;
  const std::vector<uint32_t> loop = outline_loop(c);
  const double step = width / 2;
  std::vector<Point2> place;
  double carry = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Point2 &a = c.uv[loop[i]], &b = c.uv[loop[(i + 1) % loop.size()]];
    const double l = std::hypot(b[0] - a[0], b[1] - a[1]);
    const auto count = static_cast<size_t>((carry + l) / step);
    for (size_t k = 1; k <= count; ++k) {
      const double share = (static_cast<double>(k) * step - carry) / l;
      place.push_back({a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])});
    }
    carry += l - static_cast<double>(count) * step;
  }
  constexpr size_t kBeside = 8;  // steps along the outline that are not far
  const size_t n = place.size();
  using Cell = std::array<int64_t, 2>;  // of a board of squares as wide as the width
  const auto cell_of = [&](const Point2& p) {
    return Cell{static_cast<int64_t>(std::floor(p[0] / width)), static_cast<int64_t>(std::floor(p[1] / width))};
  };
  std::vector<std::pair<Cell, size_t>> board(n);
  for (size_t i = 0; i < n; ++i) board[i] = {cell_of(place[i]), i};
  std::sort(board.begin(), board.end());
  const auto is_narrow = [&](size_t i) {
    const auto [x, y] = cell_of(place[i]);
    for (const int64_t dx : {-1, 0, 1}) {  // the squares of a column lie side by side on the board
      auto at = std::lower_bound(board.begin(), board.end(), std::pair{Cell{x + dx, y - 1}, size_t{0}});
      for (; at != board.end() && at->first <= Cell{x + dx, y + 1}; ++at) {
        const size_t k = (at->second + n - i) % n;
        const Point2& other = place[at->second];
        const bool is_far = k >= kBeside && k + kBeside < n;
        if (is_far && std::hypot(place[i][0] - other[0], place[i][1] - other[1]) < width) return true;
      }
    }
    return false;
  };
  size_t narrow = 0;
  for (size_t i = 0; i < n; ++i) {
    if (is_narrow(i)) ++narrow;
  }
  return narrow;
}

class Merger {
 public:
  Merger(std::vector<Chart>& charts, const Sheet& sheet, const MergeOptions& options)
      : charts_(charts), sheet_(sheet), options_(options) {
    for (const Chart& c : charts) of_chart_.push_back(measured(c));
  }

  void merge_all() {
    while (merge_once()) {
    }
  }

 private:
  /// What is asked of a chart again and again.
  struct Known {
    double energy, area, outline;
    std::vector<uint32_t> loop;
  };
  [[nodiscard]] static Known measured(const Chart& c) {
    return {chart_energy(c).energy(c.uv), total_area(c), outline_length(c), outline_loop(c)};
  }
  [[nodiscard]] uint32_t sheet_vertex(const Chart& c, uint32_t v) const { return sheet_.of_vertex[c.cut_vertex[v]]; }

  bool merge_once() {
    for (const Arc& arc : arcs()) {
      const std::pair<uint32_t, uint32_t> name = name_of(arc);
      if (refused_.contains(name)) continue;
      std::optional<Chart> merged = attempt(arc);
      if (!merged) {
        refused_.insert(name);
        continue;
      }
      of_chart_[arc.a] = measured(*merged);
      charts_[arc.a] = std::move(*merged);
      charts_.erase(charts_.begin() + static_cast<std::ptrdiff_t>(arc.b));
      of_chart_.erase(of_chart_.begin() + static_cast<std::ptrdiff_t>(arc.b));
      return true;
    }
    return false;
  }

  /// Maximal common stretches of any two charts, longest first.
  [[nodiscard]] std::vector<Arc> arcs() const {
    struct Side {
      size_t chart, place;
    };
    std::vector<std::vector<uint32_t>> loop;
    std::unordered_map<uint64_t, Side> ahead;  // outline edge as (tail, head) in sheet vertices
    const auto name = [](uint32_t tail, uint32_t head) { return uint64_t{tail} << 32U | head; };
    for (size_t c = 0; c < charts_.size(); ++c) {
      loop.push_back(of_chart_[c].loop);
      for (uint32_t& v : loop[c]) v = sheet_vertex(charts_[c], v);
      for (size_t i = 0; i < loop[c].size(); ++i) ahead[name(loop[c][i], loop[c][(i + 1) % loop[c].size()])] = {c, i};
    }
    std::vector<Arc> result;
    for (size_t a = 0; a < charts_.size(); ++a) {
      const size_t n = loop[a].size();
      // Per edge of the loop: the edge that lies on its other side.
      const auto other = [&](size_t i) -> std::optional<Side> {
        const uint32_t u = loop[a][i % n], v = loop[a][(i + 1) % n];
        const auto found = ahead.find(name(v, u));
        if (found == ahead.end() || found->second.chart <= a) return std::nullopt;
        if (sheet_.tied[u] && sheet_.tied[v]) return std::nullopt;
        return found->second;
      };
      const auto continues = [&](size_t i) {  // from edge i - 1 to edge i
        const auto before = other(i + n - 1), now = other(i);
        if (!before || !now || sheet_.tied[loop[a][i % n]]) return false;
        const size_t m = loop[now->chart].size();
        return before->chart == now->chart && before->place == (now->place + 1) % m;
      };
      for (size_t i = 0; i < n; ++i) {
        if (!other(i) || continues(i)) continue;
        size_t edges = 1;
        while (edges < n && continues(i + edges)) ++edges;
        const Side last = *other(i + edges - 1);
        double length = 0;
        const std::vector<uint32_t>& vertices = of_chart_[a].loop;
        for (size_t k = i; k < i + edges; ++k) {
          length += distance(charts_[a].position[vertices[k % n]], charts_[a].position[vertices[(k + 1) % n]]);
        }
        result.push_back({a, last.chart, i, last.place, edges, length});
      }
    }
    std::stable_sort(result.begin(), result.end(), [](const Arc& x, const Arc& y) { return x.length > y.length; });
    return result;
  }

  /// By the triangles beside its first edge: stays the same while other charts merge.
  [[nodiscard]] std::pair<uint32_t, uint32_t> name_of(const Arc& arc) const {
    const std::vector<uint32_t>& vertices = of_chart_[arc.a].loop;
    return {sheet_vertex(charts_[arc.a], vertices[arc.first_a]),
            sheet_vertex(charts_[arc.a], vertices[(arc.first_a + arc.edges) % vertices.size()])};
  }

  std::optional<Chart> attempt(const Arc& arc) {
    const Chart &a = charts_[arc.a], &b = charts_[arc.b];
    const Known &of_a = of_chart_[arc.a], &of_b = of_chart_[arc.b];
    const double area = of_a.area + of_b.area;
    if (arc.length < kLeastShare * std::min(of_a.outline, of_b.outline)) return std::nullopt;
    if (work_ + a.triangle.size() + b.triangle.size() > kMostAttempts) return std::nullopt;
    const double before = (of_a.energy * of_a.area + of_b.energy * of_b.area) / area;
    if (before > options_.most_energy + kStillFalls) return std::nullopt;  // sewn together they lie no better
    const double most = std::min(options_.most_energy, before + options_.seam_price * arc.length / std::sqrt(area));
    std::optional<Chart> merged = sewn(arc);
    if (!merged) return std::nullopt;
    if (!flip_free(*merged)) {
      work_ += kFreshStart * merged->triangle.size();
      if (!embed_on_circle(*merged)) return std::nullopt;
      (void)chart_energy(*merged).minimise(merged->uv, 60, 1e-3);
    }
    SymmetricDirichlet energy = chart_energy(*merged);
    // A few steps tell most failures.
    for (const uint32_t steps : {5U, 30U}) {
      work_ += merged->triangle.size();
      const double reached = energy.minimise(merged->uv, steps, 1e-5);
      if (crossing_edges(*merged, outline_loop(*merged))) return std::nullopt;
      if (steps > 5 && reached > most) return std::nullopt;
    }
    const size_t narrow_before = narrow_steps(a, options_.narrow) + narrow_steps(b, options_.narrow);
    if (narrow_steps(*merged, options_.narrow) > narrow_before + kNarrowTip) return std::nullopt;
    return merged;
  }

  /// Both charts as one, the second laid beside the first; nothing when their grain lines disagree, or it is no disk.
  [[nodiscard]] std::optional<Chart> sewn(const Arc& arc) const {
    const Chart& a = charts_[arc.a];
    Chart b = charts_[arc.b];
    const std::vector<uint32_t>&loop_a = of_chart_[arc.a].loop, &loop_b = of_chart_[arc.b].loop;
    std::vector<std::array<uint32_t, 2>> pair;  // vertices of a and b
    const size_t n = loop_a.size(), m = loop_b.size();
    for (size_t k = 0; k <= arc.edges; ++k) {
      pair.push_back({loop_a[(arc.first_a + k) % n], loop_b[(arc.first_b + arc.edges - k) % m]});
    }
    lay_beside(a, b, pair);
    if (!same_grain(a, b)) return std::nullopt;

    Chart merged = a;
    std::vector<uint32_t> number(b.position.size(), kNone);
    for (const auto& [va, vb] : pair) {
      number[vb] = va;
      for (size_t k = 0; k < 2; ++k) merged.uv[va][k] = (a.uv[va][k] + b.uv[vb][k]) / 2;
    }
    for (uint32_t v = 0; v < b.position.size(); ++v) {
      if (number[v] != kNone) continue;
      number[v] = static_cast<uint32_t>(merged.position.size());
      merged.position.push_back(b.position[v]);
      merged.cut_vertex.push_back(b.cut_vertex[v]);
      merged.uv.push_back(b.uv[v]);
    }
    for (const Triangle& t : b.triangle) merged.triangle.push_back({number[t[0]], number[t[1]], number[t[2]]});
    merged.global_triangle.insert(merged.global_triangle.end(), b.global_triangle.begin(), b.global_triangle.end());
    if (!a.hole.empty() || !b.hole.empty()) {
      merged.hole.resize(a.triangle.size(), kNone);
      merged.hole.insert(merged.hole.end(), b.hole.begin(), b.hole.end());
      merged.hole.resize(merged.triangle.size(), kNone);
    }
    if (!is_manifold(merged.triangle)) return std::nullopt;
    merged.opposite = opposite_half_edges(merged.triangle);
    // Two edges that are left lie on each other, and the surface has closed.
    const auto outline = static_cast<size_t>(std::ranges::count(merged.opposite, kNone));
    if (outline < 3 || outline != n + m - 2 * arc.edges) return std::nullopt;
    return merged;
  }

  /// Whether no two faces have an edge in the same direction. Corners that both charts cut off at the seam share more
  /// than the seam's edges.
  static bool is_manifold(std::span<const Triangle> triangle) {
    std::vector<std::pair<uint32_t, uint32_t>> edge;
    edge.reserve(3 * triangle.size());
    for (uint32_t h = 0; h < 3 * triangle.size(); ++h) edge.emplace_back(tail(triangle, h), head(triangle, h));
    std::ranges::sort(edge);
    return std::ranges::adjacent_find(edge) == edge.end();
  }

  /// Moves b rigidly so that the pairs lie together as well as possible (least squares).
  static void lay_beside(const Chart& a, Chart& b, const std::vector<std::array<uint32_t, 2>>& pair) {
    Point2 centre_a{0, 0}, centre_b{0, 0};
    const auto n = static_cast<double>(pair.size());
    for (const auto& [va, vb] : pair) {
      for (size_t k = 0; k < 2; ++k) {
        centre_a[k] += a.uv[va][k] / n;
        centre_b[k] += b.uv[vb][k] / n;
      }
    }
    double along = 0, across = 0;
    for (const auto& [va, vb] : pair) {
      const double px = b.uv[vb][0] - centre_b[0], py = b.uv[vb][1] - centre_b[1];
      const double qx = a.uv[va][0] - centre_a[0], qy = a.uv[va][1] - centre_a[1];
      along += px * qx + py * qy;
      across += px * qy - py * qx;
    }
    const double l = std::hypot(along, across);
    const double cosine = l > 0 ? along / l : 1, sine = l > 0 ? across / l : 0;
    for (Point2& p : b.uv) {
      const double x = p[0] - centre_b[0], y = p[1] - centre_b[1];
      p = {centre_a[0] + cosine * x - sine * y, centre_a[1] + sine * x + cosine * y};
    }
  }

  [[nodiscard]] static bool same_grain(const Chart& a, const Chart& b) {
    const Grain of_a = grain_of(a), of_b = grain_of(b);
    if (of_a.strength < kFaintGrain || of_b.strength < kFaintGrain) return true;
    return std::abs(of_a.axis[0] * of_b.axis[0] + of_a.axis[1] * of_b.axis[1]) >= kSameGrain;
  }

  std::vector<Chart>& charts_;
  const Sheet& sheet_;
  const MergeOptions options_;
  std::vector<Known> of_chart_;
  std::set<std::pair<uint32_t, uint32_t>> refused_;
  size_t work_ = 0;
};

}  // namespace

void merge_charts(std::vector<Chart>& charts, const Sheet& sheet, const MergeOptions& options) {
  if (charts.size() > 1) Merger(charts, sheet, options).merge_all();
}

}  // namespace geocloth
