// SPDX-License-Identifier: Apache-2.0
// Per spring of one group: one projection.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "constraints.glsl"

layout(constant_id = 0) const uint kFamily = 0u;  // structural, shear, bending

void main() {
  uvec2 p = group_pixel(constants.group, gl_GlobalInvocationID.x, gl_GlobalInvocationID.y);
  if (in_image(p)) spring_at(kFamily, p);
}
