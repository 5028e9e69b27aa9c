// SPDX-License-Identifier: Apache-2.0
// Per pixel: the long-range attachment to a pinned pixel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "limit.glsl"

void main() {
  uvec2 p = own_pixel();
  if (in_image(p)) limit_at(p);
}
