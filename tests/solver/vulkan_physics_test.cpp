// SPDX-License-Identifier: GPL-3.0-or-later
// Invariants and closed forms that are no strip's, on a Vulkan device at small sizes: free fall, momentum, energy,
// friction, terminal velocity, cut invariance, a fast ball. The references are those of the tests of the cpu.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solver_fixture.h"
#include "support/momentum.h"
#include "support/vulkan_test.h"

namespace geocloth {
namespace {

constexpr double kGravity = 9.81;

using test::SheetOptions;

class VulkanPhysicsTest : public test::VulkanTest {
 protected:
  [[nodiscard]] Solver make(const ClothDesc& cloth, uint32_t substeps, bool keep_momentum = false,
                            const Vec3& gravity = {0, -9.81F, 0}) {
    SolverSettings settings;
    settings.substeps = substeps;
    settings.keep_momentum = keep_momentum;
    settings.gravity = gravity;
    settings.check_copies = true;
    return make_solver({&cloth, 1}, settings);
  }

  /// [m] along an incline in half a second; gravity is tilted instead of the plane.
  [[nodiscard]] double slid(double tangent, float friction) {
    const double angle = std::atan(tangent);
    const SheetOptions options{
        .nx = 5, .ny = 5, .width = 0.1F, .height = 0.1F, .charts_x = 2, .horizontal = true, .center = {0, 0.002F, 0}};
    ClothDesc cloth = test::describe(make_sheet(options), test::undamped());
    cloth.material.friction = friction;
    Solver solver =
        make(cloth, 16, false,
             {static_cast<float>(kGravity * std::sin(angle)), static_cast<float>(-kGravity * std::cos(angle)), 0});
    solver.set_colliders(std::vector<Collider>{{"plane", Plane{}, friction, {}}});
    const std::vector<Vec3> start = test::positions_of(solver);
    test::run(solver, 30);
    return static_cast<double>((test::positions_of(solver)[0] - start[0]).x);
  }

  /// Where the points of a sheet that swings down by two corners are after a third of a second, row by row.
  [[nodiscard]] std::vector<Vec3> swung(uint32_t charts_x, uint32_t charts_y) {
    const SheetOptions options{.nx = 9, .ny = 9, .charts_x = charts_x, .charts_y = charts_y, .horizontal = true};
    const ClothDesc cloth = test::describe(make_sheet(options));
    Solver solver = make(cloth, 32);
    solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
    test::run(solver, 20);
    EXPECT_EQ(solver.statistics().copy_gap, 0.0);
    const std::vector<Vec3> x = test::positions_of(solver);
    std::vector<Vec3> points;
    for (uint32_t j = 0; j < options.ny; ++j)
      for (uint32_t i = 0; i < options.nx; ++i) points.push_back(x[sheet_pixel(options, i, j)]);
    return points;
  }
};

TEST_F(VulkanPhysicsTest, FreeFallIsHalfGTSquared) {
  for (const uint32_t substeps : {1U, 16U, 120U}) {
    Solver solver = make(test::describe(test::make_sheet({.nx = 4, .ny = 4}), test::undamped()), substeps);
    const std::vector<Vec3> start = test::positions_of(solver);
    test::run(solver, 30);
    const double dt = 1.0 / 60 / substeps;
    EXPECT_NEAR(test::positions_of(solver)[0].y - start[0].y, -0.5 * kGravity * 0.5 * (0.5 + dt), 2e-4) << substeps;
  }
}

TEST_F(VulkanPhysicsTest, MomentumOfFreeClothStaysHoweverItIsCut) {
  for (const auto& [charts_x, charts_y] : {std::pair{1U, 1U}, std::pair{2U, 1U}, std::pair{4U, 2U}}) {
    const ClothDesc cloth = test::describe(
        test::make_sheet({.nx = 9, .ny = 9, .charts_x = charts_x, .charts_y = charts_y}), test::undamped());
    Solver solver = make(cloth, 30, true, {});
    test::spin_stretch_and_bend(solver, cloth);
    const test::Momentum before = test::momentum_of(solver, cloth);
    test::run(solver, 30);
    const test::Momentum after = test::momentum_of(solver, cloth);
    test::expect_same_momentum(after, before, std::to_string(charts_x) + " charts wide");
  }
}

TEST_F(VulkanPhysicsTest, AnUndampedSwingNeverGainsEnergy) {
  for (const uint32_t substeps : {8U, 240U}) {
    const ClothDesc cloth = test::describe(test::make_sheet({.nx = 9, .ny = 9, .horizontal = true}), test::undamped());
    Solver solver = make(cloth, substeps);
    solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
    for (uint32_t f = 0; f < 40; ++f) {
      solver.step();
      const Energy e = measure_energy(cloth, {0, -9.81F, 0}, test::positions_of(solver), test::velocities_of(solver));
      ASSERT_LE(e.kinetic + e.potential, 0.0) << substeps << ' ' << f;  // it starts level, at rest, at height 0
    }
  }
}

TEST_F(VulkanPhysicsTest, ClothSticksOnASlopeBelowItsFrictionAndSlidesByCoulombAbove) {
  EXPECT_NEAR(slid(0.95 * 0.5, 0.5F), 0, 1e-3);
  const double angle = std::atan(2 * 0.5);
  const double way = 0.5 * kGravity * (std::sin(angle) - 0.5 * std::cos(angle)) * 0.5 * 0.5;
  EXPECT_NEAR(slid(2 * 0.5, 0.5F), way, 0.02 * way + 1e-3 + kGravity / 60 / 16);
}

TEST_F(VulkanPhysicsTest, FlatClothFallsAtItsTerminalSpeed) {
  const ClothDesc cloth = test::describe(test::make_sheet({.nx = 5, .ny = 5, .horizontal = true}), test::undamped());
  Solver solver = make(cloth, 16);
  solver.set_wind({{0, 0, 0}, 0, 1, 1.F, 0});
  test::run(solver, 120);
  const double terminal = std::sqrt(2 * static_cast<double>(cloth.material.areal_density) * kGravity / 1.204);
  EXPECT_NEAR(-test::velocities_of(solver)[0].y, terminal, 0.01 * terminal);
}

TEST_F(VulkanPhysicsTest, CutClothSwingsAsUncut) {
  const std::vector<Vec3> uncut = swung(1, 1);
  for (const auto& [charts_x, charts_y] : {std::pair{2U, 1U}, std::pair{4U, 2U}}) {
    const std::vector<Vec3> cut = swung(charts_x, charts_y);
    double farthest = 0;
    for (size_t k = 0; k < cut.size(); ++k)
      farthest = std::max(farthest, static_cast<double>(length(cut[k] - uncut[k])));
    EXPECT_LE(farthest, 0.01) << charts_x << " x " << charts_y;
  }
}

}  // namespace
}  // namespace geocloth
