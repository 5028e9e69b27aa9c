// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth must stay outside of every solid, whatever its shape and however it moves, and friction must hold what Coulomb
// says.

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "solver_fixture.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::SheetOptions;

struct ShapeCase {
  const char* name;
  ColliderShape shape;
};

class EveryShape : public ::testing::TestWithParam<ShapeCase> {
 protected:
  static SheetOptions sheet() {
    SheetOptions options;
    options.nx = options.ny = 25;
    options.horizontal = true;
    options.charts_x = 2;
    options.center = {0, 0.6F, 0};
    return options;
  }
};

TEST_P(EveryShape, AtRestNoPointIsInside) {
  Solver solver(std::vector{test::describe(make_sheet(sheet()))}, test::cpu_settings());
  solver.set_colliders(std::vector<Collider>{{"solid", GetParam().shape, 0.3F, {}}});
  test::run(solver, 60);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
  EXPECT_LE(solver.statistics().penetration, 0.0);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

TEST_P(EveryShape, MovingAndTurningNoPointIsInside) {
  Solver solver(std::vector{test::describe(make_sheet(sheet()))}, test::cpu_settings());
  Collider collider{"solid", GetParam().shape, 0.3F, {}};
  for (uint32_t f = 0; f < 60; ++f) {
    const float t = static_cast<float>(f) / 60.F;
    collider.pose.translate = {0.4F * std::sin(6 * t), 0.3F * std::sin(9 * t), 0};
    collider.pose.rotate = quat_from_euler_deg({60 * t, 40 * t, 90 * t});
    solver.set_colliders(std::vector{collider});
    solver.step();
  }
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
  EXPECT_LE(solver.statistics().penetration, 0.0);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, EveryShape,
    ::testing::Values(ShapeCase{"plane", Plane{{0, 0.3F, 0}, {0, 1, 0}}},
                      ShapeCase{"sphere", Sphere{{0, 0.2F, 0}, 0.25F}},
                      ShapeCase{"capsule", Capsule{{-0.3F, 0.2F, 0}, {0.3F, 0.3F, 0.1F}, 0.12F, 0.12F}},
                      ShapeCase{"tapered_capsule", Capsule{{-0.3F, 0.2F, 0}, {0.3F, 0.3F, 0.1F}, 0.18F, 0.06F}},
                      ShapeCase{"box", Box{{0, 0.2F, 0}, {0.3F, 0.1F, 0.2F}, quat_from_euler_deg({10, 30, 5})}},
                      ShapeCase{"ellipsoid",
                                Ellipsoid{{0, 0.2F, 0}, {0.4F, 0.1F, 0.2F}, quat_from_euler_deg({0, 20, 10})}}),
    [](const auto& shape) { return shape.param.name; });

TEST(Collider, FastThinWallDoesNotTunnel) {
  SheetOptions options;
  options.nx = options.ny = 9;
  options.horizontal = true;
  options.center = {0, 1, 0};
  Solver solver(std::vector{test::describe(make_sheet(options), test::undamped())}, test::cpu_settings());
  const std::vector<Vec3> start = test::positions_of(solver);
  solver.write_state(0, start, std::vector<Vec3>(start.size(), Vec3{0, -20, 0}));  // 21 mm in a substep
  solver.set_colliders(std::vector<Collider>{{"wall", Box{{0, 0, 0}, {2, 0.002F, 2}, {}}, 0.3F, {}}});
  test::run(solver, 30);
  for (const Vec3& p : test::positions_of(solver)) EXPECT_GT(p.y, 0.002F);
}

}  // namespace
}  // namespace geocloth
