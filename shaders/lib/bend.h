// SPDX-License-Identifier: Apache-2.0
// Bending with a rigidity: three pixels in a row, as in the discrete elastica; XPBD as in spring.h.
//
//   a --- h1 --- m --- h2 --- b      e = (1 - f) a + f b - m with f = h1 / (h1 + h2): from m to the chord,
//                                    curvature = 2 |e| / (h1 h2)
//
// The energy B A curvature^2 / 2 of the area A with the rigidity B is that of the constraint |e| = rest with the
// compliance (h1 h2)^2 / (4 B A). The three impulses lie along e and add up to nothing, and so do their moments.
//
//   a -- h1 -- m                     Where the row turns within the flat sheet, e would not vanish there, and cloth
//   that
//             / \  \                 is soft beside its rigidity would be pulled out of shape. A fourth point c beside
//            c   \    h2              the middle takes the turn up: e = (1 - f) a + f b - g c - (1 - g) m with f and g
//                 b                  so chosen that at rest e has no part within the sheet. |e| = u curvature with u =
//                                    ((1 - f) |a - m|^2 + f |b - m|^2 - g |c - m|^2) / 2, and the compliance is
//                                    u^2 / (B A).
//
//   a === h1 === m --- h2 --- b      Where a and m stay, cloth is clamped at m: it bends over half of h2 and not over
//                                    half of both, so that it is (h1 + h2) / h2 times as stiff.
#ifndef GEOCLOTH_LIB_BEND_H
#define GEOCLOTH_LIB_BEND_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// The end a moves by -step * (wa * (1 - chord)), the middle by step * wm, the end b by -step * (wb * chord).
struct BendMove {
  vec3 step;
  float multiplier;
};

// f above; 0 where a rest length is missing.
inline float chord_share(float h1, float h2) {
  precise float h = h1 + h2;
  precise float f = h > 0.0f ? h1 * (1.0f / (h > 0.0f ? h : 1.0f)) : 0.0f;
  return f;
}

// Inverse mass [1/kg] of a bend: those of its points, each times the square of its weight in e.
inline float bend_weight(float wa, float wm, float wb, float chord) {
  precise float back = 1.0f - chord;
  precise float w = wa * back * back + wm + wb * chord * chord;
  return w;
}

// What a clamp leaves of the compliance.
// @param wa, wm, wb  inverse masses [1/kg]
inline float clamped_share(float wa, float wm, float wb, float chord) {
  precise float back = 1.0f - chord;
  bool clamped = wm == 0.0f && (wa == 0.0f) != (wb == 0.0f);
  precise float share = clamped ? (wa == 0.0f ? back : chord) : 1.0f;
  return share;
}

// @param e  [m] as above
// @param w  inverse masses [1/kg], each times the square of its point's weight in e
// @param multiplier    sum of the multipliers of earlier relaxation steps of this substep
inline BendMove bend_move_along(vec3 e, float w, float rest, float compliance, float multiplier) {
  precise float l = length3(e);
  bool bent = compliance > 0.0f && l > 1e-12f;
  precise float error = (l - rest) + compliance * multiplier;
  precise float change = bent ? error * (1.0f / (bent ? w + compliance : 1.0f)) : 0.0f;
  precise vec3 step = e * (change * (1.0f / (bent ? l : 1.0f)));
  precise float sum = multiplier - change;
  BendMove r;
  r.step = step;
  r.multiplier = sum;
  return r;
}

// @param to_a, to_b  [m] from the middle to the ends
// @param wa, wm, wb  inverse masses [1/kg]
// @param chord       f above
// @param rest        [m] |e| at rest
// @param compliance  [m/N] divided by dt^2; 0: no bend, the three stay
inline BendMove bend_move(vec3 to_a, float wa, float wm, vec3 to_b, float wb, float chord, float rest, float compliance,
                          float multiplier) {
  precise float back = 1.0f - chord;
  precise vec3 e = to_a * back + to_b * chord;
  float w = bend_weight(wa, wm, wb, chord);
  precise float left = compliance * clamped_share(wa, wm, wb, chord);
  return bend_move_along(e, w, rest, left, multiplier);
}

// With a fourth point, which moves by step * (wc * turn); the middle moves by step * (wm * (1 - turn)).
// @param to_c          [m] from the middle to it
// @param middle_share  share of the middle point's mass that this copy of it carries, 1 without a seam: the whole point
//                      is what yields, and the copy is moved so far that the stitch moves the point right
// @param turn          g above; 0: it is left out
inline BendMove turned_bend_move(vec3 to_a, float wa, float wm, vec3 to_b, float wb, vec3 to_c, float wc,
                                 float middle_share, float chord, float turn, float rest, float compliance,
                                 float multiplier) {
  precise float back = 1.0f - chord;
  precise float kept = 1.0f - turn;
  precise vec3 e = to_a * back + to_b * chord - to_c * turn;
  precise float w = wa * back * back + wm * middle_share * kept * kept + wb * chord * chord + wc * turn * turn;
  precise float left = compliance * clamped_share(wa, wm, wb, chord);
  return bend_move_along(e, w, rest, left, multiplier);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
