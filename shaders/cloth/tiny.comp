// SPDX-License-Identifier: Apache-2.0
// A work group runs all passes of a frame over one small cloth, whose points stay in its own memory meanwhile.
#version 450
#extension GL_GOOGLE_include_directive : require
#define GEOCLOTH_TILE
#define GEOCLOTH_SHARED_NORMALS coherent
#include "cloth.glsl"
#include "../shared/tile.h"
#include "tile_points.glsl"

bool is_kept(uvec2 pixel) {
  return true;
}
void begin_pixel() {}
vec4 load_previous(uvec2 pixel) {
  return imageLoad(previous_image, texel(pixel));
}
void store_previous(uvec2 pixel, vec4 previous) {
  imageStore(previous_image, texel(pixel), previous);
}
vec4 load_carry(uvec2 pixel) {
  return imageLoad(carry_image, texel(pixel));
}
void store_carry(uvec2 pixel, vec4 carry) {
  imageStore(carry_image, texel(pixel), carry);
}
vec3 load_anchor(uvec2 pixel) {
  return load_position(pixel).xyz;
}

const bool kPredicts = true;

#include "tile_steps.glsl"
#include "whole_steps.glsl"

void main() {
  region_low = uvec2(0u);
  region_size = uvec2(params.width, params.height);
  uint count = region_size.x * region_size.y;
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) {
    points[i] = imageLoad(position_image, texel(pixel_of_region(i)));
  }
  run_steps();
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) {
    imageStore(position_image, texel(pixel_of_region(i)), points[i]);
  }
}
