// SPDX-License-Identifier: Apache-2.0
// What colliders do to a cloth in a frame, summed over its points: of each collider the impulse and its moment about
// the solver's origin, with masses times changes of a substep's way [kg m] in place of impulses. Sums are whole numbers
// of 64 bits, two's complement, so that they are the same in whatever order invocations and threads add to them.
#ifndef GEOCLOTH_LIB_CONTACT_SUM_H
#define GEOCLOTH_LIB_CONTACT_SUM_H

#include "../shared/layout.h"
#include "../shared/types.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kContactValues = 6u;                  // of a collider: x, y, z of the impulse, then of its moment
const uint kContactWords = 2u * kContactValues;  // each of them the low and the high half
const float kLargestContact = 4e18f;             // below 2^62
const float kMostBorne = 64.0f;  // times: no garment at rest has more, and what is thrown at cloth would feel it

struct FixedPoint {
  uint low;
  uint high;
};

// The whole number next to v towards zero; 0 where it is not finite or too large for a sum of some.
inline FixedPoint fixed_point(float v) {
  float size = abs(v);
  bool fits = size < kLargestContact;
  precise float whole = fits ? size : 0.0f;
  precise float high = floor(whole * (1.0f / 4294967296.0f));
  precise float low = whole - high * 4294967296.0f;
  FixedPoint r;
  r.low = uint(low);
  r.high = uint(high);
  if (v < 0.0f) {
    r.low = ~r.low + 1u;
    r.high = ~r.high + (r.low == 0u ? 1u : 0u);
  }
  return r;
}

// Whether what points give way counts: where they are pushed by other points as well, nobody knows by how much springs
// drew on them.
inline bool yield_counts(ClothParams params) {
  return params.self_points == 0u && params.inter_points == 0u;
}

// What a contact would have changed of a point's way if the point gave way to its springs as its mass has it: where it
// gives way less (lib/yield.h) its neighbours move instead, and the collider feels all that they are held by. The point
// lies on the collider, so what presses it there in a substep is its weight and springs, and springs count in full.
// @param n             the contact's normal
// @param gravity_step  ClothParams::gravity_step [m]
inline vec3 borne_way(vec3 changed, vec3 n, vec3 gravity_step, float yield) {
  precise float times = min(1.0f / yield, kMostBorne);
  precise float weight = min(dot3(gravity_step, n), 0.0f);
  precise vec3 r = changed * times + n * ((times - 1.0f) * weight);
  return r;
}

// How much of it the contact of one point adds.
struct ContactShare {
  vec3 impulse;
  vec3 moment;
};

// @param mass_inverse  of the point, above 0 [1/kg]
// @param way           by which the contact has changed what the point goes in a substep [m]
// @param scale         ClothParams::contact_scale
inline ContactShare contact_share(float mass_inverse, vec3 way, vec3 position, float scale) {
  precise float mass = scale * (1.0f / mass_inverse);
  precise vec3 impulse = way * mass;
  precise vec3 moment = cross3(position, impulse);
  ContactShare r;
  r.impulse = impulse;
  r.moment = moment;
  return r;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
