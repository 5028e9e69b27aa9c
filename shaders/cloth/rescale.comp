// SPDX-License-Identifier: Apache-2.0
// Per pixel, in a frame's first substep: displacements of the last step's length become those of this one's.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/predict.h"

void main() {
  uvec2 p = own_pixel();
  if (constants.substep != 0u || !in_image(p)) return;
  vec4 position = load_position(p);
  Predicted r = rescaled(position.xyz, load_previous(p).xyz, load_carry(p).xyz, params.gravity_step.w);
  store_previous(p, vec4(r.previous, position.w));
  store_carry(p, vec4(r.carry, 0.0f));
}
