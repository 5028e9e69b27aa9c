// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that nobody would build on purpose, but that users make by a slip: garments that start deep inside a collider,
// pins that hold what a collider pushes away. The cloth may look bad there; it must neither explode nor vanish.

#include <algorithm>

#include <gtest/gtest.h>

#include "geocloth/solver/solver.h"
#include "solver_fixture.h"

namespace geocloth {
namespace {

float farthest(const std::vector<Vec3>& positions) {
  float far = 0;
  for (const Vec3& p : positions) far = std::max(far, length(p));
  return far;
}

/// The collider throws the springs round within a substep; pulled along where they were, each got longer with each
/// step.
TEST(Rough, KeptMomentumBearsClothThatStartsInsideACollider) {
  for (const uint32_t substeps : {8U, 16U, 60U}) {
    const ClothDesc cloth = test::describe(test::make_tube({.nx = 48, .ny = 25, .radius = 0.2F, .height = 0.6F}));
    SolverSettings settings = test::cpu_settings();
    settings.keep_momentum = true;
    settings.substeps = substeps;
    Solver solver({&cloth, 1}, settings);
    Collider box;
    box.shape = Box{{0.1F, 0.1F, 0}, {0.5F, 0.25F, 0.11F}, quat_from_euler_deg({20, 30, 40})};
    solver.set_colliders({&box, 1});
    for (int frame = 0; frame < 25; ++frame) {
      solver.step();
      const std::vector<Vec3> x = test::positions_of(solver);
      ASSERT_TRUE(test::all_finite(x)) << substeps << " substeps, frame " << frame;
      ASSERT_LT(farthest(x), 3) << substeps << " substeps, frame " << frame;
    }
  }
}

/// A ball that is smaller than a cell meets its triangles. Where it touches beside a pinned corner the free ones have
/// hardly any weight in the contact, and were thrown hundreds of kilometres to lift it by a millimetre.
TEST(Rough, CornersBesideAPinAreNotThrownByWhatTheTriangleMeets) {
  const test::SheetOptions sheet{.nx = 17, .ny = 17, .width = 1, .height = 1};
  const ClothDesc cloth = test::describe(test::make_sheet(sheet));
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  settings.substeps = 1;
  Solver solver({&cloth, 1}, settings);
  const std::vector<Pin> pins = test::pins_at_rest(*cloth.asset, "top");
  solver.set_pins(0, pins);
  float far = 0;
  for (int frame = 0; frame < 60; ++frame) {
    // Along the pinned row and a little below it, to and fro through the sheet.
    const float along = -0.45F + 0.015F * static_cast<float>(frame);
    const Sphere moved{{along, 0.4995F, frame % 2 == 0 ? -0.02F : 0.02F}, 0.012F};
    const Collider ball{.name = "ball", .shape = moved};
    solver.set_colliders({&ball, 1});
    solver.step();
    const std::vector<Vec3> x = test::positions_of(solver);
    ASSERT_TRUE(test::all_finite(x)) << "frame " << frame;
    far = std::max(far, farthest(x));
  }
  EXPECT_LT(far, 1.0F);  // the sheet's own corners are 0.71 m from the middle
}

}  // namespace
}  // namespace geocloth
