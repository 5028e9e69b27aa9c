// SPDX-License-Identifier: Apache-2.0
// Per pixel: the sum of base and offset becomes the position (lib/fine.h).
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/fine.h"
#include "point.glsl"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  vec4 base = imageLoad(previous_image, texel(p));
  vec4 offset = imageLoad(offset_image, texel(p));
  Settled next = settle(base.xyz, offset.xyz, imageLoad(carry_image, texel(p)).xyz);
  store_state(p, next.point, offset.w);
  imageStore(offset_image, texel(p), vec4(next.low, offset.w));
}
