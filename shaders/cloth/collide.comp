// SPDX-License-Identifier: Apache-2.0
// Per pixel: largest speed, then all colliders with friction.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "colliders.glsl"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  vec4 position = imageLoad(position_image, texel(p));
  if (position.w == 0.0f) return;
  PointState point;
  point.position = position.xyz;
  point.previous = imageLoad(previous_image, texel(p)).xyz;
  point.carry = imageLoad(carry_image, texel(p)).xyz;
  PointState moved = collide(ColliderSet(0u), params, constants.substep, point);
  imageStore(position_image, texel(p), vec4(moved.position, position.w));
  imageStore(previous_image, texel(p), vec4(moved.previous, position.w));
  imageStore(carry_image, texel(p), vec4(moved.carry, 0.0f));
}
