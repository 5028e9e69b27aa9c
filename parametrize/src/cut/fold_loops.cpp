// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is left of the sharply folded edges when lines that end within the surface are taken away, end by end. A tailor
// cuts two pieces where the mesh has such a line all round: they lie flat each for itself, however the line is bent.
#include "cut/fold_loops.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "cut/edge_wishes.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kSharp = 1;        // [rad] from which an edge is folded sharply
constexpr double kLeastLength = 1;  // of connected lines, by the root of their part's area: less is no layer
constexpr double kMostLength = 9;   // of all lines of a part, likewise: more of them are pleats

class FoldLines {
 public:
  /// @param is_left_out  per component
  FoldLines(const CleanSurface& surface, const std::vector<bool>& is_left_out)
      : surface_(surface),
        opposite_(opposite_half_edges(surface.triangle)),
        on_line_(opposite_.size(), 0),
        at_(surface.position.size()),
        is_on_border_(surface.position.size(), 0) {
    const std::vector<Triangle>& triangle = surface.triangle;
    for (uint32_t h = 0; h < opposite_.size(); ++h) {
      const uint32_t o = opposite_[h];
      if (o == kNone) is_on_border_[tail(triangle, h)] = is_on_border_[head(triangle, h)] = 1;
      if (o == kNone || o < h || is_left_out[surface.component[h / 3]]) continue;
      if (fold_between(surface.position, triangle[h / 3], triangle[o / 3]) < kSharp) continue;
      on_line_[h] = 1;
      at_[tail(triangle, h)].push_back(h);
      at_[head(triangle, h)].push_back(h);
    }
  }

  void take_away_dead_ends() {
    std::vector<uint32_t> ends(at_.size());
    std::iota(ends.begin(), ends.end(), 0U);
    while (!ends.empty()) {
      const uint32_t v = ends.back();
      ends.pop_back();
      if (is_on_border_[v] || at_[v].size() != 1) continue;
      const uint32_t h = at_[v].front();
      on_line_[h] = 0;
      for (const uint32_t end : {tail(surface_.triangle, h), head(surface_.triangle, h)}) {
        std::erase(at_[end], h);
        ends.push_back(end);
      }
    }
  }

  /// Takes away connected lines that are short beside their part.
  /// @param size  per component: the root of its area [m]
  void take_away_short_ones(const std::vector<double>& size) {
    std::vector<char> is_met(on_line_.size(), 0);
    for (uint32_t start = 0; start < on_line_.size(); ++start) {
      if (!on_line_[start] || is_met[start]) continue;
      std::vector<uint32_t> line{start};
      is_met[start] = 1;
      double sum = 0;
      for (size_t i = 0; i < line.size(); ++i) {
        sum += edge_length(line[i]);
        for (const uint32_t v : {tail(surface_.triangle, line[i]), head(surface_.triangle, line[i])}) {
          for (const uint32_t next : at_[v]) {
            if (!is_met[next]) line.push_back(next);
            is_met[next] = 1;
          }
        }
      }
      if (sum >= kLeastLength * size[surface_.component[start / 3]]) continue;
      for (const uint32_t h : line) on_line_[h] = 0;
    }
  }

  void take_away_pleats(const std::vector<double>& size) {
    std::vector<double> sum(size.size(), 0);
    for (uint32_t h = 0; h < on_line_.size(); ++h) {
      if (on_line_[h]) sum[surface_.component[h / 3]] += edge_length(h);
    }
    for (uint32_t h = 0; h < on_line_.size(); ++h) {
      const uint32_t c = surface_.component[h / 3];
      if (sum[c] > kMostLength * size[c]) on_line_[h] = 0;
    }
  }

  [[nodiscard]] std::vector<std::array<uint32_t, 2>> edges() const {
    std::vector<std::array<uint32_t, 2>> result;
    for (uint32_t h = 0; h < on_line_.size(); ++h) {
      const auto [low, high] = std::minmax({tail(surface_.triangle, h), head(surface_.triangle, h)});
      if (on_line_[h]) result.push_back({low, high});
    }
    std::sort(result.begin(), result.end());
    return result;
  }

 private:
  [[nodiscard]] double edge_length(uint32_t h) const {
    return distance(surface_.position[tail(surface_.triangle, h)], surface_.position[head(surface_.triangle, h)]);
  }

  const CleanSurface& surface_;
  const std::vector<uint32_t> opposite_;
  std::vector<char> on_line_;              // per half-edge, of one of each two
  std::vector<std::vector<uint32_t>> at_;  // per vertex: those half-edges
  std::vector<char> is_on_border_;         // per vertex
};

}  // namespace

std::vector<std::array<uint32_t, 2>> fold_loops(const CleanSurface& surface, size_t most_triangles) {
  std::vector<double> size(surface.component_count, 0);
  std::vector<size_t> triangles(surface.component_count, 0);
  for (size_t t = 0; t < surface.triangle.size(); ++t) {
    const auto& [a, b, c] = surface.triangle[t];
    size[surface.component[t]] += triangle_area(surface.position[a], surface.position[b], surface.position[c]);
    ++triangles[surface.component[t]];
  }
  for (double& s : size) s = std::sqrt(s);
  std::vector<bool> is_large(triangles.size());
  std::transform(triangles.begin(), triangles.end(), is_large.begin(), [&](size_t n) { return n > most_triangles; });
  FoldLines lines(surface, is_large);
  lines.take_away_dead_ends();
  lines.take_away_short_ones(size);
  lines.take_away_pleats(size);
  return lines.edges();
}

}  // namespace geocloth
