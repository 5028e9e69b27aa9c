// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/half_edges.h"

#include <algorithm>
#include <string>
#include <utility>

#include "geocloth/asset/error.h"

namespace geocloth {

std::vector<uint32_t> opposite_half_edges(std::span<const Triangle> triangle) {
  struct Entry {
    uint32_t high, half_edge;
  };
  const auto count = static_cast<uint32_t>(triangle.size() * 3);
  // By the lower vertex in bins, which are small, then by the higher one.
  uint32_t vertices = 0;
  for (const Triangle& t : triangle) vertices = std::max({vertices, t[0] + 1, t[1] + 1, t[2] + 1});
  std::vector<uint32_t> first(size_t{vertices} + 1, 0);
  for (uint32_t h = 0; h < count; ++h) ++first[std::min(tail(triangle, h), head(triangle, h)) + size_t{1}];
  for (size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
  std::vector<Entry> entry(count);
  std::vector<uint32_t> end = first;
  for (uint32_t h = 0; h < count; ++h) {
    const auto [low, high] = std::minmax({tail(triangle, h), head(triangle, h)});
    entry[end[low]++] = {high, h};
  }
  std::vector<uint32_t> opposite(count, kNone);
  for (uint32_t v = 0; v < vertices; ++v) {
    const std::span<Entry> bin(entry.data() + first[v], entry.data() + first[v + 1]);
    std::sort(bin.begin(), bin.end(), [](const Entry& a, const Entry& b) {
      return std::pair(a.high, a.half_edge) < std::pair(b.high, b.half_edge);
    });
    for (size_t i = 0; i + 1 < bin.size(); ++i) {
      if (bin[i].high != bin[i + 1].high) continue;
      const uint32_t a = bin[i].half_edge, b = bin[i + 1].half_edge;
      const bool third = i + 2 < bin.size() && bin[i + 2].high == bin[i].high;
      if (third || tail(triangle, a) == tail(triangle, b)) {
        throw Error(ErrorCode::invalid_data, "the edge of vertices " + std::to_string(tail(triangle, a)) + " and " +
                                                 std::to_string(head(triangle, a)) +
                                                 " is not manifold and oriented; repair the mesh first");
      }
      opposite[a] = b;
      opposite[b] = a;
    }
  }
  return opposite;
}

Components connected_components(std::span<const uint32_t> opposite) {
  Components result;
  result.of_triangle.assign(opposite.size() / 3, kNone);
  std::vector<uint32_t> stack;
  for (uint32_t seed = 0; seed < result.of_triangle.size(); ++seed) {
    if (result.of_triangle[seed] != kNone) continue;
    result.of_triangle[seed] = result.count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const uint32_t t = stack.back();
      stack.pop_back();
      for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        if (opposite[h] == kNone || result.of_triangle[opposite[h] / 3] != kNone) continue;
        result.of_triangle[opposite[h] / 3] = result.count;
        stack.push_back(opposite[h] / 3);
      }
    }
    ++result.count;
  }
  return result;
}

}  // namespace geocloth
