// SPDX-License-Identifier: Apache-2.0
// Per split row: the copies' normals summed by area, made a unit and written to every copy.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "../lib/vector.h"

void main() {
  uint row = own_entry();
  if (row >= constants.count) return;
  precise vec3 sum = vec3(0.0f);
  for (uint i = split_offset[row]; i < split_offset[row + 1u]; ++i) {
    vec4 normal = imageLoad(normal_image, texel(pixel_at(split_pixel[i])));
    sum = sum + normal.xyz * normal.w;
  }
  vec4 mean = unit_and_length(sum);
  for (uint i = split_offset[row]; i < split_offset[row + 1u]; ++i) {
    imageStore(normal_image, texel(pixel_at(split_pixel[i])), mean);
  }
}
