// SPDX-License-Identifier: Apache-2.0
// One distance constraint. Macklin, Mueller, Chentanez 2016, "XPBD: Position-Based Simulation of Compliant Constrained
// Dynamics", equations 17 and 18, with gradients +-(b - a) / |b - a|.
#ifndef GEOCLOTH_LIB_SPRING_H
#define GEOCLOTH_LIB_SPRING_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// The end a moves by step * wa, the end b by -step * wb.
struct SpringMove {
  vec3 step;
  float multiplier;
};

// @param d           [m] from a to b
// @param wa, wb      inverse masses [1/kg]
// @param rest        [m]; 0: no spring, the ends stay
// @param compliance  [m/N] divided by dt^2
// @param share       share of the error to remove: 1, or the seeds' stiffness
// @param multiplier  sum of the multipliers of earlier relaxation steps of this substep
inline SpringMove spring_move(vec3 d, float wa, float wb, float rest, float compliance, float share, float multiplier) {
  precise float l = length3(d);
  precise float w = wa + wb;
  bool has_length = rest > 0.0f && w > 0.0f && l > 1e-12f;
  precise float error = (l - rest) + compliance * multiplier;
  precise float change = has_length ? share * error * (1.0f / (has_length ? w + compliance : 1.0f)) : 0.0f;
  precise vec3 step = d * (change * (1.0f / (has_length ? l : 1.0f)));
  precise float sum = multiplier - change;
  SpringMove r;
  r.step = step;
  r.multiplier = sum;
  return r;
}

// Of the turn of a spring in a substep. A spring of length l that is pulled along where it was l0 has a length of
// l tan(turn) left, so beyond 45 degrees it would grow from step to step.
const float kSmallestCosine = 0.75f;

// The same along the direction that the spring had when the substep began (Ryckaert, Ciccotti, Berendsen 1977,
// "SHAKE"): impulses that are central where the points were keep the angular momentum, those where they are lose the
// share w^2 dt of a spin w in a second. A spring that turned too far (a collider has thrown it) is pulled as it lies.
// @param start  [m] from a to b when the substep began
inline SpringMove spring_move_along(vec3 d, vec3 start, float wa, float wb, float rest, float compliance, float share,
                                    float multiplier) {
  precise float l = length3(d);
  precise float l0 = length3(start);
  precise float w = wa + wb;
  bool has_length = rest > 0.0f && w > 0.0f && l > 1e-12f && l0 > 1e-12f;
  precise float inverse_l = 1.0f / (has_length ? l : 1.0f);
  precise float inverse_l0 = 1.0f / (has_length ? l0 : 1.0f);
  precise float cosine = dot3(d, start) * inverse_l0 * inverse_l;
  if (cosine < kSmallestCosine) return spring_move(d, wa, wb, rest, compliance, share, multiplier);
  precise float error = (l - rest) + compliance * multiplier;
  precise float change = has_length ? share * error * (1.0f / (has_length ? w * cosine + compliance : 1.0f)) : 0.0f;
  precise vec3 step = start * (change * inverse_l0);
  precise float sum = multiplier - change;
  SpringMove r;
  r.step = step;
  r.multiplier = sum;
  return r;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
