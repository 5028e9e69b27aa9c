// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "colliders/closest.h"
#include "colliders/node_grid.h"

namespace geocloth {

inline constexpr uint32_t kNoTriangle = 0xFFFFFFFF;

/// The surface that is nearest to each node of a grid.
struct NearestPoints {
  std::vector<uint32_t> triangle;  ///< by node; kNoTriangle: not known
  std::vector<Vec3> off;           ///< by node, [spacings] from it to the nearest point of its triangle, where known
};

/// Finds for each node of a grid the nearest of some triangles, and the point of it.
/// @param triangles  [m] at least one
/// @param inside     by node; these are measured anyhow
/// @param band       [spacings] nodes outside farther away than this and a node are not known
/// The nearest of all as far as sqrt(3) spacings, so at all nodes of cells that the surface goes through; beyond that
/// one that is at most a fifth of a spacing farther away.
[[nodiscard]] NearestPoints nearest_points(const NodeGrid& grid, std::span<const TriangleCorners> triangles,
                                           const std::vector<char>& inside, double band);

}  // namespace geocloth
