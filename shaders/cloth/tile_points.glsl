// SPDX-License-Identifier: Apache-2.0
// The points of a region of the image in a work group's own memory, and passes over them. A spring whose other end is
// not in the region is left out: that spoils points near the region's sides, by so many pixels for each pass, which is
// why tile.comp writes back only those in the middle.

layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint kPoints = 1024u;  // that a region has at most
layout(constant_id = 2) const bool kContacts = true;  // some of the steps meet colliders

layout(set = 1, binding = kBindingTileSteps, std430) readonly buffer TileStepBlock { TileStep tile_steps[]; };
layout(set = 1, binding = kBindingPinOfPixel, std430) readonly buffer PinOfPixelBlock { uint pin_of_pixel[]; };
layout(push_constant, std430) uniform TileConstantsBlock { TileConstants tile; };

shared vec4 points[kPoints];

PassConstants constants;  // of the step that is run
uvec2 region_low;         // first pixel of the region
uvec2 region_size;

bool is_here(uvec2 pixel) {
  uvec2 from = pixel - region_low;  // left of it or above wraps to a huge number
  return from.x < region_size.x && from.y < region_size.y;
}

uint place_of(uvec2 pixel) {
  uvec2 from = pixel - region_low;
  return from.y * region_size.x + from.x;
}

// What the passes want; cloth.glsl has the same over images.
uint fine_mode() {
  return kFineOff;
}
vec4 load_position(uvec2 pixel) {
  return points[place_of(pixel)];
}
void store_position(uvec2 pixel, vec4 position) {
  points[place_of(pixel)] = position;
}
vec4 load_point(uvec2 pixel) {
  return points[place_of(pixel)];
}
void store_point(uvec2 pixel, vec3 moved, float mass_inverse) {
  points[place_of(pixel)] = vec4(moved, mass_inverse);
}
vec3 way_between(uvec2 pa, vec4 a, uvec2 pb, vec4 b) {
  precise vec3 d = b.xyz - a.xyz;
  return d;
}
vec3 first_way_between(uvec2 pa, uvec2 pb) {
  return vec3(0.0f);  // only with lib/fine.h
}
