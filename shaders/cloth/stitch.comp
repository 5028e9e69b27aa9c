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
  vec4 first = load_point(pixel_at(split_pixel[begin]));
  if (first.w == 0.0f) return;  // pinned: all copies are set together
  StitchSum sum = stitch_begin();
  for (uint i = begin; i < end; ++i) {
    sum = stitch_add(sum, first, load_point(pixel_at(split_pixel[i])));
  }
  vec3 mean = stitch_mean(sum, first);
  for (uint i = begin; i < end; ++i) {
    uvec2 p = pixel_at(split_pixel[i]);
    store_point(p, mean, load_point(p).w);
  }
}
