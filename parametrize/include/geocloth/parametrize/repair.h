// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

struct RepairOptions {
  double weld_tolerance = 1e-6;  ///< vertices closer than this share of the bounding-box diagonal become one
};

struct RepairResult {
  CleanSurface surface;
  std::vector<Repair> repairs;
  Topology source;   ///< the file's mesh, welded at the tolerance, before any repair
  Topology cleaned;  ///< triangles over `point`: the tied complex that the image has to reproduce
};

/// Welds by position (exact, then within the tolerance), drops degenerate and duplicate faces, resolves T-junctions,
/// orients every part, keeps the most coplanar pair joined where an edge has more than two faces and detaches the
/// rest, splits bow-tie vertices; what was detached stays tied through CleanSurface::point. Holes are never closed.
/// @throws Error(invalid_data) when no face is left
[[nodiscard]] RepairResult repair_mesh(const TriangleMesh& mesh, const RepairOptions& options = {},
                                       const Progress& progress = {});

/// Triangles of the surface with vertices replaced by their points: the tied complex.
[[nodiscard]] std::vector<Triangle> point_triangles(const CleanSurface& surface);

}  // namespace geocloth
