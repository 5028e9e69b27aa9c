// SPDX-License-Identifier: Apache-2.0
// Colliders and pixels.
#include "colliders.glsl"

// Largest speed, then all colliders with friction.
void collide_at(uvec2 p) {
  vec4 position = load_position(p);
  if (position.w == 0.0f) return;
  PointState point;
  point.position = position.xyz;
  point.previous = load_previous(p).xyz;
  point.carry = load_carry(p).xyz;
  PointState moved = collide(ColliderSet(0u), params, constants.substep, point);
  store_position(p, vec4(moved.position, position.w));
  store_previous(p, vec4(moved.previous, position.w));
  store_carry(p, vec4(moved.carry, 0.0f));
}

// Pinned points go where the user puts them and are left out.
void check_colliders_at(uvec2 p) {
  vec4 position = load_position(p);
  if (position.w == 0.0f) return;
  float depth = depth_in_colliders(ColliderSet(0u), params.collider_count, constants.substep, position.xyz);
  if (depth > 0.0f) atomicMax(measures[kMeasurePenetration], floatBitsToUint(depth));
}
