// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

struct RepairOptions {
  /// [m] >= 0: vertices that are no farther apart become one, and vertices that are no farther from an edge become
  /// part of it; but never farther than half of the shortest edge there. 0: only what is at the same place. Not set: a
  /// millionth of the bounding box's diagonal, and a hundred times that in triangle soups.
  std::optional<double> weld_distance;
};

struct RepairResult {
  CleanSurface surface;
  std::vector<Repair> repairs;
  Topology source;   ///< the file's mesh, welded at the tolerance, before any repair
  Topology cleaned;  ///< triangles over `point`: the tied complex that the image has to reproduce
  /// Duplicate faces that have vertices of their own and hang together with what is kept: no back of a double-sided
  /// garment, but a layer of one that is folded flat.
  uint64_t folded_faces = 0;
  /// Points of several vertices that the file has cloth all around of, each by itself, as where folds only touch. They
  /// are tied, and so stay together.
  uint64_t touching_points = 0;
};

/// Welds by position (exact, then within the distance), drops degenerate and duplicate faces, resolves T-junctions
/// (points of a seam whose sides have unlike numbers of them become one within a tenth of the edges there), orients
/// every part, keeps the most coplanar pair joined where an edge has more than two faces and detaches the rest, splits
/// bow-tie vertices; what was detached stays tied through CleanSurface::point. Holes are never closed.
/// @throws Error(invalid_data) when no face is left
[[nodiscard]] RepairResult repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {},
                                       const Progress& progress = {});

/// Edges of the border that lie so near to others of it, beside their lengths, and between triangles that go on from
/// each other, that the garment may be meant to hold together there. A weld distance a little above the widest joins
/// them.
struct Cracks {
  uint32_t edges = 0;     ///< both sides of a crack
  uint32_t of_edges = 0;  ///< of the border
  double widest = 0;      ///< [m] between the ends of two such edges, or an end and the edge beside it
};
[[nodiscard]] Cracks find_cracks(const CleanSurface& surface);

/// Triangles of the surface with vertices replaced by their points: the tied complex.
[[nodiscard]] std::vector<Triangle> point_triangles(const CleanSurface& surface);

}  // namespace geocloth
