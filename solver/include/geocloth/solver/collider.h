// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <variant>

#include "geocloth/solver/solid.h"
#include "geocloth/solver/transform.h"

namespace geocloth {

struct Sphere {
  Vec3 center = {};  ///< [m]
  float radius = 1;  ///< [m] > 0
  bool operator==(const Sphere&) const = default;
};
/// Two spheres and the cone between them; a plain capsule when the radii are equal.
struct Capsule {
  Vec3 a = {}, b = {};               ///< [m]
  float radius_a = 1, radius_b = 1;  ///< [m] > 0
  bool operator==(const Capsule&) const = default;
};
struct Box {
  Vec3 center = {};
  Vec3 half_extents{1, 1, 1};  ///< [m] > 0
  Quat rotate = {};
  bool operator==(const Box&) const = default;
};
struct Ellipsoid {
  Vec3 center = {};
  Vec3 radii{1, 1, 1};  ///< [m] > 0
  Quat rotate = {};
  bool operator==(const Ellipsoid&) const = default;
};

/// A body of triangles.
struct MeshSolid {
  std::shared_ptr<const DistanceField> field;  ///< not null
  bool operator==(const MeshSolid&) const = default;
};

using ColliderShape = std::variant<Plane, Sphere, Capsule, Box, Ellipsoid, Convex, MeshSolid>;

/// A solid that cloth cannot enter. The shape is given at rest, its sizes and coordinates up to 1e6 m; `pose` moves it.
struct Collider {
  std::string name = {};  ///< by which Solver::set_colliders() knows it again; need not be unique
  ColliderShape shape = {};
  float friction = 0.3F;  ///< Coulomb coefficient, 0..1e3
  Transform pose = {};    ///< scale must be 1
  bool teleport = false;  ///< in the next frame it is at its pose at once, without a velocity
  uint32_t groups = 1;    ///< bits: a cloth meets it that meets one of these, see Solver::set_meets()
};

/// Whether cloth that meets some groups (bits) meets a collider.
[[nodiscard]] inline bool meets(uint32_t groups, const Collider& collider) {
  return (groups & collider.groups) != 0;
}

/// Signed distance [m] of a point to the collider's surface in its pose, negative inside. Ellipsoid: exact to 1e-6 of
/// its largest radius. Convex: outside of an edge or a corner the largest distance to one of the planes. Mesh: of the
/// field, a lower bound outside of its grid.
/// @throws Error(invalid_argument) for a collider that Solver::set_colliders() refuses
///
/// Of a mesh's field it is not looked at what the distances are, only how many.
[[nodiscard]] float signed_distance(const Collider& collider, const Vec3& point);
/// The same of many points: what a collider is made of is worked out once.
class SignedDistance {
 public:
  /// @throws Error(invalid_argument) as signed_distance()
  explicit SignedDistance(const Collider& collider);
  ~SignedDistance();
  SignedDistance(SignedDistance&&) noexcept;
  SignedDistance& operator=(SignedDistance&&) noexcept;
  /// [m]
  [[nodiscard]] float operator()(const Vec3& point) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace geocloth
