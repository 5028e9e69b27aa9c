// SPDX-License-Identifier: Apache-2.0
// Per split row: largest distance of a copy to the first one. Non-negative floats order like their bits, so an integer
// maximum over all rows is exact and does not depend on their order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "../lib/vector.h"

void main() {
  uint row = own_entry();
  if (row >= constants.count) return;
  uint begin = split_offset[row];
  vec3 first = imageLoad(position_image, texel(pixel_at(split_pixel[begin]))).xyz;
  float gap = 0.0f;
  for (uint i = begin + 1u; i < split_offset[row + 1u]; ++i) {
    gap = max(gap, length3(imageLoad(position_image, texel(pixel_at(split_pixel[i]))).xyz - first));
  }
  atomicMax(measures[kMeasureCopyGap], floatBitsToUint(gap));
}
