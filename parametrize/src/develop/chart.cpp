// SPDX-License-Identifier: GPL-3.0-or-later
#include "develop/chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>

#include "cut/cut_graph.h"
#include "cut/edge_wishes.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
Chart extract_chart(const CutSurface& cut, std::vector<uint32_t> triangles) {
  Chart c;
  c.global_triangle = std::move(triangles);
  std::vector<std::pair<uint32_t, uint32_t>> corner;
  for (uint32_t i = 0; i < c.global_triangle.size(); ++i) {
    for (uint32_t k = 0; k < 3; ++k) corner.emplace_back(cut.triangle[c.global_triangle[i]][k], 3 * i + k);
  }
  std::sort(corner.begin(), corner.end());
  c.triangle.resize(c.global_triangle.size());
  for (const auto& [v, h] : corner) {
    if (c.cut_vertex.empty() || c.cut_vertex.back() != v) {
      c.cut_vertex.push_back(v);
      c.position.push_back(cut.position[v]);
    }
    c.triangle[h / 3][h % 3] = static_cast<uint32_t>(c.cut_vertex.size() - 1);
  }
  c.opposite = opposite_half_edges(c.triangle);
  if (!cut.hole.empty()) {
    for (const uint32_t t : c.global_triangle) c.hole.push_back(cut.hole[t]);
  }
  return c;
}

std::vector<std::vector<uint32_t>> triangles_of_components(const CutSurface& cut) {
  std::vector<std::vector<uint32_t>> triangles(cut.component_count);
  for (uint32_t t = 0; t < cut.triangle.size(); ++t) triangles[cut.component[t]].push_back(t);
  return triangles;
}

double total_area(const Chart& c) {
  double area = 0;
  for (size_t i = 0; i < c.triangle.size(); ++i) {
    const Triangle& t = c.triangle[i];
    if (c.is_cloth(i)) area += triangle_area(c.position[t[0]], c.position[t[1]], c.position[t[2]]);
  }
  return area;
}

std::vector<uint32_t> outline_loop(const Chart& c) {
  std::vector<uint32_t> next(c.position.size(), kNone);
  uint32_t first = kNone;
  for (uint32_t h = 0; h < c.opposite.size(); ++h) {
    if (c.opposite[h] != kNone) continue;
    next[tail(c.triangle, h)] = head(c.triangle, h);
    if (first == kNone) first = tail(c.triangle, h);
  }
  std::vector<uint32_t> loop;
  for (uint32_t v = first; loop.empty() || v != first; v = next[v]) loop.push_back(v);
  return loop;
}

std::vector<std::vector<ChartNeighbour>> neighbours(const Chart& c, const EdgeWishes& wishes) {
  const auto saved = [&](uint32_t h) {
    double share = 0;
    if (wishes.crease > 0) {
      share = wishes.crease * crease_between(c.position, c.triangle[h / 3], c.triangle[c.opposite[h] / 3]);
    }
    if (!wishes.discount.empty()) share = std::max(share, wishes.discount[3 * c.global_triangle[h / 3] + h % 3]);
    return share;
  };
  std::vector<std::vector<ChartNeighbour>> result(c.position.size());
  for (uint32_t h = 0; h < c.opposite.size(); ++h) {
    const bool outline = c.opposite[h] == kNone;
    if (!outline && c.opposite[h] < h) continue;
    const uint32_t a = tail(c.triangle, h), b = head(c.triangle, h);
    double l = distance(c.position[a], c.position[b]);
    if (!outline) l *= 1 - saved(h);
    result[a].push_back({b, l, outline});
    result[b].push_back({a, l, outline});
  }
  return result;
}

std::vector<uint32_t> Distances::path_from(uint32_t vertex) const {
  std::vector<uint32_t> path{vertex};
  while (from[path.back()] != kNone) path.push_back(from[path.back()]);
  return path;
}

Distances distances(const Chart& c, const std::vector<uint32_t>& sources, const std::vector<uint8_t>& closed,
                    const EdgeWishes& wishes) {
  const auto around = neighbours(c, wishes);
  Distances d{std::vector<double>(c.position.size(), kInfinity), std::vector<uint32_t>(c.position.size(), kNone)};
  using Entry = std::pair<double, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const uint32_t v : sources) {
    d.value[v] = 0;
    queue.emplace(0.0, v);
  }
  while (!queue.empty()) {
    const auto [value, v] = queue.top();
    queue.pop();
    if (value > d.value[v] || (value > 0 && closed[v] != 0)) continue;
    for (const auto& [w, l, outline] : around[v]) {
      if (outline || value + l >= d.value[w]) continue;
      d.value[w] = value + l;
      d.from[w] = v;
      queue.emplace(d.value[w], w);
    }
  }
  return d;
}

