// SPDX-License-Identifier: Apache-2.0
// Per seam bend of one colour: one projection. Bends of a colour share no pixel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "constraints.glsl"

void main() {
  if (own_entry() >= constants.count) return;
  uint i = constants.first + own_entry();
  SeamSpring bend = seam_bends[i];
  uint slot = kSpringComponents * params.width * params.height + i;
  float multiplier = constants.read_multiplier != 0u ? multipliers[slot] : 0.0f;
  multiplier =
      project_spring(pixel_at(bend.a), pixel_at(bend.b), bend.rest, bend.compliance, params.share_bending, multiplier);
  if (constants.write_multiplier != 0u) multipliers[slot] = multiplier;
}
