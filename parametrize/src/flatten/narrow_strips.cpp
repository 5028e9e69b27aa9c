// SPDX-License-Identifier: GPL-3.0-or-later
// A strip is what lies beyond a short way from outline to outline and is as long and as narrow as its outline and area
// say together. Of several ways across one strip that at its root leaves most of the outline beyond it.
#include "flatten/narrow_strips.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_map>
#include <utility>

#include "develop/grain.h"
#include "develop/met_holes.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kMostWidth = 2;    // [pixels] a wider strip has room for two columns where it is
constexpr double kLeastLength = 2;  // [pixels] shorter ones are teeth that an outline can follow
constexpr double kStraight = 0.3;   // reach / outline; of a straight strip a half, of half a ring 1 / pi
constexpr double kRootPrice = 2;    // outline that a root has to gain for each length that it is longer
constexpr double kNoWider = 1 + 1e-9;

/// A way across a chart and the part of the outline, from `first` to `last` counter-clockwise, that it cuts off.
struct Root {
  uint32_t first, last;  ///< places in the outline's loop
  double gain;
  std::vector<uint32_t> path;  ///< vertices
};

class StripFinder {
 public:
  StripFinder(const Chart& chart, double spacing)
      : chart_(chart), spacing_(spacing), loop_(outline_loop(chart)), around_(neighbours(chart)) {
    place_.assign(chart.position.size(), kNone);
    for (uint32_t i = 0; i < loop_.size(); ++i) place_[loop_[i]] = i;
    filling_.assign(chart.position.size(), 0);
    for (size_t t = 0; t < chart.triangle.size(); ++t) {
      if (chart.is_cloth(t)) continue;
      for (const uint32_t v : chart.triangle[t]) filling_[v] = 1;
    }
    for (size_t i = 0; i < loop_.size(); ++i) {
      const Point2 &p = chart.uv[loop_[i]], &q = chart.uv[loop_[(i + 1) % loop_.size()]];
      length_.push_back(length_.back() + std::hypot(q[0] - p[0], q[1] - p[1]));
      area_twice_.push_back(area_twice_.back() + p[0] * q[1] - p[1] * q[0]);
    }
  }

  /// The paths to cut along, none of which lies beyond another.
  std::vector<std::vector<uint32_t>> run() {
    for (uint32_t i = 0; i < loop_.size(); ++i) look_from(i);
    std::stable_sort(roots_.begin(), roots_.end(), [](const Root& a, const Root& b) { return a.gain > b.gain; });
    std::vector<uint8_t> taken(loop_.size(), 0);  // per edge of the outline
    std::vector<std::vector<uint32_t>> paths;
    for (Root& root : roots_) {
      if (!take(root, taken)) continue;
      paths.push_back(std::move(root.path));
    }
    return paths;
  }

 private:
  /// Dijkstra's search from a place on the outline, as far as a root may be long.
  void look_from(uint32_t place) {
    const double most = kMostWidth * spacing_ * kNoWider;
    using Entry = std::pair<double, uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::unordered_map<uint32_t, std::pair<double, uint32_t>> reached;  // way, from where
    const uint32_t start = loop_[place];
    reached[start] = {0, kNone};
    queue.emplace(0, start);
    while (!queue.empty()) {
      const auto [way, v] = queue.top();
      queue.pop();
      if (way > reached[v].first || filling_[v] != 0) continue;
      if (v != start && place_[v] != kNone) {
        if (v > start) look_at(place, place_[v], reached);
        continue;
      }
      for (const ChartNeighbour& n : around_[v]) {
        if (n.outline || way + n.length > most) continue;
        const auto known = reached.find(n.vertex);
        if (known != reached.end() && known->second.first <= way + n.length) continue;
        reached[n.vertex] = {way + n.length, v};
        queue.emplace(way + n.length, n.vertex);
      }
    }
  }

