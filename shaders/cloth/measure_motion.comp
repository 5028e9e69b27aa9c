// SPDX-License-Identifier: Apache-2.0
// Per pixel: how far the last substep took it.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/vector.h"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  vec4 position = load_position(p);
  if (position.w == 0.0f) return;  // pinned points go where the user puts them
  precise vec3 way = (position.xyz - load_previous(p).xyz) + load_carry(p).xyz;
  atomicMax(measures[kMeasureWay + constants.group], floatBitsToUint(length3(way)));
}
