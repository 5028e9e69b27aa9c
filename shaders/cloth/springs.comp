// SPDX-License-Identifier: Apache-2.0
// Per spring of one group: one projection. Springs of a group share no pixel, so they may be written in place.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "constraints.glsl"
#include "../lib/spring_groups.h"

layout(constant_id = 0) const uint kFamily = 0u;  // structural, shear, bending

// Rest length and compliance of the spring, which is the first or the second of its family.
vec2 rest_data(uvec2 pixel, uint component) {
  vec4 family = kFamily == 0u   ? imageLoad(structural_image, texel(pixel))
                : kFamily == 1u ? imageLoad(shear_image, texel(pixel))
                                : imageLoad(bending_image, texel(pixel));
  return component % 2u == 0u ? family.xy : family.zw;
}

float share() {
  return kFamily == 0u ? params.share_structural : kFamily == 1u ? params.share_shear : params.share_bending;
}

void main() {
  uint component = group_component(constants.group);
  uvec2 pa = group_pixel(constants.group, gl_GlobalInvocationID.x, gl_GlobalInvocationID.y);
  if (!in_image(pa)) return;
  vec2 rest = rest_data(pa, component);
  if (rest.x == 0.0f) return;
  uvec2 pb = spring_end(component, pa.x, pa.y);
  uint slot = component * params.width * params.height + pa.y * params.width + pa.x;
  float multiplier = constants.read_multiplier != 0u ? multipliers[slot] : 0.0f;
  multiplier = project_spring(pa, pb, rest.x, rest.y, share(), multiplier);
  if (constants.write_multiplier != 0u) multipliers[slot] = multiplier;
}
