// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "colliders/closest.h"

namespace geocloth {

/// A triangle among the nodes of a grid, made ready to be measured from many of them.
struct RowTriangle {
  struct Edge {
    Vec3 from, way;     ///< [spacings] from the first corner
    Vec3 out;           ///< across it, away from the triangle
    float inverse = 0;  ///< of its length squared; 0: it has none
  };

  RowTriangle() = default;
  /// @param t      [spacings] from the first node
  /// @param reach  [spacings] it is measured from the nodes that are as near as that to the box around it
  /// @param size   nodes along x, y and z
  RowTriangle(const TriangleCorners& t, double reach, const std::array<uint32_t, 3>& size);

  Vec3d a;
  Vec3d low, high;  ///< [spacings] the box around it
  double reach = 0;
  Vec3 normal;
  std::array<Edge, 3> edges{};
  bool flat = true;                         ///< without an area, as a segment
  std::array<uint32_t, 3> first{}, last{};  ///< nodes along x, y and z that are near: first .. last - 1
};

/// Measures a triangle from the nodes near it of some layers of a grid.
/// @param number   of the triangle
/// @param square   by node, [spacings^2] of the distance to the nearest triangle so far
/// @param nearest  by node, which one that is
void measure_triangle(const RowTriangle& triangle, uint32_t number, const std::array<uint32_t, 3>& size,
                      uint32_t first_layer, uint32_t last_layer, float* square, uint32_t* nearest);

}  // namespace geocloth