std::vector<uint8_t> on_outline(const Chart& c) {
  std::vector<uint8_t> result(c.position.size(), 0);
  for (const uint32_t v : outline_loop(c)) result[v] = 1;
  return result;
}

double path_length(const Chart& c, const std::vector<uint32_t>& path) {
  double sum = 0;
  for (size_t i = 1; i < path.size(); ++i) sum += distance(c.position[path[i - 1]], c.position[path[i]]);
  return sum;
}

Chart opened(const Chart& c, const std::vector<uint32_t>& path) {
  return opened(c, std::span(&path, 1));
}

Chart opened(const Chart& c, std::span<const std::vector<uint32_t>> paths) {
  std::vector<char> cut(c.opposite.size(), 0);
  for (uint32_t h = 0; h < c.opposite.size(); ++h) cut[h] = c.opposite[h] == kNone ? 1 : 0;
  for (const std::vector<uint32_t>& path : paths) {
    std::vector<uint32_t> place(c.position.size(), kNone);
    for (uint32_t i = 0; i < path.size(); ++i) place[path[i]] = i;
    for (uint32_t h = 0; h < c.opposite.size(); ++h) {
      const uint32_t a = place[tail(c.triangle, h)], b = place[head(c.triangle, h)];
      if (a != kNone && b != kNone && (a + 1 == b || b + 1 == a)) cut[h] = 1;
    }
  }
  OpenedVertices o = open_along(c.triangle, c.opposite, cut);
  Chart result;
  result.triangle = std::move(o.triangle);
  result.global_triangle = c.global_triangle;
  result.hole = c.hole;
  result.opposite = opposite_half_edges(result.triangle);
  for (const uint32_t v : o.original) {
    result.position.push_back(c.position[v]);
    result.cut_vertex.push_back(c.cut_vertex[v]);
    if (!c.uv.empty()) result.uv.push_back(c.uv[v]);
  }
  return result;
}

std::vector<Chart> separated(const Chart& c) {
  const Components components = connected_components(c.opposite);
  std::vector<Chart> pieces(components.count);
  std::vector<uint32_t> number(c.position.size(), kNone);
  for (uint32_t t = 0; t < c.triangle.size(); ++t) {
    Chart& piece = pieces[components.of_triangle[t]];
    Triangle corners{};
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t v = c.triangle[t][k];
      if (number[v] == kNone) {
        number[v] = static_cast<uint32_t>(piece.position.size());
        piece.position.push_back(c.position[v]);
        piece.cut_vertex.push_back(c.cut_vertex[v]);
        if (!c.uv.empty()) piece.uv.push_back(c.uv[v]);
      }
      corners[k] = number[v];
    }
    piece.triangle.push_back(corners);
    piece.global_triangle.push_back(c.global_triangle[t]);
    if (!c.hole.empty()) piece.hole.push_back(c.hole[t]);
  }
  for (Chart& piece : pieces) piece.opposite = opposite_half_edges(piece.triangle);
  return pieces;
}

std::vector<std::vector<uint32_t>> rim_loops(const Chart& c) {
  std::vector<std::vector<uint32_t>> loops;
  std::map<std::array<uint32_t, 2>, uint32_t> next;  // by hole and vertex
  for (uint32_t h = 0; h < c.opposite.size(); ++h) {
    if (c.is_cloth(h / 3) || c.opposite[h] == kNone || c.hole[c.opposite[h] / 3] == c.hole[h / 3]) continue;
    next[{c.hole[h / 3], tail(c.triangle, h)}] = head(c.triangle, h);
  }
  while (!next.empty()) {
    std::vector<uint32_t>& loop = loops.emplace_back();
    for (auto edge = next.begin(); edge != next.end();) {
      const uint32_t hole = edge->first[0], head = edge->second;
      loop.push_back(edge->first[1]);
      next.erase(edge);
      edge = next.find({hole, head});
    }
  }
  return loops;
}

double outline_length(const Chart& c) {
  const std::vector<uint32_t> loop = outline_loop(c);
  double sum = 0;
  for (size_t i = 0; i < loop.size(); ++i)
    sum += distance(c.position[loop[i]], c.position[loop[(i + 1) % loop.size()]]);
  return sum;
}

}  // namespace geocloth
