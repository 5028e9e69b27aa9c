// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"
#include "geocloth/parametrize/mirror.h"

namespace geocloth {

/// The clean surface cut open: every component is a topological disk (one boundary loop, Euler characteristic 1).
/// Cuts run straight across the faces; triangles and edges that they cross are split.
/// Copies of a vertex along a cut have equal `point`; so do the copies that repair tied.
/// Every interior vertex has a point of its own, and no interior edge joins the two points of an outline edge.
struct CutSurface {
  std::vector<Point3> position;    ///< per vertex [m]; copies are bit-identical
  std::vector<Triangle> triangle;  ///< the first ones in the order of CleanSurface::triangle, then parts split off
  std::vector<uint32_t> point;     ///< per vertex
  uint32_t point_count = 0;
  std::vector<uint32_t> clean_vertex;    ///< per vertex: the vertex of the clean surface it is a copy of; kNone where a
                                         ///< cut runs across an edge
  std::vector<uint32_t> clean_triangle;  ///< per triangle: the triangle of the clean surface it is part of
  std::vector<uint32_t> component;       ///< per triangle, 0..component_count-1
  uint32_t component_count = 0;
  /// Per triangle: the hole in the cloth that it fills, kNone for cloth. Empty: all is cloth.
  std::vector<uint32_t> hole{};
};

/// Where cuts would rather run: they may be longer there.
struct CutPreferences {
  bool creases = false;                        ///< where the surface is folded
  std::vector<std::array<uint32_t, 2>> seams;  ///< clean-surface edges (vertex pairs) where the garment's own are
  std::optional<MirrorPlane> mirror;           ///< along this plane, and where the mirror images of other cuts are
  /// Clean-surface edges where two layers of cloth meet (sorted vertex pairs in ascending order): seams show least
  /// there.
  std::vector<std::array<uint32_t, 2>> folds{};
};

struct CutOptions {
  /// Further clean-surface edges (vertex pairs) to cut, beyond what topology needs; used by cut extension.
  std::vector<std::array<uint32_t, 2>> extra_edges;
  CutPreferences prefer{};
};

/// Finds, for every component, a cut graph that joins all boundary loops, opens every handle and passes through every
/// tie (edges and vertices whose points occur more than once), straightens its paths (constrained shortest paths
/// between cut nodes, first along edges, then across the faces) and cuts the surface along it. A closed sphere is cut
/// along a path between far vertices.
/// Gu, Gortler, Hoppe 2002, section 3; straightening ibid.
[[nodiscard]] CutSurface cut_to_disks(const CleanSurface& surface, const CutOptions& options = {},
                                      const Progress& progress = {});

/// One maximal run of outline edges between cut nodes, in the direction of the outline (counter-clockwise).
/// All runs over the same points (mates: the other side of a cut, a tied sheet) have the same `seam`.
struct OutlinePath {
  uint32_t seam = 0;             ///< seam number; free borders have one of their own
  bool reversed = false;         ///< this run goes against the seam's own direction
  std::vector<uint32_t> vertex;  ///< cut-surface vertices from node to node (first == last for a closed loop)
  double length = 0;             ///< [m]
};

/// The outline of one component, its paths in counter-clockwise order; consecutive paths share their end vertex.
struct Outline {
  std::vector<OutlinePath> path;
};

/// Splits every component's outline at the cut nodes: points where an outline edge's multiplicity or the number of
/// outline edges around the point (counted once per seam) changes, cut ends, and bow ties. A closed loop without a
/// node gets one. Deterministic.
[[nodiscard]] std::vector<Outline> trace_outlines(const CutSurface& surface);

}  // namespace geocloth
