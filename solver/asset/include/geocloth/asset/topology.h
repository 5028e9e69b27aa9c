// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace geocloth {

using Triangle = std::array<uint32_t, 3>;  ///< Three vertex indices, counter-clockwise seen from outside.

/// What a triangle complex looks like to a topologist. Vertices are told apart by index only.
struct Topology {
  uint32_t vertices = 0;    ///< Vertices that some triangle uses.
  uint32_t edges = 0;       ///< Distinct unordered vertex pairs.
  uint32_t faces = 0;       ///< Triangles.
  uint32_t components = 0;  ///< Vertex-connected components.
  /// Connected components of the graph of the edges that have exactly one face.
  uint32_t boundary_loops = 0;
  int64_t euler_characteristic = 0;  ///< vertices - edges + faces
  uint32_t non_manifold_edges = 0;   ///< Edges with more than two faces.
  uint32_t bow_tie_vertices = 0;     ///< Vertices without non-manifold edges whose faces form more than one fan.
  uint32_t inconsistent_edges = 0;   ///< Edges with two faces that traverse them in the same direction.
  bool orientable = true;            ///< Faces can be flipped so that no manifold edge is inconsistent.
};

/// Measures a triangle list.
/// @param triangles     indices below vertex_count; a triangle with a repeated index is not allowed
/// @param vertex_count  number of vertices that the indices refer to
/// @throws Error(invalid_argument) if an index is out of range or a triangle is degenerate
[[nodiscard]] Topology measure_topology(std::span<const Triangle> triangles, uint32_t vertex_count);

}  // namespace geocloth
