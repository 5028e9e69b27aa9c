// SPDX-License-Identifier: Apache-2.0
// How far a point gives way to its springs while a collider holds it.
//
// A few points on a pole, an edge or a corner carry the cloth that hangs from them. By its mass each of them would be
// drawn through the collider in one substep, hundreds of times as far as its own weight takes it, and comes out beside
// where it was: the cells about it open until the collider is through. So a point that a collider had to move by much
// gives way only a part of what its mass lets it, the next substep's springs move its neighbours instead, and all of
// the error of a spring is taken away as before: it is shared otherwise. The part is what makes the collider's own move
// a tenth of the spacing. Friction stays Coulomb's, as what draws a point in and what draws it along become less by the
// same part; and what carries little more than itself, cloth on a floor or a garment on a body, gives way as ever.
#ifndef GEOCLOTH_LIB_YIELD_H
#define GEOCLOTH_LIB_YIELD_H

#include "../shared/types.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const float kDrawn = 0.1f;                // spacings that a collider moves a point by in a substep, at most for long
const float kThrown = 0.5f;               // spacings: further than springs draw a point; it began deep in a collider
const float kLeastYield = 0.0009765625f;  // 2^-10
const uint kYieldBits = 15u;              // of an inverse mass: the lowest ones of its mantissa
const uint kYieldExponent = 127u;         // of 1

// @param yield  of the last substep, a power of two
// @param moved  [m] by colliders in it
inline float next_yield(float yield, vec3 moved, float spacing) {
  precise float way2 = dot3(moved, moved);
  precise float drawn = kDrawn * spacing;
  precise float thrown = kThrown * spacing;
  precise float drawn2 = drawn * drawn;
  float r = yield;
  if (way2 > thrown * thrown) return r;
  if (way2 < 0.0625f * drawn2) r = 2.0f * r;  // below a quarter of it
  if (way2 > drawn2) r = 0.5f * r;
  if (way2 > 4.0f * drawn2) r = 0.5f * r;
  if (way2 > 16.0f * drawn2) r = 0.5f * r;
  return min(max(r, kLeastYield), 1.0f);
}

// The same of a triangle's corner, which may be one of others that are moved: the point's own contact lets it give way
// again.
inline float lessened_yield(float yield, vec3 moved, float spacing) {
  return min(yield, next_yield(yield, moved, spacing));
}

struct Weights {
  float a;
  float b;
};

// What the ends of a spring are moved by in place of their inverse masses wa and wb: as much together.
inline Weights yielding(float wa, float yield_a, float wb, float yield_b) {
  precise float a = wa * yield_a;
  precise float b = wb * yield_b;
  precise float whole = (wa + wb) * (1.0f / max(a + b, 1e-30f));
  bool both = yield_a == 1.0f && yield_b == 1.0f;
  precise float moves_a = a * whole;
  precise float moves_b = b * whole;
  Weights r;
  r.a = both ? wa : moves_a;
  r.b = both ? wb : moves_b;
  return r;
}

// Images keep both in one number.
inline float inverse_mass_of(float w) {
  return uintBitsToFloat(floatBitsToUint(w) & ~kYieldBits);
}

inline float yield_of(float w) {
  return uintBitsToFloat((kYieldExponent - (floatBitsToUint(w) & kYieldBits)) << 23u);
}

inline float with_yield(float mass_inverse, float yield) {
  return uintBitsToFloat((floatBitsToUint(mass_inverse) & ~kYieldBits) |
                         (kYieldExponent - (floatBitsToUint(yield) >> 23u)));
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
