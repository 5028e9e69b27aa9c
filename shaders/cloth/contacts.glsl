// SPDX-License-Identifier: Apache-2.0
// Colliders and pixels, and how a frame ends.
#include "colliders.glsl"
#include "../lib/finish.h"
#include "../lib/yield.h"
#include "point.glsl"

// Largest speed, then all colliders with friction.
void collide_at(uvec2 p) {
  float w = load_position(p).w;
  if (w == 0.0f) return;
  PointState point = slowed(params, load_state(p));
  float counts = yield_counts(params) ? yield_of(w) : 1.0f;
  PointState after = collide(ColliderSet(inverse_mass_of(w), counts), params, constants.substep, point);
  float yield = next_yield(yield_of(w), after.position - point.position, params.spacing);
  store_state(p, after, with_yield(w, yield));
}

void hold_way_at(uvec2 p) {
  float w = load_position(p).w;
  if (w != 0.0f) store_state(p, way_held(load_state(p)), w);
}

void give_way_at(uvec2 p) {
  float w = load_position(p).w;
  if (w != 0.0f) store_state(p, way_given(ColliderSet(0.0f, 1.0f), params, constants.substep, load_state(p)), w);
}

// Pinned points go where the user puts them and are left out.
void check_colliders_at(uvec2 p) {
  vec4 position = load_position(p);
  if (position.w == 0.0f) return;
  float depth = depth_in_colliders(ColliderSet(0.0f, 1.0f), params.collider_count, constants.substep, position.xyz);
  if (depth > 0.0f) atomicMax(measures[kMeasurePenetration], floatBitsToUint(depth));
}
