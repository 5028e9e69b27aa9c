// SPDX-License-Identifier: Apache-2.0
// Per bend over a seam, of one colour: one projection. Bends of a colour share no pixel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "../lib/bend.h"

void main() {
  if (own_entry() >= constants.count) return;
  uint i = constants.first + own_entry();
  SeamSpring bend = seam_bends[i];
  ivec2 pa = texel(pixel_at(bend.a));
  ivec2 pm = texel(pixel_at(bend.middle));
  ivec2 pb = texel(pixel_at(bend.b));
  vec4 a = imageLoad(position_image, pa);
  vec4 m = imageLoad(position_image, pm);
  vec4 b = imageLoad(position_image, pb);

  uint slot = kSpringComponents * params.width * params.height + i;
  float multiplier = constants.read_multiplier != 0u ? multipliers[slot] : 0.0f;
  precise float compliance = bend.compliance * params.inverse_dt2;
  BendEnds ends = project_bend(a.xyz, a.w, m.xyz, m.w, b.xyz, b.w, bend.middle_share, bend.chord, bend.rest, compliance,
                               multiplier);
  imageStore(position_image, pa, vec4(ends.a, a.w));
  imageStore(position_image, pm, vec4(ends.middle, m.w));
  imageStore(position_image, pb, vec4(ends.b, b.w));
  if (constants.write_multiplier != 0u) multipliers[slot] = ends.multiplier;
}
