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

/// Torn apart by steps of absurdly different lengths until no point is a number, then put back. The columns beside the
/// cloth, which the cpu's rows have, were left as they were, and spoilt it again a frame later.
TEST(Rough, ClothThatIsNotANumberCanBePutBack) {
  for (const SolverPath path : {SolverPath::automatic, SolverPath::plain}) {
    for (const bool several : {false, true}) {
      Material material = test::undamped();
      material.stretch_warp = material.stretch_weft = 1e12F;
      material.max_stretch = 0;
      ClothDesc cloth = test::describe(test::make_sheet({.nx = 17, .ny = 17, .charts_x = 2}), material);
      cloth.self_collision = SelfCollision{};
      SolverSettings settings = test::cpu_settings();
      settings.path = path;
      settings.substeps = 4;
      settings.relaxation_steps = several ? 3 : 1;
      const auto make = [&] {
        Solver solver({&cloth, 1}, settings);
        solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
        const Collider ball{"ball", Sphere{{0, 0, 0.2F}, 0.15F}, 0.3F, {}};
        solver.set_colliders({&ball, 1});
        return solver;
      };
      Solver poisoned = make(), fresh = make();
      const std::vector<Vec3> start = test::positions_of(fresh), still(start.size());
      std::vector<Vec3> far = start;
      for (uint32_t p = 0; p < far.size(); ++p) far[p] = p % 2 == 0 ? 1e5F * start[p] : -1e5F * start[p];
      for (const uint32_t p : cloth.asset->splits.pixel) far[p] = start[p];
      poisoned.write_state(0, far, still);
      int frame = 0;
      for (; frame < 60 && test::all_finite(test::positions_of(poisoned)); ++frame) {
        poisoned.set_time_step(frame % 2 == 0 ? 4e-7 : 10, 4);
        poisoned.step();
      }
      ASSERT_FALSE(test::all_finite(test::positions_of(poisoned)));
      test::run(poisoned, 3);
      poisoned.set_time_step(settings.frame_time, settings.substeps);
      for (Solver* solver : {&poisoned, &fresh}) {
        solver->set_wind({.velocity = {0, 0, 2}});
        test::run(*solver, 240);  // until the step is as long again as it was
        solver->write_state(0, start, still);
      }
      for (int k = 0; k < 20; ++k) {
        test::run(poisoned, 1);
        ASSERT_TRUE(test::all_finite(test::positions_of(poisoned))) << "frame " << k;
        test::run(fresh, 1);
      }
      const std::vector<Vec3> healed = test::positions_of(poisoned), expected = test::positions_of(fresh);
      for (uint32_t p = 0; p < healed.size(); ++p) ASSERT_LT(length(healed[p] - expected[p]), 1e-3F) << p;
      EXPECT_TRUE(test::all_finite(test::velocities_of(poisoned)));
    }
  }
}

}  // namespace
}  // namespace geocloth
