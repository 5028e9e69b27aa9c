// SPDX-License-Identifier: Apache-2.0
// Per span of one group: its ends are pulled together where it is too long.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "constraints.glsl"

void main() {
  uvec2 p = span_pixel(constants.group, gl_GlobalInvocationID.x, gl_GlobalInvocationID.y);
  if (in_image(p)) span_at(p);
}
