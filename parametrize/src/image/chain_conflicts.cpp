// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a chart is one cell wide, a grid edge may run from outline pixel to outline pixel through its inside; where two
// sides of a cut end come close, one pixel inside may have both as neighbours. Of a cell's two diagonals one can be
// chosen, but where both would repeat an edge none is left.

#include "image/chain_conflicts.h"

#include <algorithm>
#include <array>
#include <set>
#include <tuple>

#include "image/cell_halves.h"

namespace geocloth {
namespace {

constexpr uint32_t kInside = 0xFFFFFFFFU;  // not an outline sample

/// An end of a grid edge: the number of its surface point and which sample of the chart it is.
struct End {
  uint64_t point;
  uint32_t sample;
};

struct Edge {
  std::array<uint64_t, 2> points;   // ascending
  std::array<uint32_t, 2> samples;  // in the order of the points
  uint32_t chart;
  bool inner;
};

/// What stands on the pixels of a chart.
class Points {
 public:
  Points(const PointChain& chain, uint32_t chart) : chain_(chain), chart_(chart) {
    for (uint32_t i = 0; i < chain.pixel.size(); ++i) outline_.push_back({chain.pixel[i], i});
    std::sort(outline_.begin(), outline_.end());
  }
  [[nodiscard]] bool on_outline(const Pixel& p) const { return at(p).sample != kInside; }
  [[nodiscard]] End at(const Pixel& p) const {
    const auto found = std::lower_bound(outline_.begin(), outline_.end(), Entry{p, 0});
    if (found != outline_.end() && found->first == p) return {chain_.point[found->second], found->second};
    // Apart from the points' own numbers, which have 32 bits: chart, row, column.
    const auto row = static_cast<uint64_t>(p[1] + (1 << 19)), column = static_cast<uint64_t>(p[0] + (1 << 19));
    return {(uint64_t{1} << 63U) | (uint64_t{chart_} << 40U) | (row << 20U) | column, kInside};
  }

 private:
  using Entry = std::pair<Pixel, uint32_t>;
  const PointChain& chain_;
  uint32_t chart_;
  std::vector<Entry> outline_;
};

using PointPair = std::array<uint64_t, 2>;

Edge make_edge(End a, End b, uint32_t chart, bool inner) {
  if (b.point < a.point) std::swap(a, b);
  return {{a.point, b.point}, {a.sample, b.sample}, chart, inner};
}

/// A cell beside the outline and its two diagonals.
struct WholeCell {
  Edge falling, rising;
};

void collect_edges(const PointChain& chain, uint32_t chart, std::vector<Edge>& edges, std::vector<WholeCell>& whole) {
  const Points points(chain, chart);
  const auto add = [&](const End& a, const End& b, bool inner) { edges.push_back(make_edge(a, b, chart, inner)); };
  const auto n = static_cast<uint32_t>(chain.pixel.size());
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t next = (i + 1) % n;
    add({chain.point[i], i}, {chain.point[next], next}, false);
  }
  const CellHalves cells(chain.pixel);
  std::vector<Pixel> corner;  // top left, of the whole cells around the outline
  for (const Pixel& p : chain.pixel) {
    const Pixel right{p[0] + 1, p[1]}, down{p[0], p[1] + 1}, left{p[0] - 1, p[1]}, up{p[0], p[1] - 1};
    const End here = points.at(p);
    if (cells.inner_right(p)) add(here, points.at(right), true);
    if (cells.inner_down(p)) add(here, points.at(down), true);
    // From the other side only where the neighbour is not on the outline itself, which adds its own.
    if (cells.inner_right(left) && !points.on_outline(left)) add(here, points.at(left), true);
    if (cells.inner_down(up) && !points.on_outline(up)) add(here, points.at(up), true);
    for (const Pixel& q : {p, left, up, Pixel{p[0] - 1, p[1] - 1}}) {
      if (cells.whole(q)) corner.push_back(q);
    }
  }
  std::sort(corner.begin(), corner.end());
  corner.erase(std::unique(corner.begin(), corner.end()), corner.end());
  for (const Pixel& q : corner) {
    const auto at = [&](int32_t x, int32_t y) { return points.at({q[0] + x, q[1] + y}); };
    whole.push_back({make_edge(at(0, 0), at(1, 1), chart, true), make_edge(at(1, 0), at(0, 1), chart, true)});
  }
}

/// The edges that the image has so far, by their points.
class KnownEdges {
 public:
  /// @param points  ascending
  explicit KnownEdges(std::vector<PointPair> points) : given_(std::move(points)) {}
  [[nodiscard]] bool allow(const Edge& e) const {
    return e.points[0] != e.points[1] && !chosen_.contains(e.points) &&
           !std::binary_search(given_.begin(), given_.end(), e.points);
  }
  void choose(const Edge& e) { chosen_.insert(e.points); }

