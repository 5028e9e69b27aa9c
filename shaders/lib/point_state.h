// SPDX-License-Identifier: Apache-2.0
// A point on its way through a substep. `carry` is the part of its way that position - previous cannot show in single
// precision: without it the energy of a cloth grows at many substeps. And less what position - previous shows that is
// no way of it: how far the points of other layers have moved it, which gives no speed.
#ifndef GEOCLOTH_LIB_POINT_STATE_H
#define GEOCLOTH_LIB_POINT_STATE_H

#include "../shared/types.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

struct PointState {
  vec3 position;
  vec3 previous;
  vec3 carry;
};

inline vec3 way_of(PointState point) {
  precise vec3 way = (point.position - point.previous) + point.carry;
  return way;
}

// The point that is at `position` after it went `way`.
inline PointState arrived(vec3 position, vec3 way) {
  precise vec3 previous = position - way;
  precise vec3 carry = way - (position - previous);
  PointState r;
  r.position = position;
  r.previous = previous;
  r.carry = carry;
  return r;
}

// The point moved to `position` by others, with the way `way`.
inline PointState moved_to(PointState point, vec3 position, vec3 way) {
  precise vec3 carry = way - (position - point.previous);
  PointState r;
  r.position = position;
  r.previous = point.previous;
  r.carry = carry;
  return r;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
