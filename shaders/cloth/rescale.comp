// SPDX-License-Identifier: Apache-2.0
// Per pixel, in a frame's first substep: displacements of the last step's length become those of this one's.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/predict.h"
#include "point.glsl"

void main() {
  uvec2 p = own_pixel();
  if (constants.substep != 0u || !in_image(p)) return;
  store_state(p, rescaled(load_state(p), params.gravity_step.w), load_position(p).w);
}
