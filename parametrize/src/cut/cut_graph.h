// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// A set of edges that opens every region of the surface into a disk.
struct CutGraph {
  std::vector<uint32_t> opposite;  ///< per half-edge of the clean surface
  std::vector<char> cut;           ///< per half-edge: its edge is cut (borders are); equal for opposite half-edges
  std::vector<char> fixed;         ///< per half-edge: a border, tied, or asked for: part of the graph from the start
  std::vector<char> node;          ///< per vertex: its point has other vertices, or a sphere's cut ends here
};

/// Edges whose two points are also those of another edge, vertices whose point has others, and `options.extra_edges`
/// are on the graph; the rest is as short as constrained straightening makes it.
[[nodiscard]] CutGraph find_cut_graph(const CleanSurface& surface, const CutOptions& options, const Progress& progress);

/// Vertex numbers after cutting: corners at one vertex stay together as far as they meet across edges that are not cut.
struct OpenedVertices {
  std::vector<Triangle> triangle;
  std::vector<uint32_t> original;  ///< per new vertex; new vertices are numbered by first corner
};
[[nodiscard]] OpenedVertices open_along(std::span<const Triangle> triangle, std::span<const uint32_t> opposite,
                                        std::span<const char> cut);

}  // namespace geocloth
