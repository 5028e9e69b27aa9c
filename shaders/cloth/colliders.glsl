// SPDX-License-Identifier: Apache-2.0
// The colliders that the cloth meets, as lib/collide.h wants them.
struct ColliderSet {
  uint unused;
};

ColliderShape collider_shape(ColliderSet set, uint i) {
  return shapes[params.first_shape + i];
}

ColliderPose collider_pose(ColliderSet set, uint pose, uint i) {
  return poses[params.first_pose + pose * params.collider_count + i];
}

float collider_number(ColliderSet set, uint i) {
  return collider_numbers[i];
}

#include "../lib/collide.h"
