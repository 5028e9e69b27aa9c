// SPDX-License-Identifier: GPL-3.0-or-later
//
// Nested dissection (George 1973) with separators found in the plane (Miller, Teng, Vavasis 1991 say why that is as
// good as can be): a piece of the mesh is halved by number along x and along y, and what lies on one side but touches
// the other parts it; the shorter of the four candidates is taken. Factors of n unknowns have n log n entries.
#include "develop/dissection.h"

#include <algorithm>
#include <array>

#include <tbb/parallel_for.h>

namespace geocloth {
namespace {

constexpr uint32_t kSmall = 16;           // unknowns that are not parted further
constexpr uint32_t kMostInATask = 2'000;  // unknowns
constexpr size_t kLong = 4;  // squared length of a separator, by what it parts, from which another way is tried

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
    order_.resize(place_.size());
    for (uint32_t u = 0; u < place_.size(); ++u) order_[u] = u;
  }

  Dissection run() {
    std::vector<Node> node;
    if (!order_.empty()) node = part_in_tasks(0, static_cast<uint32_t>(order_.size()));
    return {std::move(node), std::move(order_)};
  }

 private:
  using Node = Dissection::Node;
  enum class Side : uint8_t { elsewhere, low, high };

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

  /// What is needed while a range is parted.
  struct Scratch {
    Halves best;
    std::vector<Placed> placed;
    std::vector<uint32_t> inner, between;  // of the half that gives up what touches the other
  };

  static std::vector<Point2> places_of_unknowns(std::span<const int32_t> unknown, std::span<const Point2> place) {
    std::vector<Point2> result;
    for (size_t v = 0; v < unknown.size(); ++v) {
      if (unknown[v] >= 0) result.push_back(place[v]);
    }
    return result;
  }

  /// Orders a range of unknowns. Branches touch none of each other's unknowns: what is beside a range was taken out of
  /// it by those above, and is elsewhere for all below them.
  /// @returns its nodes, the last one at their top
  std::vector<Node> part_in_tasks(uint32_t begin, uint32_t end) {
    Scratch scratch;
    std::vector<Node> node;
    if (end - begin <= kMostInATask) {
      part(begin, end, scratch, node);
      return node;
    }
    const auto [low_end, high_end] = halve(begin, end, scratch);
    const std::array<uint32_t, 3> bound{begin, low_end, high_end};
    std::array<std::vector<Node>, 2> of_half;
    tbb::parallel_for(size_t{0}, of_half.size(), [&](size_t h) {
      if (bound.at(h + 1) > bound.at(h)) of_half.at(h) = part_in_tasks(bound.at(h), bound.at(h + 1));
    });
    std::array<uint32_t, 2> child{kNone, kNone};
    for (size_t h = 0; h < of_half.size(); ++h) {
      if (of_half.at(h).empty()) continue;
      const auto before = static_cast<uint32_t>(node.size());
      for (const Node& n : of_half.at(h)) {
        node.push_back({n.begin, n.end, n.parent == kNone ? kNone : before + n.parent});
      }
      child.at(h) = static_cast<uint32_t>(node.size() - 1);
    }
    append(node, child, high_end, end);
    return node;
  }

  /// The same without tasks: appends the range's nodes. @returns the one at their top
  uint32_t part(uint32_t begin, uint32_t end, Scratch& scratch, std::vector<Node>& node) {
    std::array<uint32_t, 2> child{kNone, kNone};
    uint32_t own = begin;
    if (end - begin > kSmall) {
      const auto [low_end, high_end] = halve(begin, end, scratch);
      if (low_end > begin) child[0] = part(begin, low_end, scratch, node);
      if (high_end > low_end) child[1] = part(low_end, high_end, scratch, node);
      own = high_end;
    }
    return append(node, child, own, end);
  }

  static uint32_t append(std::vector<Node>& node, const std::array<uint32_t, 2>& child, uint32_t begin, uint32_t end) {
    const auto number = static_cast<uint32_t>(node.size());
    for (const uint32_t c : child) {
      if (c != kNone) node[c].parent = number;
    }
    node.push_back({begin, end, kNone});
    return number;
  }

  /// Rearranges a range: what is on the low side, what is on the high side, what parts them.
  std::array<uint32_t, 2> halve(uint32_t begin, uint32_t end, Scratch& scratch) {
    const std::span<uint32_t> range(order_.data() + begin, end - begin);
    Halves& best = scratch.best;
    std::vector<Placed>& placed = scratch.placed;
    best.separator = range.size() + 1;
    placed.resize(range.size());
    for (const size_t axis : {size_t{0}, size_t{1}}) {
      for (size_t i = 0; i < range.size(); ++i) placed[i] = {place_[range[i]][axis], range[i]};
      std::nth_element(placed.begin(), placed.begin() + static_cast<std::ptrdiff_t>(range.size() / 2), placed.end());
      for (size_t i = 0; i < range.size(); ++i) range[i] = placed[i].unknown;
      part_halves(range, scratch);
    }
    if (best.separator * best.separator > kLong * range.size()) {
      walk(range);
      part_halves(range, scratch);
    }
    for (const uint32_t u : range) side_[u] = Side::elsewhere;
    std::copy(best.order.begin(), best.order.end(), range.begin());
    return {begin + static_cast<uint32_t>(best.end[0]), begin + static_cast<uint32_t>(best.end[1])};
  }

  /// Keeps what parts the first half of a range from the rest where that is shorter than the best so far.
  void part_halves(std::span<const uint32_t> range, Scratch& scratch) {
    auto& [best, placed, inner, between] = scratch;
    const std::span<const uint32_t> low = range.first(range.size() / 2), high = range.subspan(range.size() / 2);
    for (const uint32_t u : low) side_[u] = Side::low;
    for (const uint32_t u : high) side_[u] = Side::high;
    for (const Side from : {Side::low, Side::high}) {
      const Side to = from == Side::low ? Side::high : Side::low;
      inner.clear();
      between.clear();
      for (const uint32_t u : from == Side::low ? low : high) {
        const std::span<const uint32_t> around = graph_.around(u);
        const bool touches = std::any_of(around.begin(), around.end(), [&](uint32_t w) { return side_[w] == to; });
        (touches ? between : inner).push_back(u);
        if (between.size() >= best.separator) break;
      }
      if (between.size() >= best.separator) continue;
      const std::span<const uint32_t> rest = inner, first = from == Side::low ? rest : low,
                                      second = from == Side::low ? high : rest;
      best.order.assign(first.begin(), first.end());
      best.order.insert(best.order.end(), second.begin(), second.end());
      best.end = {first.size(), best.order.size()};
      best.order.insert(best.order.end(), between.begin(), between.end());
      best.separator = between.size();
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
  std::vector<uint32_t> order_;
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
