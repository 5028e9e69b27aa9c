// SPDX-License-Identifier: Apache-2.0
// Per split row: the mass-weighted means of the copies' places and ways, written to every copy.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "stitch.glsl"
#include "point.glsl"

void main() {
  if (own_entry() >= constants.count) return;
  uint begin = split_offset[own_entry()];
  uint end = split_offset[own_entry() + 1u];
  uvec2 p0 = pixel_at(split_pixel[begin]);
  vec4 first = load_position(p0);
  if (first.w == 0.0f) return;  // pinned: all copies are set together
  vec4 first_way = vec4(way_of(load_state(p0)), first.w);
  StitchSum places = stitch_begin();
  StitchSum ways = stitch_begin();
  for (uint i = begin; i < end; ++i) {
    uvec2 p = pixel_at(split_pixel[i]);
    vec4 position = weighed(load_position(p));
    places = stitch_add(places, first, position);
    ways = stitch_add(ways, first_way, vec4(way_of(load_state(p)), position.w));
  }
  PointState mean = arrived(stitch_mean(places, first), stitch_mean(ways, first_way));
  for (uint i = begin; i < end; ++i) {
    uvec2 p = pixel_at(split_pixel[i]);
    store_state(p, mean, load_position(p).w);
  }
}
