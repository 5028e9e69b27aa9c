// SPDX-License-Identifier: Apache-2.0
// Per pixel: the area-weighted normal of its own cells, made a unit; its length goes to w for normals_stitch.comp.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/normal.h"

vec3 position_at(uvec2 pixel) {
  return imageLoad(position_image, texel(pixel)).xyz;
}

// The share of the cell whose upper left corner is given; this pixel is that corner of it.
vec3 cell_share(uvec2 cell, uint corner) {
  uint bits = imageLoad(cell_image, texel(cell)).x;
  if (bits == 0u) return vec3(0.0f);
  return corner_normal(bits, corner, position_at(cell), position_at(cell + uvec2(1u, 0u)),
                       position_at(cell + uvec2(0u, 1u)), position_at(cell + uvec2(1u, 1u)));
}

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  precise vec3 sum = vec3(0.0f);
  if (p.x > 0u && p.y > 0u) sum = sum + cell_share(p - uvec2(1u, 1u), 3u);
  if (p.y > 0u) sum = sum + cell_share(p - uvec2(0u, 1u), 2u);
  if (p.x > 0u) sum = sum + cell_share(p - uvec2(1u, 0u), 1u);
  sum = sum + cell_share(p, 0u);
  imageStore(normal_image, texel(p), unit_and_length(sum));
}
