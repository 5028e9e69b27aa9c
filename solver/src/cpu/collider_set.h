// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "shared/layout.h"

namespace geocloth::shader {

/// collide.h reads colliders through this.
struct ColliderSet {
  const ColliderShape* shapes;
  const ColliderPose* poses;
  uint count;
  const float* numbers;  ///< see ColliderShape::data
};
inline ColliderShape collider_shape(ColliderSet set, uint i) {
  return set.shapes[i];
}
inline ColliderPose collider_pose(ColliderSet set, uint pose, uint i) {
  return set.poses[size_t{pose} * set.count + i];
}

inline float collider_number(ColliderSet set, uint i) {
  return set.numbers[i];
}

}  // namespace geocloth::shader

#include "lib/collide.h"
