// SPDX-License-Identifier: Apache-2.0
// Per structural spring of one group: its ends are pulled together where it is longer than it may be.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "constraints.glsl"

void main() {
  uvec2 p = group_pixel(constants.group, gl_GlobalInvocationID.x, gl_GlobalInvocationID.y);
  if (in_image(p)) tie_at(p);
}
