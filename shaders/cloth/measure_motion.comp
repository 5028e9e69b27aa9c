// SPDX-License-Identifier: Apache-2.0
// Per pixel: how far the last substep took it, and whether a carrier took it along.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "point.glsl"
#include "../lib/frame.h"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  if (load_position(p).w == 0.0f) return;  // pinned points go where the user puts them
  PointState point = load_state(p);
  vec3 way = way_of(point);
  atomicMax(measures[kMeasureWay + constants.group], floatBitsToUint(length3(way)));
  if (is_left_behind(params, point.position, way)) atomicAdd(measures[kMeasureLeft + constants.group], 1u);
}
