// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// An order in which to eliminate the unknowns of a mesh with little fill: a tree of separators.
struct Dissection {
  /// The unknowns of a separator, or of a piece too small to part, and all that hangs below it.
  struct Node {
    uint32_t begin = 0, end = 0;  ///< its unknowns: these places of `order`
    uint32_t parent = 0;          ///< kNone at a root
  };
  std::vector<Node> node;       ///< children before parents
  std::vector<uint32_t> order;  ///< unknowns as they are eliminated; those of each node, in its turn
};

/// @param unknown  per vertex: its number, negative when it is none
/// @param place    per vertex, in the plane: neighbours should lie near each other; nothing else depends on it
[[nodiscard]] Dissection dissect(std::span<const Triangle> triangle, std::span<const int32_t> unknown,
                                 std::span<const Point2> place);

/// Places for dissect() where none are known: how many edges a vertex is away from places far from each other.
[[nodiscard]] std::vector<Point2> places_by_edges(std::span<const Triangle> triangle, size_t vertex_count);

}  // namespace geocloth
