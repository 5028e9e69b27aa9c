// SPDX-License-Identifier: Apache-2.0
// The mass-weighted mean of the copies of a point. Each copy carries the mass of the cloth on its side, so the mean
// keeps the momentum. Summed relative to the first copy: equal copies give exactly their position.
#ifndef GEOCLOTH_LIB_STITCH_H
#define GEOCLOTH_LIB_STITCH_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

struct StitchSum {
  vec3 moment;  // [kg m] relative to the first copy
  float mass;   // [kg]
};

// @param first, copy  xyz position, w inverse mass > 0 (pinned points are not stitched: their copies are set together)
inline StitchSum stitch_add(StitchSum sum, vec4 first, vec4 copy) {
  precise float mass = 1.0f / copy.w;
  precise vec3 moment = sum.moment + (xyz(copy) - xyz(first)) * mass;
  precise float total = sum.mass + mass;
  StitchSum r;
  r.moment = moment;
  r.mass = total;
  return r;
}

inline StitchSum stitch_begin() {
  StitchSum r;
  r.moment = vec3(0.0f, 0.0f, 0.0f);
  r.mass = 0.0f;
  return r;
}

inline vec3 stitch_mean(StitchSum sum, vec4 first) {
  precise vec3 mean = xyz(first) + sum.moment * (1.0f / sum.mass);
  return mean;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
