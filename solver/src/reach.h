// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "geocloth/asset/cloth_asset.h"
#include "shared/layout.h"

namespace geocloth {

/// The least box about the points of a cloth.
struct ClothBox {
  Vec3 low, high;  ///< [m] relative to the solver's origin
};
[[nodiscard]] ClothBox box_of(const ClothAsset& asset, std::span<const shader::vec4> position);

/// Whether a collider may come within `margin` [m] of the box in a frame; never a wrong no.
/// @param shapes  with their ways in a substep
/// @param poses   of all colliders before the first substep and after each
[[nodiscard]] bool may_reach(std::span<const shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                             uint32_t collider, const ClothBox& box, float margin);

}  // namespace geocloth
