// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nested dissection (George 1973) with separators found in the plane (Miller, Teng, Vavasis 1991 say why that is as
// good as can be): a piece of the mesh is halved by number along x and along y, and what lies on one side but touches
// the other parts it; the shorter of the four candidates is taken. Factors of n unknowns have n log n entries.
#include "develop/dissection.h"

#include <algorithm>
#include <array>

namespace geocloth {
namespace {

constexpr uint32_t kSmall = 16;  // unknowns that are not parted further
constexpr size_t kLong = 4;      // squared length of a separator, by what it parts, from which another way is tried

/// Who is connected to whom, by number.
struct Graph {
  std::vector<uint32_t> first, neighbour;  // per node: a range of neighbours, twice where two triangles say so

  /// @param number  of a vertex; negative leaves it out
  template <class Number>
  Graph(std::span<const Triangle> triangle, size_t nodes, const Number& number) {
    const auto each = [&](const auto& visit) {
      for (const Triangle& t : triangle) {
        for (size_t i = 0; i < 3; ++i) {
          const int32_t a = number(t[i]), b = number(t[(i + 1) % 3]);
          if (a < 0 || b < 0) continue;
          visit(static_cast<uint32_t>(a), static_cast<uint32_t>(b));
          visit(static_cast<uint32_t>(b), static_cast<uint32_t>(a));
        }
      }
    };
    first.assign(nodes + 1, 0);
    each([&](uint32_t a, uint32_t) { ++first[a + 1]; });
    for (size_t u = 0; u < nodes; ++u) first[u + 1] += first[u];
    neighbour.resize(first.back());
    std::vector<uint32_t> end = first;
    each([&](uint32_t a, uint32_t b) { neighbour[end[a]++] = b; });
  }

  [[nodiscard]] std::span<const uint32_t> around(uint32_t u) const {
    return {neighbour.data() + first[u], neighbour.data() + first[u + 1]};
  }
};

class Dissector {
 public:
  Dissector(std::span<const Triangle> triangle, std::span<const int32_t> unknown, std::span<const Point2> place)
      : place_(places_of_unknowns(unknown, place)),
        graph_(triangle, place_.size(), [&](uint32_t v) { return unknown[v]; }) {
    side_.assign(place_.size(), Side::elsewhere);
    result_.order.resize(place_.size());
    for (uint32_t u = 0; u < place_.size(); ++u) result_.order[u] = u;
  }

  Dissection run() {
    if (!result_.order.empty()) part(0, static_cast<uint32_t>(result_.order.size()));
    return std::move(result_);
  }

 private:
  enum class Side : uint8_t { elsewhere, low, high, between };

  static std::vector<Point2> places_of_unknowns(std::span<const int32_t> unknown, std::span<const Point2> place) {
    std::vector<Point2> result;
    for (size_t v = 0; v < unknown.size(); ++v) {
      if (unknown[v] >= 0) result.push_back(place[v]);
    }
    return result;
  }

  /// Orders a range of unknowns and appends its nodes. @returns the node at their top
  uint32_t part(uint32_t begin, uint32_t end) {
    std::array<uint32_t, 2> child{kNone, kNone};
    uint32_t own = begin;
    if (end - begin > kSmall) {
      const auto [low_end, high_end] = halve(begin, end);
      if (low_end > begin) child[0] = part(begin, low_end);
      if (high_end > low_end) child[1] = part(low_end, high_end);
      own = high_end;
    }
    const auto number = static_cast<uint32_t>(result_.node.size());
    for (const uint32_t c : child) {
      if (c != kNone) result_.node[c].parent = number;
    }
    result_.node.push_back({own, end, kNone});
    return number;
  }

  /// A range in two halves and what parts them.
  struct Halves {
    std::vector<uint32_t> order;  // the low side, the high side, what parts them
    std::array<size_t, 2> end{};  // of the first two, in it
    size_t separator = 0;
  };

  /// Rearranges a range: what is on the low side, what is on the high side, what parts them.
  std::array<uint32_t, 2> halve(uint32_t begin, uint32_t end) {
    const std::span<uint32_t> range(result_.order.data() + begin, end - begin);
    const auto half = static_cast<std::ptrdiff_t>(range.size() / 2);
    Halves best;
    best.separator = range.size() + 1;
    for (const size_t axis : {size_t{0}, size_t{1}}) {
      std::nth_element(range.begin(), range.begin() + half, range.end(), [&](uint32_t a, uint32_t b) {
        return place_[a][axis] != place_[b][axis] ? place_[a][axis] < place_[b][axis] : a < b;
      });
      part_halves(range, best);
    }
    if (best.separator * best.separator > kLong * range.size()) {
      walk(range);
      part_halves(range, best);
    }
    for (const uint32_t u : range) side_[u] = Side::elsewhere;
    std::copy(best.order.begin(), best.order.end(), range.begin());
    return {begin + static_cast<uint32_t>(best.end[0]), begin + static_cast<uint32_t>(best.end[1])};
  }

