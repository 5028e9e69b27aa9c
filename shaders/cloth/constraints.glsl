// SPDX-License-Identifier: Apache-2.0
// Projections of springs and bends. Those of a group or a colour share no pixel, so they are written in place.
#include "../lib/bend.h"
#include "../lib/bend_groups.h"
#include "../lib/span.h"
#include "../lib/spring.h"
#include "../lib/spring_groups.h"
#include "../lib/yield.h"

// See lib/yield.h; without colliders nothing is held.
float yield_at(vec4 point) {
  return params.collider_count != 0u ? yield_of(point.w) : 1.0f;
}

// Moves the ends of a spring, loaded by load_point().
void move_ends(uvec2 pa, vec4 a, uvec2 pb, vec4 b, vec3 step) {
  Weights moves = yielding(inverse_mass_of(a.w), yield_at(a), inverse_mass_of(b.w), yield_at(b));
  store_point(pa, shifted(a.xyz, step, moves.a), a.w);
  store_point(pb, shifted(b.xyz, -step, moves.b), b.w);
}

// @return the new multiplier
float project_spring(uvec2 pa, uvec2 pb, float rest, float compliance, float share, float multiplier) {
  vec4 a = load_point(pa);
  vec4 b = load_point(pb);
  precise float scaled = compliance * params.inverse_dt2;
  vec3 d = way_between(pa, a, pb, b);
  float wa = inverse_mass_of(a.w);
  float wb = inverse_mass_of(b.w);
  SpringMove move;
  if (fine_mode() == kFineMomentum) {
    move = spring_move_along(d, first_way_between(pa, pb), wa, wb, rest, scaled, share, multiplier);
  } else {
    move = spring_move(d, wa, wb, rest, scaled, share, multiplier);
  }
  move_ends(pa, a, pb, b, move.step);
  return move.multiplier;
}

// @return the new multiplier; constants.count is what the compliance is multiplied by
float project_bend(uvec2 pa, uvec2 pm, uvec2 pb, float chord, float rest, float compliance, float multiplier) {
  vec4 a = load_point(pa);
  vec4 m = load_point(pm);
  vec4 b = load_point(pb);
  precise float scaled = compliance * (params.inverse_dt2 * float(constants.count));
  float wa = inverse_mass_of(a.w);
  float wm = inverse_mass_of(m.w);
  float wb = inverse_mass_of(b.w);
  BendMove move = bend_move(way_between(pm, m, pa, a), wa, wm, way_between(pm, m, pb, b), wb, chord, rest, scaled,
                            multiplier);
  precise float weight_a = wa * (1.0f - chord) * yield_at(a);
  precise float weight_m = wm * yield_at(m);
  precise float weight_b = wb * chord * yield_at(b);
  store_point(pa, shifted(a.xyz, -move.step, weight_a), a.w);
  store_point(pm, shifted(m.xyz, move.step, weight_m), m.w);
  store_point(pb, shifted(b.xyz, -move.step, weight_b), b.w);
  return move.multiplier;
}

float multiplier_so_far(uint slot) {
  return constants.read_multiplier != 0u ? multipliers[slot] : 0.0f;
}

void keep_multiplier(uint slot, float multiplier) {
  if (constants.write_multiplier != 0u) multipliers[slot] = multiplier;
}

// What an image of a family holds for its first or its second component.
vec2 of_component(uint component, vec4 family) {
  return component % 2u == 0u ? family.xy : family.zw;
}

// The spring of the group constants.group that starts at pixel pa. @param family  structural, shear, bending
void spring_at(uint family, uvec2 pa) {
  uint component = group_component(constants.group);
  vec2 rest = of_component(component, family == 0u   ? imageLoad(structural_image, texel(pa))
                                      : family == 1u ? imageLoad(shear_image, texel(pa))
                                                     : imageLoad(bending_image, texel(pa)));
  uvec2 pb = spring_end(component, pa.x, pa.y);
  if (rest.x == 0.0f || !is_here(pb)) return;
  float share = family == 0u   ? params.share_structural
                : family == 1u ? params.share_shear
                               : params.share_bending;
  uint slot = component * params.width * params.height + pa.y * params.width + pa.x;
  keep_multiplier(slot, project_spring(pa, pb, rest.x, rest.y, share, multiplier_so_far(slot)));
}

void pull_span(uvec2 pa, uvec2 pb, float rest, float share) {
  vec4 a = load_point(pa);
  vec4 b = load_point(pb);
  precise float longest = rest * params.stretch_limit;
  SpanMove move =
      span_move(way_between(pa, a, pb, b), inverse_mass_of(a.w), inverse_mass_of(b.w), longest, share);
  if (move.pulls) move_ends(pa, a, pb, b, move.step);
}

// The span of the group constants.group that starts at pixel pa; it is there where all its springs are.
void span_at(uvec2 pa) {
  bool down = span_component(constants.group) == 1u;
  uvec2 next = down ? uvec2(0u, 1u) : uvec2(1u, 0u);
  uint pixels = pixels_of_span(constants.group);
  uvec2 pb = pa + next * pixels;
  if (pb.x >= params.width || pb.y >= params.height || !is_here(pb)) return;
  precise float rest = 0.0f;
  for (uint i = 0u; i < pixels; ++i) {
    vec4 springs = imageLoad(structural_image, texel(pa + next * i));
    float own = down ? springs.z : springs.x;
    if (own == 0.0f) return;
    rest = rest + own;
  }
  pull_span(pa, pb, rest, span_share(constants.group));
}

