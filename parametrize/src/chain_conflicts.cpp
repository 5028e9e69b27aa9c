// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a chart is one cell wide, a grid edge may run from outline pixel to outline pixel through its inside; where two
// sides of a cut end come close, one pixel inside may have both as neighbours. Only edges along rows and columns count:
// a cell's diagonal can be chosen.

#include "chain_conflicts.h"

#include <algorithm>
#include <array>

namespace geocloth {
namespace {

/// The cells of a chart's rectangle, each as a left and a right half (apart only where the chain crosses it).
class CellHalves {
 public:
  explicit CellHalves(const std::vector<Pixel>& chain) {
    low_ = high_ = chain.front();
    for (const Pixel& p : chain) {
      low_ = {std::min(low_[0], p[0]), std::min(low_[1], p[1])};
      high_ = {std::max(high_[0], p[0]), std::max(high_[1], p[1])};
    }
    width_ = high_[0] - low_[0];
    cell_.assign(static_cast<size_t>(width_) * static_cast<size_t>(high_[1] - low_[1]), Cell{});
    std::vector<std::vector<int32_t>> crossing(static_cast<size_t>(high_[1] - low_[1]));  // [half pixels]
    for (size_t i = 0; i < chain.size(); ++i) {
      const Pixel &a = chain[i], &b = chain[(i + 1) % chain.size()];
      if (a[1] == b[1]) continue;
      const int32_t row = std::min(a[1], b[1]) - low_[1];
      crossing[static_cast<size_t>(row)].push_back(a[0] + b[0] - 2 * low_[0]);
      if (a[0] == b[0]) continue;
      const bool falls_right = (b[0] > a[0]) == (b[1] > a[1]);
      at(std::min(a[0], b[0]) - low_[0], row).diagonal = falls_right ? Diagonal::right : Diagonal::left;
    }
    for (int32_t y = 0; y < high_[1] - low_[1]; ++y) fill_row(crossing[static_cast<size_t>(y)], y);
  }

  [[nodiscard]] const Pixel& low() const { return low_; }
  [[nodiscard]] const Pixel& high() const { return high_; }

  /// Is there surface on both sides of the edge from p to the right, or downwards?
  [[nodiscard]] bool inner_right(const Pixel& p) const {
    const Cell below = get(p[0], p[1]), above = get(p[0], p[1] - 1);
    return (below.diagonal == Diagonal::right ? below.right : below.left) &&
           (above.diagonal == Diagonal::left ? above.right : above.left);
  }
  [[nodiscard]] bool inner_down(const Pixel& p) const { return get(p[0], p[1]).left && get(p[0] - 1, p[1]).right; }

 private:
  enum class Diagonal : uint8_t { none, right, left };
  struct Cell {
    bool left = false, right = false;
    Diagonal diagonal = Diagonal::none;
  };

  Cell& at(int32_t x, int32_t y) { return cell_[static_cast<size_t>(y * width_ + x)]; }
  [[nodiscard]] Cell get(int32_t x, int32_t y) const {
    if (x < low_[0] || y < low_[1] || x >= high_[0] || y >= high_[1]) return {};
    return cell_[static_cast<size_t>((y - low_[1]) * width_ + x - low_[0])];
  }

  void fill_row(std::vector<int32_t>& crossing, int32_t y) {
    std::sort(crossing.begin(), crossing.end());
    for (size_t k = 0; k + 1 < crossing.size(); k += 2) {
      // Left half: between 2 x and 2 x + 1; right half: between 2 x + 1 and 2 x + 2.
      for (int32_t half = crossing[k]; half < crossing[k + 1]; ++half) {
        Cell& cell = at(half / 2, y);
        (half % 2 == 0 ? cell.left : cell.right) = true;
      }
    }
  }

  Pixel low_{}, high_{};
  int32_t width_ = 0;
  std::vector<Cell> cell_;
};

struct Edge {
  std::array<uint64_t, 2> ends;
  size_t chart;
  bool inner;
};

/// Numbers of surface points: those of outline pixels, and one for every other pixel.
class Points {
 public:
  Points(const PointChain& chain, size_t chart) : chart_(chart) {
    for (size_t i = 0; i < chain.pixel.size(); ++i) outline_.push_back({chain.pixel[i], chain.point[i]});
    std::sort(outline_.begin(), outline_.end());
  }
  [[nodiscard]] bool on_outline(const Pixel& p) const { return find(p) != outline_.end(); }
  [[nodiscard]] uint64_t of(const Pixel& p) const {
    const auto found = find(p);
    if (found != outline_.end()) return found->second;
    // Apart from the points' own numbers, which have 32 bits: chart, row, column.
    const auto row = static_cast<uint64_t>(p[1] + (1 << 19)), column = static_cast<uint64_t>(p[0] + (1 << 19));
    return (uint64_t{1} << 63U) | (uint64_t{chart_} << 40U) | (row << 20U) | column;
  }

 private:
  using Entry = std::pair<Pixel, uint32_t>;
  [[nodiscard]] std::vector<Entry>::const_iterator find(const Pixel& p) const {
    const auto found = std::lower_bound(outline_.begin(), outline_.end(), Entry{p, 0});
    return found != outline_.end() && found->first == p ? found : outline_.end();
  }
  size_t chart_;
  std::vector<Entry> outline_;
};

void collect_edges(const PointChain& chain, size_t chart, std::vector<Edge>& edges) {
  const Points points(chain, chart);
  const auto add = [&](uint64_t a, uint64_t b, bool inner) {
    edges.push_back({{std::min(a, b), std::max(a, b)}, chart, inner});
  };
  const size_t n = chain.pixel.size();
  for (size_t i = 0; i < n; ++i) add(chain.point[i], chain.point[(i + 1) % n], false);
  const CellHalves cells(chain.pixel);
  for (const Pixel& p : chain.pixel) {
    const Pixel right{p[0] + 1, p[1]}, down{p[0], p[1] + 1}, left{p[0] - 1, p[1]}, up{p[0], p[1] - 1};
    if (cells.inner_right(p)) add(points.of(p), points.of(right), true);
    if (cells.inner_down(p)) add(points.of(p), points.of(down), true);
    // From the other side only where the neighbour is not on the outline itself, which adds its own.
    if (cells.inner_right(left) && !points.on_outline(left)) add(points.of(p), points.of(left), true);
    if (cells.inner_down(up) && !points.on_outline(up)) add(points.of(p), points.of(up), true);
  }
}

}  // namespace

std::vector<size_t> conflicting_charts(std::span<const PointChain> charts) {
  std::vector<Edge> edges;
  for (size_t c = 0; c < charts.size(); ++c) collect_edges(charts[c], c, edges);
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.ends != b.ends ? a.ends < b.ends : (a.chart != b.chart ? a.chart < b.chart : a.inner < b.inner);
  });
  std::vector<size_t> result;
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    while (end < edges.size() && edges[end].ends == edges[begin].ends) ++end;
    const bool repeated = end - begin > 1 || edges[begin].ends[0] == edges[begin].ends[1];
    for (size_t i = begin; repeated && i < end; ++i) {
      if (edges[i].inner) result.push_back(edges[i].chart);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

}  // namespace geocloth
