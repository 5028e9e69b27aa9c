// SPDX-License-Identifier: Apache-2.0
// Per pixel: the area-weighted normal of its own cells, made a unit; its length goes to w for normals_stitch.comp.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/normal.h"

vec3 position_at(uvec2 pixel) {
  return imageLoad(position_image, texel(pixel)).xyz;
}

// The share of the cell with this upper left corner; this pixel is the given corner of it.
vec3 cell_share(uint x, uint y, uint corner) {
  uvec2 cell = uvec2(x, y);
  if (!in_image(cell)) return vec3(0.0f);  // x - 1 of column 0 wraps to a huge number
  uint bits = imageLoad(cell_image, texel(cell)).x;
  if ((bits & (kCellFirstBit | kCellSecondBit)) == 0u) return vec3(0.0f);
  return corner_normal(bits, corner, position_at(cell), position_at(cell + uvec2(1u, 0u)),
                       position_at(cell + uvec2(0u, 1u)), position_at(cell + uvec2(1u, 1u)));
}

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  precise vec3 sum = cell_share(p.x - 1u, p.y - 1u, 3u) + cell_share(p.x, p.y - 1u, 2u) +
                     cell_share(p.x - 1u, p.y, 1u) + cell_share(p.x, p.y, 0u);
  imageStore(normal_image, texel(p), unit_and_length(sum));
}
