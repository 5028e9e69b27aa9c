// SPDX-License-Identifier: Apache-2.0
// Copies of points.
#include "../lib/stitch.h"
#include "../lib/vector.h"
#include "../lib/yield.h"

vec4 weighed(vec4 point) {
  return vec4(point.xyz, inverse_mass_of(point.w));
}

// The mass-weighted mean of the copies of a row. A gather: one invocation for each row, in the row's order, so that there
// is no atomic and every run gives the same bits.
void stitch_at(uint row) {
  uint begin = split_offset[row];
  uint end = split_offset[row + 1u];
  vec4 first = load_point(pixel_at(split_pixel[begin]));
  if (first.w == 0.0f) return;  // pinned: all copies are set together
  StitchSum sum = stitch_begin();
  for (uint i = begin; i < end; ++i) {
    sum = stitch_add(sum, first, weighed(load_point(pixel_at(split_pixel[i]))));
  }
  vec3 mean = stitch_mean(sum, first);
  for (uint i = begin; i < end; ++i) {
    uvec2 p = pixel_at(split_pixel[i]);
    store_point(p, mean, load_point(p).w);
  }
}

// Non-negative floats order like their bits, so an integer maximum over all rows is exact and does not depend on their
// order.
void check_copies_at(uint row) {
  uint begin = split_offset[row];
  vec3 first = load_position(pixel_at(split_pixel[begin])).xyz;
  float gap = 0.0f;
  for (uint i = begin + 1u; i < split_offset[row + 1u]; ++i) {
    gap = max(gap, length3(load_position(pixel_at(split_pixel[i])).xyz - first));
  }
  atomicMax(measures[kMeasureCopyGap], floatBitsToUint(gap));
}
