// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "geocloth/asset/cloth_asset.h"
#include "shared/layout.h"

namespace geocloth {

/// The least box about points; of none as long as none was added.
struct ClothBox {
  static constexpr float kFar = std::numeric_limits<float>::max();
  Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};  ///< [m]

  void add(const Vec3& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  void grow(float by) {
    low -= {by, by, by};
    high += {by, by, by};
  }
  [[nodiscard]] bool empty() const { return low.x > high.x; }
  [[nodiscard]] Vec3 middle() const { return empty() ? Vec3{} : 0.5F * low + 0.5F * high; }
};
/// About the valid pixels.
[[nodiscard]] ClothBox box_of(const ClothAsset& asset, std::span<const shader::vec4> position);

/// A box about a shape in its local frame.
struct LocalBox {
  Vec3 center, half;  ///< [m]
};
/// About the grid of a mesh's field.
[[nodiscard]] LocalBox box_of_grid(const shader::ColliderShape& shape);

/// About all places where a collider may be in a frame; without bounds for planes and hulls that are open.
/// @param shapes, poses  as for may_reach()
[[nodiscard]] ClothBox swept_box(std::span<const shader::ColliderShape> shapes,
                                 std::span<const shader::ColliderPose> poses, uint32_t collider);
/// Whether two boxes come within `margin` [m] of each other along each axis.
[[nodiscard]] bool are_near(const ClothBox& a, const ClothBox& b, float margin);

/// Whether a collider may come within `margin` [m] of the box in a frame; never a wrong no.
/// @param shapes  with their ways in a substep
/// @param poses   of all colliders before the first substep and after each
[[nodiscard]] bool may_reach(std::span<const shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                             uint32_t collider, const ClothBox& box, float margin);

}  // namespace geocloth
