// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "shared/layout.h"

namespace geocloth {

/// Sets ColliderShape::way from the poses of the frame: no point within `margin` [m] of the shape goes further with it.
void measure_ways(std::span<shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                  uint32_t substeps, double margin);

/// [m] The longest way of a collider in a substep as seen from what a motion takes along.
/// @param poses         of all colliders before the first substep and after each
/// @param motion, step  of a substep's length; which of its steps
[[nodiscard]] float way_beside(std::span<const shader::ColliderShape> shapes,
                               std::span<const shader::ColliderPose> poses, uint32_t collider,
                               const shader::FrameField& motion, float step);

}  // namespace geocloth
