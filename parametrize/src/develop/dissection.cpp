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
  std::vector<uint32_t> first, neighbour;  // per node: a range of neighbours, in the order in which triangles name them

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
    name_once(nodes);
  }

  [[nodiscard]] std::span<const uint32_t> around(uint32_t u) const {
    return {neighbour.data() + first[u], neighbour.data() + first[u + 1]};
  }

 private:
  /// Two triangles have named most neighbours.
  void name_once(size_t nodes) {
    std::vector<uint32_t> named_by(nodes, kNone);
    uint32_t kept = 0;
    for (uint32_t u = 0, begin = 0; u < nodes; ++u) {
      const uint32_t end = first[u + 1];
      first[u] = kept;
      for (; begin < end; ++begin) {
        const uint32_t w = neighbour[begin];
        if (named_by[w] == u) continue;
        named_by[w] = u;
        neighbour[kept++] = w;
      }
    }
    first[nodes] = kept;
    neighbour.resize(kept);
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
  enum class Side : uint8_t { elsewhere, low, high };

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

  /// An unknown beside its coordinate, by which it is compared more often than looked up.
  struct Placed {
    double at;
    uint32_t unknown;

    friend bool operator<(const Placed& a, const Placed& b) {
      return a.at != b.at ? a.at < b.at : a.unknown < b.unknown;
    }
  };

  /// Rearranges a range: what is on the low side, what is on the high side, what parts them.
  std::array<uint32_t, 2> halve(uint32_t begin, uint32_t end) {
    const std::span<uint32_t> range(result_.order.data() + begin, end - begin);
    best_.separator = range.size() + 1;
    placed_.resize(range.size());
    for (const size_t axis : {size_t{0}, size_t{1}}) {
      for (size_t i = 0; i < range.size(); ++i) placed_[i] = {place_[range[i]][axis], range[i]};
      std::nth_element(placed_.begin(), placed_.begin() + static_cast<std::ptrdiff_t>(range.size() / 2), placed_.end());
      for (size_t i = 0; i < range.size(); ++i) range[i] = placed_[i].unknown;
      part_halves(range);
    }
    if (best_.separator * best_.separator > kLong * range.size()) {
      walk(range);
      part_halves(range);
    }
    for (const uint32_t u : range) side_[u] = Side::elsewhere;
    std::copy(best_.order.begin(), best_.order.end(), range.begin());
    return {begin + static_cast<uint32_t>(best_.end[0]), begin + static_cast<uint32_t>(best_.end[1])};
  }

  /// Keeps what parts the first half of a range from the rest where that is shorter than the best so far.
  void part_halves(std::span<const uint32_t> range) {
    const std::span<const uint32_t> low = range.first(range.size() / 2), high = range.subspan(range.size() / 2);
    for (const uint32_t u : low) side_[u] = Side::low;
    for (const uint32_t u : high) side_[u] = Side::high;
    for (const Side from : {Side::low, Side::high}) {
      const Side to = from == Side::low ? Side::high : Side::low;
      inner_.clear();
      between_.clear();
      for (const uint32_t u : from == Side::low ? low : high) {
        const std::span<const uint32_t> around = graph_.around(u);
        const bool touches = std::any_of(around.begin(), around.end(), [&](uint32_t w) { return side_[w] == to; });
        (touches ? between_ : inner_).push_back(u);
        if (between_.size() >= best_.separator) break;
      }
      if (between_.size() >= best_.separator) continue;
      const std::span<const uint32_t> inner = inner_, first = from == Side::low ? inner : low,
                                      second = from == Side::low ? high : inner;
      best_.order.assign(first.begin(), first.end());
      best_.order.insert(best_.order.end(), second.begin(), second.end());
      best_.end = {first.size(), best_.order.size()};
      best_.order.insert(best_.order.end(), between_.begin(), between_.end());
      best_.separator = between_.size();
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
  // While a range is parted:
  Halves best_;
  std::vector<Placed> placed_;
  std::vector<uint32_t> inner_, between_;  // of the half that gives up what touches the other
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
