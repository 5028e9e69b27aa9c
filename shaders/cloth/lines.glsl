// SPDX-License-Identifier: Apache-2.0
// Line relaxation: one invocation for each row or column.
#include "../lib/lines.h"

// Pixel k of line n of the group constants.group.
uvec2 pixel_of_line(uint n, uint k) {
  return constants.group == 0u ? uvec2(k, n) : uvec2(n, k);
}

// 0: no spring begins there.
float longest_in_line(uvec2 p) {
  vec4 springs = imageLoad(structural_image, texel(p));
  precise float longest = (constants.group == 0u ? springs.x : springs.z) * params.stretch_limit;
  return longest;
}

float weight_in_line(uvec2 p, vec4 point) {
  return line_weight(point.w, imageLoad(cell_image, texel(p)).x);
}

void move_in_line(uvec2 p, vec4 point, float weight, vec3 step, vec3 step_before, bool has_spring) {
  if (has_spring && weight != 0.0f) store_point(p, line_point(point.xyz, step, step_before, weight), point.w);
}

// The runs of a line, forth and back. Normals are made anew after the frame: till then they keep what goes from one
// sweep to the other.
void line_at(uint n) {
  uint springs = (constants.group == 0u ? params.width : params.height) - 1u;
  LineSpring before = no_line_spring();
  vec3 d_before = vec3(0.0f);
  float diagonal = line_diagonal(params.inverse_dt2);
  uvec2 pa = pixel_of_line(n, 0u);
  vec4 a = load_point(pa);
  float wa = weight_in_line(pa, a);
  for (uint k = 0u; k < springs; ++k) {
    uvec2 pb = pixel_of_line(n, k + 1u);
    vec4 b = load_point(pb);
    float wb = weight_in_line(pb, b);
    float longest = longest_in_line(pa);
    precise vec3 d = longest > 0.0f ? b.xyz - a.xyz : vec3(0.0f);
    before = line_spring(before, d_before, d, wa, wb, longest, diagonal);
    imageStore(normal_image, texel(pa), vec4(before.coupling, before.multiplier, longest, wa));
    d_before = d;
    pa = pb;
    a = b;
    wa = wb;
  }
  uvec2 pb = pa;
  vec4 b = a;
  float wb = wa;
  bool has_next = false;  // what is known of the spring from b on
  vec3 step_of_next = vec3(0.0f);
  float coupling_of_next = 0.0f;
  float multiplier = 0.0f;
  for (uint k = springs; k > 0u; --k) {
    pa = pixel_of_line(n, k - 1u);
    a = load_point(pa);
    vec4 own = imageLoad(normal_image, texel(pa));
    bool has_own = own.z > 0.0f;
    multiplier = line_multiplier(own.y, coupling_of_next, multiplier);
    precise vec3 step = has_own ? (b.xyz - a.xyz) * multiplier : vec3(0.0f);
    move_in_line(pb, b, wb, step_of_next, step, has_own || has_next);
    pb = pa;
    b = a;
    wb = own.w;
    has_next = has_own;
    step_of_next = step;
    coupling_of_next = own.x;
  }
  move_in_line(pb, b, wb, step_of_next, vec3(0.0f), has_next);
}
