// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geocloth/solver/solver.h"
#include "shared/layout.h"

namespace geocloth {

/// Where in time a frame lies.
struct FrameClock {
  double start = 0;  ///< [s]
  double dt = 0;     ///< [s] of a substep
  uint32_t substeps = 1;
};

/// Where the local frame of a collider's shape (see shared/layout.h) lies in the world.
[[nodiscard]] Transform collider_frame(const Collider& collider);
[[nodiscard]] shader::ColliderShape collider_shape_of(const Collider& collider);

/// Poses of all colliders before the first substep and after each: (substeps + 1) * colliders, relative to the origin.
/// From and to have as many entries; translations go straight, rotations along the shortest arc.
[[nodiscard]] std::vector<shader::ColliderPose> collider_poses(std::span<const Collider> from,
                                                               std::span<const Collider> to, uint32_t substeps,
                                                               const Vec3& origin);

/// Sets ColliderShape::way from the poses of the frame.
void measure_ways(std::span<shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                  uint32_t substeps);

/// Pin fractions and gusts of every substep.
[[nodiscard]] std::vector<shader::Substep> substep_inputs(const FrameClock& clock, const std::optional<Wind>& wind,
                                                          const Vec3& origin);

/// The numbers of one material in one frame. width, height and collider_count are left 0.
[[nodiscard]] shader::ClothParams cloth_params(const Material& material, const FrameClock& clock, const Vec3& gravity,
                                               const std::optional<Wind>& wind);

}  // namespace geocloth
