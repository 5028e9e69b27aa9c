// SPDX-License-Identifier: Apache-2.0
// Normals of pixels from their own cells, and of copies.
#include "../lib/normal.h"
#include "../lib/yield.h"

// The share of the cell with this upper left corner; this pixel is the given corner of it.
vec3 cell_share(uint x, uint y, uint corner) {
  uvec2 cell = uvec2(x, y);
  if (!in_image(cell)) return vec3(0.0f);  // x - 1 of column 0 wraps to a huge number
  uint bits = imageLoad(cell_image, texel(cell)).x;
  if ((bits & (kCellFirstBit | kCellSecondBit)) == 0u) return vec3(0.0f);
  return corner_normal(bits, corner, load_position(cell).xyz, load_position(cell + uvec2(1u, 0u)).xyz,
                       load_position(cell + uvec2(0u, 1u)).xyz, load_position(cell + uvec2(1u, 1u)).xyz);
}

void normal_at(uvec2 p) {
  precise vec3 sum = cell_share(p.x - 1u, p.y - 1u, 3u) + cell_share(p.x, p.y - 1u, 2u) +
                     cell_share(p.x - 1u, p.y, 1u) + cell_share(p.x, p.y, 0u);
  imageStore(normal_image, texel(p), unit_and_length(sum));
}

void stitch_normals(uint row) {
  precise vec3 sum = vec3(0.0f);
  precise float mass = 0.0f;  // only where a pressure acts
  for (uint i = split_offset[row]; i < split_offset[row + 1u]; ++i) {
    uvec2 p = pixel_at(split_pixel[i]);
    vec4 normal = imageLoad(normal_image, texel(p));
    sum = sum + normal.xyz * normal.w;
    if (params.pressure.x == 0.0f) continue;
    float inverse_mass = inverse_mass_of(load_position(p).w);
    if (inverse_mass > 0.0f) mass = mass + 1.0f / inverse_mass;
  }
  vec4 mean = unit_and_length(sum);
  if (mass > 0.0f) mean.w = -mean.w / mass;  // see pressure_acceleration() of lib/predict.h
  for (uint i = split_offset[row]; i < split_offset[row + 1u]; ++i) {
    imageStore(normal_image, texel(pixel_at(split_pixel[i])), mean);
  }
}
