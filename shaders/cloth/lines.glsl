// SPDX-License-Identifier: Apache-2.0
// Line relaxation: one invocation for each row or column.
#include "../lib/lines.h"
#include "../lib/yield.h"

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
  return line_weight(inverse_mass_of(point.w), imageLoad(cell_image, texel(p)).x);
}

// Coupling and multiplier of every spring.
void find_line_springs(uint n, uint springs) {
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
    imageStore(normal_image, texel(pa), vec4(before.coupling, before.multiplier, 0.0f, 0.0f));
    d_before = d;
    pa = pb;
    a = b;
    wa = wb;
  }
}

// Of every point place and coupling of line_point(), and beside its previous, which keeps the way, the multiplier.
void find_line_multipliers(uint n, uint springs) {
  LinePoint point = no_line_point();
  float coupling = 0.0f;  // of the spring from k on
  float multiplier = 0.0f;
  for (uint k = springs + 1u; k-- > 0u;) {
    uvec2 p = pixel_of_line(n, k);
    vec4 position = load_point(p);
    vec3 previous = load_previous(p).xyz;
    float before = 0.0f;
    if (k > 0u) {
      vec4 spring = imageLoad(normal_image, texel(pixel_of_line(n, k - 1u)));
      before = line_multiplier(spring.y, coupling, multiplier);
      coupling = spring.x;
    }
    bool is_held = position.w == 0.0f;
    point = line_point(point, position.xyz, is_held ? vec3(0.0f) : previous, weight_in_line(p, position), before,
                       multiplier);
    imageStore(normal_image, texel(p), vec4(point.place, point.coupling));
    store_previous(p, vec4(is_held ? previous : point.way, multiplier));
    multiplier = before;
  }
}

void move_line_points(uint n, uint springs) {
  vec3 step_before = vec3(0.0f);
  bool has_before = false;
  uvec2 p = pixel_of_line(n, 0u);
  vec4 from = load_point(p);
  vec4 previous = load_previous(p);
  vec3 place = imageLoad(normal_image, texel(p)).xyz;
  for (uint k = 0u; k <= springs; ++k) {
    float longest = k < springs ? longest_in_line(p) : 0.0f;
    bool has_own = longest > 0.0f;
    uvec2 p_next = pixel_of_line(n, min(k + 1u, springs));
    vec4 next = load_point(p_next);
    vec4 previous_of_next = load_previous(p_next);
    vec4 point = imageLoad(normal_image, texel(p_next));
    vec3 place_of_next = shifted(point.xyz, place, point.w);
    bool is_held = from.w == 0.0f;
    vec3 way = is_held ? vec3(0.0f) : previous.xyz;
    if (next.w != 0.0f) previous_of_next.xyz = shifted(previous_of_next.xyz, way, point.w);
    precise vec3 d = next.xyz - from.xyz;
    precise vec3 after = place_of_next - place;
    vec3 step = has_own ? line_step(d, after, previous.w) : vec3(0.0f);
    float weight = weight_in_line(p, from);
    store_previous(p, vec4(previous.xyz, from.w));
    if (weight != 0.0f && (has_own || has_before))
      store_point(p, line_moved(from.xyz, step, step_before, weight), from.w);
    has_before = has_own;
    step_before = step;
    p = p_next;
    from = next;
    previous = previous_of_next;
    place = place_of_next;
  }
}

// The runs of a line. Normals are made anew after the frame: till then they keep what goes from one sweep to the other.
void line_at(uint n) {
  uint springs = (constants.group == 0u ? params.width : params.height) - 1u;
  find_line_springs(n, springs);
  find_line_multipliers(n, springs);
  move_line_points(n, springs);
}
