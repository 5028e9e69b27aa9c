// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "mesh/refined_mesh.h"

namespace geocloth {

/// Edges of a mesh along which it is opened. All lists grow with the mesh.
struct CutLines {
  std::vector<char> cut;          ///< per half-edge: its edge is cut; equal for opposite half-edges, set on borders
  std::vector<char> fixed;        ///< per half-edge: a cut edge that stays where it is; set on borders
  std::vector<char> node;         ///< per vertex: a path ends here whatever its number of cut edges
  std::vector<uint32_t> rings{};  ///< per vertex: how many vertices away from it a path through it may go; kNone: any.
                                  ///< Empty: all may go anywhere
};

/// Lets every path of cut edges between two nodes run as straight across the faces as the surface allows: serrated
/// seams are longer than they need be, and so are the outlines that pixels have to follow. The ends stay. Vertices are
/// inserted where a path crosses an edge; a path that passes close by a vertex goes through it. Whatever the cuts
/// opened into disks stays disks.
/// @param mesh  needs `leaving` only for its borders; its half-edges are renumbered, its vertices and the first
///   triangles keep their numbers
void straighten_cuts(RefinedMesh& mesh, CutLines& lines);

/// The mesh opened along the cuts; copies of a vertex have its point.
[[nodiscard]] CutSurface open_along(const RefinedMesh& mesh, const std::vector<char>& cut);

}  // namespace geocloth
