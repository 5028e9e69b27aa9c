// SPDX-License-Identifier: GPL-3.0-or-later
//
// A free border may come to lie over itself though no triangle is flipped: a chart is laid out well only if its outline
// is a simple polygon. Crossings are looked for in the cells of a grid, with exact predicates.

#include "develop/chart_overlap.h"

#include <algorithm>
#include <cmath>

#include "cut/edge_wishes.h"
#include "mesh/point_math.h"
#include "mesh/predicates.h"

namespace geocloth {
std::optional<std::array<size_t, 2>> crossing_edges(const Chart& c, const std::vector<uint32_t>& loop) {
  const size_t n = loop.size();
  double low_x = kInfinity, low_y = kInfinity, high_x = -kInfinity, high_y = -kInfinity, length = 0;
  for (size_t i = 0; i < n; ++i) {
    const Point2& a = c.uv[loop[i]];
    const Point2& b = c.uv[loop[(i + 1) % n]];
    low_x = std::min(low_x, a[0]);
    low_y = std::min(low_y, a[1]);
    high_x = std::max(high_x, a[0]);
    high_y = std::max(high_y, a[1]);
    length += std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  const double cell = std::max(length / static_cast<double>(n), 1e-3 * std::max(high_x - low_x, high_y - low_y));
  const auto column = [&](double x) { return static_cast<int64_t>((x - low_x) / cell); };
  const auto row = [&](double y) { return static_cast<int64_t>((y - low_y) / cell); };
  const int64_t columns = column(high_x) + 1;
  std::vector<std::pair<int64_t, size_t>> entry;  // cell, edge
  for (size_t i = 0; i < n; ++i) {
    const Point2& a = c.uv[loop[i]];
    const Point2& b = c.uv[loop[(i + 1) % n]];
    for (int64_t y = row(std::min(a[1], b[1])); y <= row(std::max(a[1], b[1])); ++y) {
      for (int64_t x = column(std::min(a[0], b[0])); x <= column(std::max(a[0], b[0])); ++x) {
        entry.emplace_back(y * columns + x, i);
      }
    }
  }
  std::sort(entry.begin(), entry.end());
  std::optional<std::array<size_t, 2>> best;
  for (size_t begin = 0, end = 0; begin < entry.size(); begin = end) {
    while (end < entry.size() && entry[end].first == entry[begin].first) ++end;
    for (size_t p = begin; p < end; ++p) {
      for (size_t q = p + 1; q < end; ++q) {
        const size_t i = entry[p].second, j = entry[q].second;
        if (j == i + 1 || (i == 0 && j == n - 1)) continue;
        const Point2 &a = c.uv[loop[i]], &b = c.uv[loop[i + 1]], &d = c.uv[loop[j]], &e = c.uv[loop[(j + 1) % n]];
        if (orientation(a, b, d) * orientation(a, b, e) < 0 && orientation(d, e, a) * orientation(d, e, b) < 0) {
          if (!best || std::array{i, j} < *best) best = {i, j};
        }
      }
    }
  }
  return best;
}

std::vector<uint32_t> parting_path(const Chart& c, const std::vector<uint32_t>& loop, std::array<size_t, 2> crossing) {
  const size_t n = loop.size();
  const size_t first = crossing[1] - crossing[0];
  const auto middle = [&](size_t begin, size_t count, size_t share) {
    // The middle part of a stretch of the outline, at least one vertex.
    std::vector<uint32_t> vertices;
    const size_t margin = count / share;
    for (size_t k = 1 + margin; k + margin <= count; ++k) vertices.push_back(loop[(begin + k) % n]);
    if (vertices.empty()) vertices.push_back(loop[(begin + (count + 1) / 2) % n]);
    return vertices;
  };
  const std::vector<uint8_t> closed = on_outline(c);
  // Prefer a path between the middles; a thin neck may leave none, then any two vertices of the stretches will do.
  for (const size_t share : {size_t{3}, size_t{6}, n + 1}) {
    const std::vector<uint32_t> from = middle(crossing[0], first, share);
    const std::vector<uint32_t> to = middle(crossing[1], n - first, share);
    const Distances d = distances(c, from, closed, {kCreaseDiscount});
    uint32_t best = kNone;
    for (const uint32_t v : to) {
      if (std::isfinite(d.value[v]) && d.from[v] != kNone && (best == kNone || d.value[v] < d.value[best])) best = v;
    }
    if (best != kNone) return d.path_from(best);
  }
  return {};
}

}  // namespace geocloth