 private:
  std::vector<PointPair> given_;
  std::set<PointPair> chosen_;
};

/// Cells of which neither diagonal is left once every cell with a single one has taken that.
std::vector<WholeCell> cells_without_diagonal(std::vector<WholeCell> open, KnownEdges known) {
  std::vector<WholeCell> none;
  for (size_t before = open.size() + 1; open.size() < before;) {
    before = open.size();
    std::erase_if(open, [&](const WholeCell& cell) {
      const bool falling = known.allow(cell.falling), rising = known.allow(cell.rising);
      if (falling && rising) return false;
      if (falling) known.choose(cell.falling);
      if (rising) known.choose(cell.rising);
      if (!falling && !rising) none.push_back(cell);
      return true;
    });
  }
  return none;
}

/// From the edges that join one pair of points, of which there should be one: those inside a chart have to go.
void add_conflicts(std::span<const Edge> same, std::vector<ChainConflict>& conflicts) {
  const auto add = [&](uint32_t chart, uint32_t a, uint32_t b, int32_t least) {
    conflicts.push_back({chart, {std::min(a, b), std::max(a, b), least}});
  };
  for (size_t i = 0; i < same.size(); ++i) {
    if (!same[i].inner) continue;
    const auto [a, b] = same[i].samples;
    if (a != kInside && b != kInside) {
      add(same[i].chart, a, b, 2);  // not neighbours
      continue;
    }
    // One pixel inside is the neighbour of several copies of a point.
    for (size_t j = i + 1; j < same.size(); ++j) add(same[i].chart, a, same[j].samples[0], 3);
  }
}

/// What keeps a cell from being split along a diagonal.
/// @param edges  all edges, ascending by their points
void add_diagonal_conflicts(const Edge& diagonal, const std::vector<Edge>& edges,
                            std::vector<ChainConflict>& conflicts) {
  const auto add = [&](uint32_t a, uint32_t b, int32_t least) {
    conflicts.push_back({diagonal.chart, {std::min(a, b), std::max(a, b), least}});
  };
  const auto [a, b] = diagonal.samples;
  if (a != kInside && b != kInside) {
    add(a, b, 3);  // not in one cell
    return;
  }
  // The pixel inside has another copy of the point as its neighbour.
  const auto by_points = [](const Edge& x, const Edge& y) { return x.points < y.points; };
  const auto [first, last] = std::equal_range(edges.begin(), edges.end(), diagonal, by_points);
  for (auto e = first; e != last; ++e) {
    if (e->samples[0] != a) add(a, e->samples[0], 4);
  }
}

}  // namespace

std::vector<ChainConflict> chain_conflicts(std::span<const PointChain> charts) {
  std::vector<Edge> edges;
  std::vector<WholeCell> cells;
  for (uint32_t c = 0; c < charts.size(); ++c) collect_edges(charts[c], c, edges, cells);
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.points, a.chart, a.samples) < std::tie(b.points, b.chart, b.samples);
  });
  std::vector<ChainConflict> conflicts;
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].points == edges[begin].points) ++end;
    const bool repeated = end - begin > 1 || edges[begin].points[0] == edges[begin].points[1];
    if (repeated) add_conflicts(std::span(edges).subspan(begin, end - begin), conflicts);
  }
  std::vector<PointPair> points;
  points.reserve(edges.size());
  for (const Edge& e : edges) points.push_back(e.points);
  for (const WholeCell& cell : cells_without_diagonal(std::move(cells), KnownEdges(std::move(points)))) {
    for (const Edge& diagonal : {cell.falling, cell.rising}) add_diagonal_conflicts(diagonal, edges, conflicts);
  }
  std::sort(conflicts.begin(), conflicts.end());
  conflicts.erase(std::unique(conflicts.begin(), conflicts.end()), conflicts.end());
  return conflicts;
}

}  // namespace geocloth
