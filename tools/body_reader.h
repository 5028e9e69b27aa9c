// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "geocloth/asset/topology.h"
#include "geocloth/asset/vec.h"
#include "geocloth/solver/scene.h"

namespace geocloth {

// The meshes, animations and point caches that a scene names.

/// The triangles of a collider's mesh, which may be of any kind that a garment may be.
/// @throws as import_mesh and select_parts
[[nodiscard]] TriangleSurface read_body(const SceneMesh& body);

/// The vertices of a mesh file, or of a frame of a point cache.
/// @throws as import_mesh and read_point_cache, and Error(invalid_data) for a frame that there is not
[[nodiscard]] PosedVertices read_vertices(const SceneStart& start);

/// A body as its animation deforms it, in the coordinates of its mesh file.
struct PlayedBody {
  std::vector<Triangle> triangle;                              ///< of all vertices
  std::vector<Vec3> as_opened;                                 ///< [m] vertices as the mesh file has them
  std::function<std::vector<Vec3>(double time)> positions_at;  ///< [m] of all at a time of the scene [s] >= 0
  double duration = 0;                                         ///< [s] of the animation at its own speed
};
/// Reads a body that has an animation: one of its file, or a point cache of its vertices.
/// @throws as AnimatedMesh; for a point cache as read_body and read_point_cache, and Error(invalid_data) when it does
/// not
///   have as many points as the file has vertices
[[nodiscard]] PlayedBody play_body(const SceneMesh& body);

/// Of all these.
[[nodiscard]] BodyReader body_reader();

}  // namespace geocloth
