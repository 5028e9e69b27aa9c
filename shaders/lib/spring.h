// SPDX-License-Identifier: Apache-2.0
// One distance constraint. Macklin, Mueller, Chentanez 2016, "XPBD: Position-Based Simulation of Compliant Constrained
// Dynamics", equations 17 and 18, with gradients +-(b - a) / |b - a|.
#ifndef GEOCLOTH_LIB_SPRING_H
#define GEOCLOTH_LIB_SPRING_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

struct SpringEnds {
  vec3 a;
  vec3 b;
  float multiplier;
};

// @param wa, wb      inverse masses [1/kg]
// @param rest        [m]; 0: no spring, the ends stay
// @param compliance  [m/N] divided by dt^2
// @param share       share of the error to remove: 1, or the seeds' stiffness
// @param multiplier  sum of the multipliers of earlier relaxation steps of this substep
inline SpringEnds project_spring(vec3 a, float wa, vec3 b, float wb, float rest, float compliance, float share,
                                 float multiplier) {
  precise vec3 d = b - a;
  precise float l = length3(d);
  precise float w = wa + wb;
  bool has_length = rest > 0.0f && w > 0.0f && l > 1e-12f;
  precise float error = (l - rest) + compliance * multiplier;
  precise float change = has_length ? share * error * (1.0f / (has_length ? w + compliance : 1.0f)) : 0.0f;
  precise vec3 step = d * (change * (1.0f / (has_length ? l : 1.0f)));
  SpringEnds r;
  r.a = a;
  r.b = b;
  precise vec3 moved_a = a + step * wa;
  precise vec3 moved_b = b - step * wb;
  r.a = moved_a;
  r.b = moved_b;
  precise float sum = multiplier - change;
  r.multiplier = sum;
  return r;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
