// SPDX-License-Identifier: Apache-2.0
// Per pixel: largest depth below a collider's surface. Pinned points go where the user puts them and are left out.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "colliders.glsl"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  vec4 position = imageLoad(position_image, texel(p));
  if (position.w == 0.0f) return;
  float depth = depth_in_colliders(ColliderSet(0u), params.collider_count, constants.substep, position.xyz);
  if (depth > 0.0f) atomicMax(measures[kMeasurePenetration], floatBitsToUint(depth));
}
