// SPDX-License-Identifier: Apache-2.0
// Per pixel: how far the last substep took it.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "point.glsl"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  if (load_position(p).w == 0.0f) return;  // pinned points go where the user puts them
  atomicMax(measures[kMeasureWay + constants.group], floatBitsToUint(length3(way_of(load_state(p)))));
}
