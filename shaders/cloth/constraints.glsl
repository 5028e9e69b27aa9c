// SPDX-License-Identifier: Apache-2.0
// One projection of a spring or a bend between pixels, written in place.
#include "../lib/bend.h"
#include "../lib/spring.h"

// @return the new multiplier
float project_spring(uvec2 pa, uvec2 pb, float rest, float compliance, float share, float multiplier) {
  vec4 a = load_point(pa);
  vec4 b = load_point(pb);
  precise float scaled = compliance * params.inverse_dt2;
  vec3 d = way_between(pa, a, pb, b);
  SpringMove move;
  if (params.fine == kFineMomentum) {
    move = spring_move_along(d, first_way_between(pa, pb), a.w, b.w, rest, scaled, share, multiplier);
  } else {
    move = spring_move(d, a.w, b.w, rest, scaled, share, multiplier);
  }
  store_point(pa, shifted(a.xyz, move.step, a.w), a.w);
  store_point(pb, shifted(b.xyz, -move.step, b.w), b.w);
  return move.multiplier;
}

// @return the new multiplier
float project_bend(uvec2 pa, uvec2 pm, uvec2 pb, float middle_share, float chord, float rest, float compliance,
                   float multiplier) {
  vec4 a = load_point(pa);
  vec4 m = load_point(pm);
  vec4 b = load_point(pb);
  precise float scaled = compliance * params.inverse_dt2;
  BendMove move = bend_move(way_between(pm, m, pa, a), a.w, m.w, way_between(pm, m, pb, b), b.w, middle_share, chord,
                            rest, scaled, multiplier);
  precise float weight_a = a.w * (1.0f - chord);
  precise float weight_b = b.w * chord;
  store_point(pa, shifted(a.xyz, -move.step, weight_a), a.w);
  store_point(pm, shifted(m.xyz, move.step, m.w), m.w);
  store_point(pb, shifted(b.xyz, -move.step, weight_b), b.w);
  return move.multiplier;
}
