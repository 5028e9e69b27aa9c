// SPDX-License-Identifier: Apache-2.0
// Cloth on a moving parent (a rider's cape, a dancer's skirt). The parent's motion in a substep is a turn about a
// centre near the cloth, which goes straight. ClothParams holds two displacement fields: `whole`, the parent's own, and
// `taken`, the share of it that the cloth is taken along with as if it had no inertia. What is left of the motion the
// cloth feels, for its springs and pins pull it after. The stored displacement of a point is the one besides `taken`;
// damping brakes it relative to what is left of `whole`.
#ifndef GEOCLOTH_LIB_FRAME_H
#define GEOCLOTH_LIB_FRAME_H

#include "../shared/layout.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// The linear part of a displacement field: (R - 1) v.
inline vec3 field_turn(FrameField field, vec3 v) {
  return vec3(dot3(xyz(field.row0), v), dot3(xyz(field.row1), v), dot3(xyz(field.row2), v));
}

// Displacement of the point p in a substep.
inline vec3 field_at(FrameField field, float substep, vec3 p) {
  precise vec3 shift = vec3(field.row0.w, field.row1.w, field.row2.w) + xyz(field.drift) * substep;
  precise vec3 r = field_turn(field, p) + shift;
  return r;
}

// Where the point was that the field has taken to p: the inverse of p + field_at(p), for R is a rotation.
inline vec3 field_back(FrameField field, float substep, vec3 p) {
  precise vec3 shift = vec3(field.row0.w, field.row1.w, field.row2.w) + xyz(field.drift) * substep;
  precise vec3 q = p - shift;
  precise vec3 turn = xyz(field.row0) * q.x + xyz(field.row1) * q.y + xyz(field.row2) * q.z;
  precise vec3 r = q + turn;
  return r;
}

struct FramedStep {
  vec3 start;  // the position, taken along
  vec3 way;    // the displacement of the last substep, turned and damped, with what rounding took from the start
};

inline FramedStep take_along(ClothParams params, float substep, vec3 position, vec3 way) {
  precise vec3 taken = field_at(params.taken, substep, position);
  precise vec3 left = field_at(params.whole, substep, position) - taken;
  precise vec3 turned = way + field_turn(params.taken, way);
  precise vec3 start = position + taken;
  precise vec3 lost = taken - (start - position);
  precise vec3 damped = left + (turned - left) * params.keep + lost;
  FramedStep r;
  r.start = start;
  r.way = damped;
  return r;
}

// Whether a point did not go along with the carrier in the last substep: cloth on a running body hardly moves as seen
// from the body. The parent's share is part of its way.
inline bool is_left_behind(ClothParams params, vec3 position, vec3 way) {
  if (params.carried_at < 0.0f) return false;
  precise vec3 taken_to = position - way;
  vec3 start = params.moving != 0u ? field_back(params.taken, params.carried_at, taken_to) : taken_to;
  precise vec3 seen = (way + (taken_to - start)) - field_at(params.carrier, params.carried_at, start);
  return length3(seen) > params.left_behind;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