  void look_at(uint32_t a, uint32_t b, const std::unordered_map<uint32_t, std::pair<double, uint32_t>>& reached) {
    for (const auto& [first, last] : {std::pair(a, b), std::pair(b, a)}) {
      const double root = reached.at(loop_[b]).first;
      if (!is_strip(first, last)) continue;
      Root r{first, last, between(length_, first, last) - kRootPrice * root, {}};
      for (uint32_t v = loop_[b]; v != kNone; v = reached.at(v).second) r.path.push_back(v);
      roots_.push_back(std::move(r));
    }
  }

  /// Sum of what the edges of the outline have from one place to another.
  [[nodiscard]] static double between(const std::vector<double>& sum, uint32_t first, uint32_t last) {
    return sum[last] - sum[first] + (last < first ? sum.back() : 0);
  }

  [[nodiscard]] bool is_strip(uint32_t first, uint32_t last) const {
    const Point2 &p = chart_.uv[loop_[first]], &q = chart_.uv[loop_[last]];
    const double outline = between(length_, first, last) + std::hypot(q[0] - p[0], q[1] - p[1]);
    const double area = (between(area_twice_, first, last) + q[0] * p[1] - q[1] * p[0]) / 2;
    // Sides of the rectangle that has both.
    const double width = (outline - std::sqrt(std::max(outline * outline - 16 * area, 0.0))) / 4;
    if (area <= 0 || width > kMostWidth * spacing_ || outline / 2 - width < kLeastLength * spacing_) return false;
    return reach(first, last) >= kStraight * outline;
  }

  /// How far the strip reaches from its root.
  [[nodiscard]] double reach(uint32_t first, uint32_t last) const {
    const Point2 &p = chart_.uv[loop_[first]], &q = chart_.uv[loop_[last]];
    double most = 0;
    for (uint32_t i = first; i != last; i = next(i)) {
      const Point2& x = chart_.uv[loop_[i]];
      most = std::max(most, std::hypot(x[0] - (p[0] + q[0]) / 2, x[1] - (p[1] + q[1]) / 2));
    }
    return most;
  }

  [[nodiscard]] bool take(const Root& root, std::vector<uint8_t>& taken) const {
    for (uint32_t i = root.first; i != root.last; i = next(i)) {
      if (taken[i] != 0) return false;
    }
    for (uint32_t i = root.first; i != root.last; i = next(i)) taken[i] = 1;
    return true;
  }

  [[nodiscard]] uint32_t next(uint32_t place) const { return place + 1 == loop_.size() ? 0 : place + 1; }

  const Chart& chart_;
  double spacing_;
  std::vector<uint32_t> loop_;
  std::vector<std::vector<ChartNeighbour>> around_;  // per vertex
  std::vector<uint32_t> place_;                      // per vertex: in the loop
  std::vector<uint8_t> filling_;                     // per vertex: of a hole that is filled
  std::vector<double> length_{0}, area_twice_{0};    // sums along the outline
  std::vector<Root> roots_;
};

}  // namespace

bool cut_off_strips(DevelopedSurface& developed, std::span<const size_t> least, double spacing) {
  std::vector<Chart> all = charts_of(developed), strips;
  for (size_t c = 0; c < all.size(); ++c) {
    if (least[c] == kNoStrips) continue;
    const std::vector<std::vector<uint32_t>> paths = StripFinder(all[c], spacing).run();
    if (paths.size() < least[c]) continue;
    std::vector<Chart> pieces = separated(opened(all[c], paths));
    const auto body = std::max_element(pieces.begin(), pieces.end(),
                                       [](const Chart& a, const Chart& b) { return total_area(a) < total_area(b); });
    all[c] = std::move(*body);
    pieces.erase(body);
    for (Chart& strip : pieces) {
      turn_upright(strip);
      strips.push_back(std::move(strip));
    }
  }
  if (strips.empty()) return false;
  std::move(strips.begin(), strips.end(), std::back_inserter(all));
  developed = assembled(developed.cut, all);
  return true;
}

}  // namespace geocloth
