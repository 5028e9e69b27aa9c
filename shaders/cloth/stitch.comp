// SPDX-License-Identifier: Apache-2.0
// Per split row: the mass-weighted mean of the copies, written to every copy. A gather: one invocation for each row, in
// the row's order, so that there is no atomic and every run gives the same bits.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "../lib/stitch.h"

void main() {
  uint row = own_entry();
  if (row >= constants.count) return;
  uint begin = split_offset[row];
  uint end = split_offset[row + 1u];
  vec4 first = imageLoad(position_image, texel(pixel_at(split_pixel[begin])));
  if (first.w == 0.0f) return;  // pinned: all copies are set together
  StitchSum sum = stitch_begin();
  for (uint i = begin; i < end; ++i) {
    sum = stitch_add(sum, first, imageLoad(position_image, texel(pixel_at(split_pixel[i]))));
  }
  vec3 mean = stitch_mean(sum, first);
  for (uint i = begin; i < end; ++i) {
    ivec2 p = texel(pixel_at(split_pixel[i]));
    imageStore(position_image, p, vec4(mean, imageLoad(position_image, p).w));
  }
}
