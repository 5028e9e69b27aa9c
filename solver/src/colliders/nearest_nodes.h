// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "colliders/closest.h"
#include "colliders/node_grid.h"

namespace geocloth {

/// For each node of a grid the nearest of some triangles.
/// @param triangles  [m] at least one
/// @param inside     by node; these are measured anyhow
/// @param band       [spacings] nodes outside farther away than this and a node are kNoTriangle
/// The nearest of all as far as sqrt(3) spacings, so at all nodes of cells that the surface goes through; beyond that
/// one that is at most a fifth of a spacing farther away.
[[nodiscard]] std::vector<uint32_t> nearest_triangles(const NodeGrid& grid, std::span<const TriangleCorners> triangles,
                                                      const std::vector<char>& inside, double band);
inline constexpr uint32_t kNoTriangle = 0xFFFFFFFF;

}  // namespace geocloth
