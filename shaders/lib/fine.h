// SPDX-License-Identifier: Apache-2.0
// Steps so small that single precision cannot show them. In a substep of 1/14400 s gravity moves a point by 5e-8 m,
// less than positions of a metre are rounded by, and each rounding by a constraint is a kick of 4e-4 m/s. So a position
// is the sum of two floats, base + offset. Within a substep the base stays where the point was and the offset, small
// and precise, is what the constraints see and move; differences of bases are exact. `settle` makes the next base.
//
//   predict   base = previous, offset = low + the predicted way, and `carry` keeps low, the offset at the start
//   settle    position = base + offset, offset = low = what that rounds off, previous and carry as without offsets
#ifndef GEOCLOTH_LIB_FINE_H
#define GEOCLOTH_LIB_FINE_H

#include "../shared/layout.h"
#include "predict.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

inline vec3 predicted_offset(PointState next, vec3 low) {
  precise vec3 r = low + way_of(next);
  return r;
}

struct Settled {
  PointState point;
  vec3 low;
};

inline Settled settle(vec3 base, vec3 offset, vec3 low) {
  precise vec3 position = base + offset;
  precise vec3 rest = offset - (position - base);
  precise vec3 way = offset - low;
  Settled r;
  r.point = arrived(position, way);
  r.low = rest;
  return r;
}

// A pin with its target seen from the base of its point, for pinned_position() on offsets.
inline PinTarget pin_from(PinTarget pin, vec3 base) {
  precise vec3 target = xyz(pin.target) - base;
  precise vec3 start = xyz(pin.start) - base;
  PinTarget r = pin;
  r.target = vec4(target, pin.target.w);
  r.start = vec4(start, pin.start.w);
  return r;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
