// SPDX-License-Identifier: Apache-2.0
// Per cell of one group: its triangles against all colliders. Cells of a group share no pixel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "colliders.glsl"
#include "../lib/cell_groups.h"
#include "../lib/collide_cell.h"
#include "../lib/normal.h"
#include "../lib/yield.h"

vec4 moved_corner(vec4 corner, vec3 to) {
  float yield = lessened_yield(yield_of(corner.w), to - corner.xyz, params.spacing);
  return vec4(to, with_yield(corner.w, yield));
}

void collide_triangle_at(uvec2 pa, uvec2 pb, uvec2 pc) {
  vec4 a = load_position(pa);
  vec4 b = load_position(pb);
  vec4 c = load_position(pc);
  MovedTriangle t;
  t.a = a.xyz;
  t.b = b.xyz;
  t.c = c.xyz;
  t.start_a = load_previous(pa).xyz;
  t.start_b = load_previous(pb).xyz;
  t.start_c = load_previous(pc).xyz;
  vec3 w = vec3(inverse_mass_of(a.w), inverse_mass_of(b.w), inverse_mass_of(c.w));
  MovedTriangle moved = collide_triangle(ColliderSet(0.0f, 1.0f), params, constants.substep, t, w);
  store_position(pa, moved_corner(a, moved.a));
  store_position(pb, moved_corner(b, moved.b));
  store_position(pc, moved_corner(c, moved.c));
  store_previous(pa, vec4(moved.start_a, a.w));
  store_previous(pb, vec4(moved.start_b, b.w));
  store_previous(pc, vec4(moved.start_c, c.w));
}

void main() {
  uvec2 p0 = cell_corner(constants.group, gl_GlobalInvocationID.x, gl_GlobalInvocationID.y);
  if (p0.x + 1u >= params.width || p0.y + 1u >= params.height) return;
  uint bits = imageLoad(cell_image, texel(p0)).x;
  uvec2 p1 = p0 + uvec2(1u, 0u);
  uvec2 p2 = p0 + uvec2(0u, 1u);
  uvec2 p3 = p0 + uvec2(1u, 1u);
  bool left = (bits & kCellDiagonalLeftBit) != 0u;
  for (uint i = 0u; i < 2u; ++i) {
    bool first = i == 0u;
    if ((bits & (first ? kCellFirstBit : kCellSecondBit)) == 0u) continue;
    uvec2 a = first || !left ? p0 : p1;
    uvec2 b = first || left ? p2 : p3;
    uvec2 c = first ? (left ? p1 : p3) : (left ? p3 : p1);
    collide_triangle_at(a, b, c);
  }
}
