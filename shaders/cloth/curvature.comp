// SPDX-License-Identifier: Apache-2.0
// Per bend of one group: one projection. Bends of a group share no pixel, so they may be written in place.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/bend_groups.h"
#include "../lib/spring_groups.h"
#include "constraints.glsl"

// What an image of a family holds for the spring along a row or down a column.
vec2 along(bool row, vec4 family) {
  return row ? family.xy : family.zw;
}

void main() {
  uint component = bend_component(constants.group);
  bool row = component == 4u;
  uvec2 pa = bend_pixel(constants.group, gl_GlobalInvocationID.x, gl_GlobalInvocationID.y);
  if (!in_image(pa)) return;
  vec2 rest = along(row, imageLoad(bending_image, texel(pa)));
  if (rest.y == 0.0f) return;
  uvec2 pm = spring_end(component - 4u, pa.x, pa.y);
  uvec2 pb = spring_end(component, pa.x, pa.y);
  float chord = chord_share(along(row, imageLoad(structural_image, texel(pa))).x,
                            along(row, imageLoad(structural_image, texel(pm))).x);

  uint slot = component * params.width * params.height + pa.y * params.width + pa.x;
  float multiplier = constants.read_multiplier != 0u ? multipliers[slot] : 0.0f;
  multiplier = project_bend(pa, pm, pb, 1.0f, chord, rest.x, rest.y, multiplier);
  if (constants.write_multiplier != 0u) multipliers[slot] = multiplier;
}
