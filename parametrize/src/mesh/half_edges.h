// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

// Half-edges of an oriented manifold triangle list, by number: half-edge 3 t + i runs from corner i of triangle t to
// its next corner, and stands for that corner as well.

namespace geocloth {

[[nodiscard]] inline uint32_t next_half_edge(uint32_t h) {
  return h % 3 == 2 ? h - 2 : h + 1;
}
[[nodiscard]] inline uint32_t previous_half_edge(uint32_t h) {
  return h % 3 == 0 ? h + 2 : h - 1;
}
[[nodiscard]] inline uint32_t tail(std::span<const Triangle> triangle, uint32_t h) {
  return triangle[h / 3][h % 3];
}
[[nodiscard]] inline uint32_t head(std::span<const Triangle> triangle, uint32_t h) {
  return tail(triangle, next_half_edge(h));
}

/// Per half-edge the opposite one, kNone on a border.
/// @throws Error(invalid_data) if an edge has more than two triangles or two that disagree in orientation
[[nodiscard]] std::vector<uint32_t> opposite_half_edges(std::span<const Triangle> triangle);

/// Per triangle the number of its edge-connected component, numbered by first triangle.
struct Components {
  std::vector<uint32_t> of_triangle;
  uint32_t count = 0;
};
[[nodiscard]] Components connected_components(std::span<const uint32_t> opposite);

}  // namespace geocloth
