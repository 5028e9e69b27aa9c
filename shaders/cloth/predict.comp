// SPDX-License-Identifier: Apache-2.0
// Per pixel: Verlet prediction. Pinned pixels stay; pins.comp moves them.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "predict.glsl"

void main() {
  uvec2 p = own_pixel();
  if (in_image(p)) predict_at(p);
}
