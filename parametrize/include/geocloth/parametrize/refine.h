// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Triangles of a mesh that refine_mesh() makes, at most.
inline constexpr std::size_t kMostRefinedTriangles = 4'000'000;

/// The mesh with every edge halved until none is longer than `longest`: the same surface, of triangles that follow
/// cloth into its folds when they are drawn. Vertices of the file come first, in their order; edges that lie on each
/// other are divided alike. Texture coordinates and normals are those between; a vertex between two of a group is in
/// it.
/// @param longest  [m] > 0
/// @throws Error(limit) when that takes more than kMostRefinedTriangles
[[nodiscard]] TriangleMesh refine_mesh(TriangleMesh mesh, double longest);

}  // namespace geocloth