  /// Keeps what parts the first half of a range from the rest where that is shorter than the best so far.
  void part_halves(std::span<const uint32_t> range, Halves& best) {
    for (size_t i = 0; i < range.size(); ++i) side_[range[i]] = i < range.size() / 2 ? Side::low : Side::high;
    std::array<std::vector<uint32_t>, 4> part;  // by Side
    for (const Side from : {Side::low, Side::high}) {
      const Side to = from == Side::low ? Side::high : Side::low;
      const auto touches = [&](uint32_t u) {
        const std::span<const uint32_t> around = graph_.around(u);
        return std::any_of(around.begin(), around.end(), [&](uint32_t w) { return side_[w] == to; });
      };
      for (auto& p : part) p.clear();
      for (const uint32_t u : range) {
        const Side at = side_[u] == from && touches(u) ? Side::between : side_[u];
        part[static_cast<size_t>(at)].push_back(u);
      }
      const auto& [elsewhere, low, high, between] = part;
      if (between.size() >= best.separator) continue;
      best = {low, {low.size(), low.size() + high.size()}, between.size()};
      best.order.insert(best.order.end(), high.begin(), high.end());
      best.order.insert(best.order.end(), between.begin(), between.end());
    }
  }

  /// Orders a range as a walk along its edges meets it that starts at one of its ends.
  void walk(std::span<uint32_t> range) {
    std::vector<uint32_t> met(range.begin(), range.end());
    for (int twice = 0; twice < 2; ++twice) {
      std::reverse(met.begin(), met.end());  // the second time from what was met last
      const std::vector<uint32_t> start = std::move(met);
      met.clear();
      for (const uint32_t u : range) side_[u] = Side::low;
      for (size_t next = 0, seed = 0; met.size() < range.size(); ++seed) {
        const auto take = [&](uint32_t u) {
          if (side_[u] != Side::low) return;
          side_[u] = Side::elsewhere;
          met.push_back(u);
        };
        take(start[seed]);
        for (; next < met.size(); ++next) {
          for (const uint32_t w : graph_.around(met[next])) take(w);
        }
      }
    }
    std::copy(met.begin(), met.end(), range.begin());
  }

  std::vector<Point2> place_;  // per unknown
  Graph graph_;
  std::vector<Side> side_;  // per unknown, while its range is parted
  Dissection result_;
};

/// Edges on the shortest ways from a vertex; 0 where none leads.
std::vector<uint32_t> edges_from(const Graph& graph, uint32_t start) {
  std::vector<uint32_t> count(graph.first.size() - 1, 0), queue{start};
  std::vector<uint8_t> met(count.size(), 0);
  met[start] = 1;
  for (size_t i = 0; i < queue.size(); ++i) {
    for (const uint32_t w : graph.around(queue[i])) {
      if (met[w] != 0) continue;
      met[w] = 1;
      count[w] = count[queue[i]] + 1;
      queue.push_back(w);
    }
  }
  return count;
}

}  // namespace

Dissection dissect(std::span<const Triangle> triangle, std::span<const int32_t> unknown,
                   std::span<const Point2> place) {
  return Dissector(triangle, unknown, place).run();
}

std::vector<Point2> places_by_edges(std::span<const Triangle> triangle, size_t vertex_count) {
  std::vector<Point2> place(vertex_count, Point2{0, 0});
  if (triangle.empty()) return place;
  const Graph graph(triangle, vertex_count, [](uint32_t v) { return static_cast<int32_t>(v); });
  const auto farthest = [](const std::vector<uint32_t>& count) {
    return static_cast<uint32_t>(std::max_element(count.begin(), count.end()) - count.begin());
  };
  const std::vector<uint32_t> a = edges_from(graph, farthest(edges_from(graph, triangle[0][0])));
  const std::vector<uint32_t> b = edges_from(graph, farthest(a));
  std::vector<uint32_t> from_both(vertex_count);
  for (size_t v = 0; v < vertex_count; ++v) from_both[v] = std::min(a[v], b[v]);
  const std::vector<uint32_t> c = edges_from(graph, farthest(from_both));
  for (size_t v = 0; v < vertex_count; ++v) {
    place[v] = {static_cast<double>(a[v]) - static_cast<double>(b[v]), static_cast<double>(c[v])};
  }
  return place;
}

}  // namespace geocloth