// A structural spring of the group constants.group as a span of one pixel.
void tie_at(uvec2 pa) {
  uint component = group_component(constants.group);
  float rest = of_component(component, imageLoad(structural_image, texel(pa))).x;
  uvec2 pb = spring_end(component, pa.x, pa.y);
  float share = constants.read_multiplier != 0u ? kTieShare : 1.0f;
  if (rest != 0.0f && is_here(pb)) pull_span(pa, pb, rest, share);
}

// The bend of the group constants.group over three pixels that starts at pixel pa.
void bend_at(uvec2 pa) {
  uint component = bend_component(constants.group);
  vec2 rest = of_component(component, imageLoad(bending_image, texel(pa)));
  uvec2 pm = spring_end(component - 4u, pa.x, pa.y);
  uvec2 pb = spring_end(component, pa.x, pa.y);
  if (rest.y == 0.0f || !is_here(pb)) return;
  float chord = chord_share(of_component(component, imageLoad(structural_image, texel(pa))).x,
                            of_component(component, imageLoad(structural_image, texel(pm))).x);
  uint slot = component * params.width * params.height + pa.y * params.width + pa.x;
  keep_multiplier(slot, project_bend(pa, pm, pb, chord, rest.x, rest.y, multiplier_so_far(slot)));
}

uint slot_of_seam_bend(uint i) {
  return kSpringComponents * params.width * params.height + i;
}

void seam_bend_at(uint i) {
  SeamSpring bend = seam_springs[i];
  uint slot = slot_of_seam_bend(i);
  keep_multiplier(slot, project_spring(pixel_at(bend.a), pixel_at(bend.b), bend.rest, bend.compliance,
                                       params.share_bending, multiplier_so_far(slot)));
}

void seam_curvature_at(uint i) {
  SeamSpring bend = seam_springs[i];
  uint slot = slot_of_seam_bend(i);
  uvec2 pa = pixel_at(bend.a);
  uvec2 pm = pixel_at(bend.middle);
  uvec2 pb = pixel_at(bend.b);
  uvec2 pc = pixel_at(bend.beside);
  vec4 a = load_point(pa);
  vec4 m = load_point(pm);
  vec4 b = load_point(pb);
  vec4 c = load_point(pc);
  precise float scaled = bend.compliance * params.inverse_dt2;
  float wa = inverse_mass_of(a.w);
  float wm = inverse_mass_of(m.w);
  float wb = inverse_mass_of(b.w);
  float wc = inverse_mass_of(c.w);
  BendMove move = turned_bend_move(way_between(pm, m, pa, a), wa, wm, way_between(pm, m, pb, b), wb,
                                   way_between(pm, m, pc, c), wc, bend.middle_share, bend.chord, bend.turn, bend.rest,
                                   scaled, multiplier_so_far(slot));
  precise float weight_a = wa * (1.0f - bend.chord) * yield_at(a);
  precise float weight_m = wm * (1.0f - bend.turn) * yield_at(m);
  precise float weight_b = wb * bend.chord * yield_at(b);
  precise float weight_c = wc * bend.turn * yield_at(c);
  store_point(pa, shifted(a.xyz, -move.step, weight_a), a.w);
  store_point(pm, shifted(m.xyz, move.step, weight_m), m.w);
  store_point(pb, shifted(b.xyz, -move.step, weight_b), b.w);
  if (bend.turn != 0.0f) store_point(pc, shifted(c.xyz, move.step, weight_c), c.w);
  keep_multiplier(slot, move.multiplier);
}

void seam_span_at(uint i) {
  SeamSpring span = seam_springs[i];
  pull_span(pixel_at(span.a), pixel_at(span.b), span.rest, 1.0f);
}

void sew_at(uint i) {
  SeamSpring thread = seam_springs[i];
  precise float longest = thread.rest * sewing_share(params.sewing_before, params.sewing_after,
                                                     substeps[constants.substep].frame_fraction);
  uvec2 pa = pixel_at(thread.a);
  uvec2 pb = pixel_at(thread.b);
  vec4 a = load_point(pa);
  vec4 b = load_point(pb);
  SpanMove move = span_move(way_between(pa, a, pb, b), inverse_mass_of(a.w), inverse_mass_of(b.w), longest, 1.0f);
  if (move.pulls) move_ends(pa, a, pb, b, move.step);
}

// Copies of a point lie on each other.
void place_copies(uint pixel, uint row, vec3 place) {
  if (row == kNoRow) {
    store_point(pixel_at(pixel), place, load_point(pixel_at(pixel)).w);
    return;
  }
  for (uint i = split_offset[row]; i < split_offset[row + 1u]; ++i) {
    uvec2 p = pixel_at(split_pixel[i]);
    store_point(p, place, load_point(p).w);
  }
}

void whole_tie_at(uint i) {
  SeamSpring tie = seam_springs[i];
  vec4 a = load_point(pixel_at(tie.a));
  vec4 b = load_point(pixel_at(tie.b));
  float wa = whole_tie_weight(a.w);
  float wb = whole_tie_weight(b.w);
  float share = constants.read_multiplier != 0u ? kTieShare : 1.0f;
  precise float longest = tie.rest * params.stretch_limit;
  SpanMove move = span_move(way_between(pixel_at(tie.a), a, pixel_at(tie.b), b), wa, wb, longest, share);
  if (!move.pulls) return;
  place_copies(tie.a, tie.row_a, shifted(a.xyz, move.step, wa));
  place_copies(tie.b, tie.row_b, shifted(b.xyz, -move.step, wb));
}
