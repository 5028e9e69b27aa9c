// SPDX-License-Identifier: Apache-2.0
// The colliders that the cloth meets, as lib/collide.h wants them.
#include "../lib/contact_sum.h"

layout(constant_id = 5) const uint kContactForces = 0u;  // 1: contacts are summed

struct ColliderSet {
  float mass_inverse;  // of the point that meets them
  float yield;         // that counts for contact sums
};

ColliderSet set_of_point(ColliderSet set, float mass_inverse, float yield) {
  return ColliderSet(mass_inverse, yield);
}

ColliderShape collider_shape(ColliderSet set, uint i) {
  return shapes[params.first_shape + i];
}

ColliderPose collider_pose(ColliderSet set, uint pose, uint i) {
  return poses[params.first_pose + pose * params.collider_count + i];
}

float collider_number(ColliderSet set, uint i) {
  return collider_numbers[i];
}

void add_fixed(uint word, float v) {
  FixedPoint n = fixed_point(v);
  uint before = atomicAdd(contact_words[word], n.low);
  uint carry = before + n.low < before ? 1u : 0u;
  atomicAdd(contact_words[word + 1u], n.high + carry);
}

void add_contact(ColliderSet set, uint i, vec3 way, vec3 n, vec3 position) {
  if (kContactForces == 0u || set.mass_inverse <= 0.0f) return;
  vec3 borne = borne_way(way, n, params.gravity_step.xyz, set.yield);
  ContactShare share = contact_share(set.mass_inverse, borne, position, params.contact_scale);
  for (uint k = 0u; k < kContactValues; ++k) {
    vec3 of = k < 3u ? share.impulse : share.moment;
    uint axis = k % 3u;
    add_fixed(kContactWords * i + 2u * k, axis == 0u ? of.x : (axis == 1u ? of.y : of.z));
  }
}

#include "../lib/collide.h"
