// SPDX-License-Identifier: Apache-2.0
// A work group runs passes over one tile of the image, and over a border around it that is so wide that what it lacks
// beyond does not reach the tile. Neighbours do the same there, so nobody may write where another one reads: points come
// from the images of set 0 and go to those of set 1. The result is exactly that of the passes one by one.
#version 450
#extension GL_GOOGLE_include_directive : require
#define GEOCLOTH_TILE
#include "cloth.glsl"
#include "../shared/tile.h"

layout(set = 1, binding = kBindingPositionOut, rgba32f) uniform writeonly image2D position_out;
layout(set = 1, binding = kBindingPreviousOut, rgba32f) uniform writeonly image2D previous_out;
layout(set = 1, binding = kBindingCarryOut, rgba32f) uniform writeonly image2D carry_out;
layout(constant_id = 3) const uint kSide = 16u;   // of a tile
layout(constant_id = 4) const uint kBorder = 2u;  // around it

#include "tile_points.glsl"

// Of the tile itself.
bool is_kept(uvec2 pixel) {
  return pixel / kSide == gl_WorkGroupID.xy;
}

// What a pass has stored is in the other image; the next function of the same pixel wants it.
vec4 kept_previous;
bool has_previous;

void begin_pixel() {
  has_previous = false;
}
vec4 load_previous(uvec2 pixel) {
  return has_previous ? kept_previous : imageLoad(previous_image, texel(pixel));
}
void store_previous(uvec2 pixel, vec4 previous) {
  kept_previous = previous;
  has_previous = true;
  if (is_kept(pixel)) imageStore(previous_out, texel(pixel), previous);
}
vec4 load_carry(uvec2 pixel) {
  return imageLoad(carry_image, texel(pixel));
}
void store_carry(uvec2 pixel, vec4 carry) {
  if (is_kept(pixel)) imageStore(carry_out, texel(pixel), carry);
}
// Anchors are held: no pass of a tile has moved them.
vec3 load_anchor(uvec2 pixel) {
  return imageLoad(position_image, texel(pixel)).xyz;
}

// Colliders are met in the second tile of a substep, and the first one predicts; see frame_plan.cpp.
const bool kPredicts = !kContacts;

#include "tile_steps.glsl"

// A tile has none of these.
void run_whole_step(uint pass) {}

void main() {
  uvec2 tile_low = gl_WorkGroupID.xy * kSide;
  region_low = tile_low - min(tile_low, uvec2(kBorder));
  region_size = min(tile_low + (kSide + kBorder), uvec2(params.width, params.height)) - region_low;
  uint count = region_size.x * region_size.y;
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) {
    uvec2 p = pixel_of_region(i);
    points[i] = imageLoad(position_image, texel(p));
    if (is_kept(p) && (tile.keep_history != 0u || points[i].w == 0.0f)) {
      imageStore(previous_out, texel(p), imageLoad(previous_image, texel(p)));
      imageStore(carry_out, texel(p), imageLoad(carry_image, texel(p)));
    }
  }
  run_steps();
  for (uint i = gl_LocalInvocationIndex; i < count; i += gl_WorkGroupSize.x) {
    uvec2 p = pixel_of_region(i);
    if (is_kept(p)) imageStore(position_out, texel(p), points[i]);
  }
}
