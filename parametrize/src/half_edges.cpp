// SPDX-License-Identifier: GPL-3.0-or-later
#include "half_edges.h"

#include <algorithm>
#include <string>

#include "geocloth/asset/error.h"

namespace geocloth {

std::vector<uint32_t> opposite_half_edges(std::span<const Triangle> triangle) {
  struct Entry {
    uint64_t key;  // lower vertex, higher vertex
    uint32_t half_edge;
  };
  const auto count = static_cast<uint32_t>(triangle.size() * 3);
  std::vector<Entry> entry(count);
  for (uint32_t h = 0; h < count; ++h) {
    const auto [low, high] = std::minmax({tail(triangle, h), head(triangle, h)});
    entry[h] = {(uint64_t{low} << 32U) | high, h};
  }
  std::sort(entry.begin(), entry.end(),
            [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.half_edge < b.half_edge; });
  std::vector<uint32_t> opposite(count, kNone);
  for (size_t i = 0; i + 1 < entry.size(); ++i) {
    if (entry[i].key != entry[i + 1].key) continue;
    const uint32_t a = entry[i].half_edge, b = entry[i + 1].half_edge;
    const bool third = i + 2 < entry.size() && entry[i + 2].key == entry[i].key;
    if (third || tail(triangle, a) == tail(triangle, b)) {
      throw Error(ErrorCode::invalid_data, "the edge of vertices " + std::to_string(tail(triangle, a)) + " and " +
                                               std::to_string(head(triangle, a)) +
                                               " is not manifold and oriented; repair the mesh first");
    }
    opposite[a] = b;
    opposite[b] = a;
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
