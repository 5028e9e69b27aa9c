// SPDX-License-Identifier: Apache-2.0
// Per bend over three pixels of one group: one projection.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "constraints.glsl"

void main() {
  uvec2 p = bend_pixel(constants.group, gl_GlobalInvocationID.x, gl_GlobalInvocationID.y);
  if (in_image(p)) bend_at(p);
}
