// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "shared/layout.h"

namespace geocloth {

inline constexpr float kAnyWay = 1e30F;  ///< [m] no bound

/// Poses of the colliders of a frame: (substeps + 1) * count, those before the first substep and after each.
struct ColliderPath {
  std::span<const shader::ColliderPose> poses;
  size_t count = 0;
  uint32_t substeps = 0;

  [[nodiscard]] const shader::ColliderPose& pose(uint32_t substep, size_t collider) const {
    return poses[substep * count + collider];
  }
};

/// Sets ColliderShape::way from the poses of the frame: no point within `margin` [m] of the shape goes further with it.
void measure_ways(std::span<shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                  uint32_t substeps, double margin);

/// What a collider does to a place that moves with it, in the last substep of a frame.
[[nodiscard]] shader::FrameField last_motion(const ColliderPath& path, size_t collider);
/// The same motion in a step that is so many times as long, for motions that turn by little.
[[nodiscard]] shader::FrameField scaled(const shader::FrameField& motion, double times);
/// [m] The longest way of a collider in a substep as seen from what the motion takes along.
[[nodiscard]] float way_beside(const shader::ColliderShape& shape, const ColliderPath& path, size_t collider,
                               const shader::FrameField& motion);

}  // namespace geocloth
