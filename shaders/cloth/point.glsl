// SPDX-License-Identifier: Apache-2.0
// A pixel's point, wherever the pass keeps it: images or shared memory.
#ifndef GEOCLOTH_POINT_GLSL
#define GEOCLOTH_POINT_GLSL

#include "../lib/point_state.h"

PointState load_state(uvec2 p) {
  PointState r;
  r.position = load_position(p).xyz;
  r.previous = load_previous(p).xyz;
  r.carry = load_carry(p).xyz;
  return r;
}

// @param w  what the pixel keeps beside its position: the inverse mass
void store_state(uvec2 p, PointState point, float w) {
  store_position(p, vec4(point.position, w));
  store_previous(p, vec4(point.previous, w));
  store_carry(p, vec4(point.carry, 0.0f));
}

#endif
