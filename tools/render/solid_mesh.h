// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/asset/topology.h"
#include "geocloth/solver/collider.h"
#include "render/camera.h"

namespace geocloth {

/// Triangles with smooth normals, to be drawn under a collider's pose.
struct SolidMesh {
  std::vector<Vec3> position;  ///< [m] where the shape is at rest
  std::vector<Vec3> normal;    ///< unit length, outward
  std::vector<Triangle> triangle;
};

/// A collider's surface; a plane has none here (see ground_mesh).
[[nodiscard]] SolidMesh solid_mesh(const ColliderShape& shape);
/// A square of 2 x 2 in the xz plane about the origin, in pieces so that nothing large is clipped badly.
[[nodiscard]] SolidMesh ground_mesh();
/// The box around a collider in its pose; empty for a plane.
[[nodiscard]] Bounds collider_bounds(const Collider& collider);

}  // namespace geocloth
