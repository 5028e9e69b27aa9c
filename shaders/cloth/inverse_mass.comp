// SPDX-License-Identifier: Apache-2.0
// Per pixel: a new inverse mass, when the set of pins changes.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  vec4 position = imageLoad(position_image, texel(p));
  imageStore(position_image, texel(p), vec4(position.xyz, inverse_mass[p.y * params.width + p.x]));
}
