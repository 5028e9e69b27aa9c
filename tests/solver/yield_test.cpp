// SPDX-License-Identifier: GPL-3.0-or-later
// How far points give way that carry much at a contact, lib/yield.h: where it settles decides whether cloth is pierced,
// and what the ends of a spring share whether it is as stiff as without.

#include "lib/yield.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace geocloth::shader {
namespace {

constexpr float kSpacing = 0.01F;

/// Substep after substep springs draw a point in as far as it gives way.
/// @param by  [m] as far as they would if it gave way fully
float settled_yield(float by, int substeps) {
  float yield = 1;
  for (int s = 0; s < substeps; ++s) yield = next_yield(yield, vec3(0, by * yield, 0), kSpacing);
  return yield;
}

TEST(Yield, SettlesWhereALoadedPointIsDrawnInByATenthOfTheSpacing) {
  for (const float by : {0.0012F, 0.002F, 0.0049F}) {
    const float moved = by * settled_yield(by, 20);
    EXPECT_LE(moved, kDrawn * kSpacing) << by;
    EXPECT_GE(moved, 0.25F * kDrawn * kSpacing) << by;
    EXPECT_EQ(settled_yield(by, 20), settled_yield(by, 21)) << "it must not tremble";
  }
}

TEST(Yield, OfAPointThatCarriesLittleIsWhole) {
  const float weight = 9.81F / (480 * 480);  // what gravity does in a substep
  EXPECT_EQ(settled_yield(weight, 20), 1);
  float yield = kLeastYield;
  for (int s = 0; s < 10; ++s) yield = next_yield(yield, vec3(0, 0, 0), kSpacing);
  EXPECT_EQ(yield, 1) << "once nothing holds it any more";
}

TEST(Yield, OfAPointThatBeganDeepInAColliderStays) {
  EXPECT_EQ(next_yield(1, vec3(0.1F, 0, 0), kSpacing), 1);
  EXPECT_EQ(next_yield(0.25F, vec3(0.1F, 0, 0), kSpacing), 0.25F);
}

TEST(Yield, LeavesASpringAsMuchMotionAndSharesIt) {
  const float wa = 1234.5F, wb = 777.7F;
  const Weights whole = yielding(wa, 1, wb, 1);
  EXPECT_EQ(whole.a, wa);
  EXPECT_EQ(whole.b, wb);
  const Weights held = yielding(wa, 1.F / 64, wb, 1);
  EXPECT_NEAR(held.a + held.b, wa + wb, 1e-3);
  EXPECT_NEAR(held.a / held.b, wa / wb / 64, 1e-6);
  const Weights pinned = yielding(0, 1, wb, 1.F / 64);
  EXPECT_EQ(pinned.a, 0);
  EXPECT_NEAR(pinned.b, wb, 1e-3);
  const Weights both_pinned = yielding(0, 1, 0, 1);
  EXPECT_EQ(both_pinned.a + both_pinned.b, 0);
}

TEST(Yield, KeepsItsPlaceInAnInverseMass) {
  for (const float mass_inverse : {inverse_mass_of(65536.7F), inverse_mass_of(1e-3F), 0.F}) {
    EXPECT_EQ(with_yield(mass_inverse, 1), mass_inverse) << "what gives way fully is as it was";
    for (float yield = 1; yield >= kLeastYield; yield *= 0.5F) {
      const float packed = with_yield(mass_inverse, yield);
      EXPECT_EQ(yield_of(packed), yield);
      EXPECT_EQ(inverse_mass_of(packed), mass_inverse);
    }
  }
  EXPECT_NEAR(inverse_mass_of(65536.7F), 65536.7F, 65536.7F * 2e-6F);
}

}  // namespace
}  // namespace geocloth::shader
