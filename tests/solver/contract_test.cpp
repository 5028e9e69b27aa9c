// SPDX-License-Identifier: GPL-3.0-or-later
// What the solver promises besides physics: the same bits from run to run and for any number of threads, states that
// can be written and read, and a clear refusal of everything out of range.

#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/solver/device.h"
#include "solver_fixture.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::SheetOptions;

uint64_t hash_of_run(const ClothAsset& asset, uint32_t threads, uint32_t relaxation_steps) {
  SolverSettings settings = test::cpu_settings();
  settings.threads = threads;
  settings.substeps = 4;
  settings.relaxation_steps = relaxation_steps;
  Material material;
  material.max_stretch = 0.05F;
  Solver solver(std::vector{test::describe(asset, material)}, settings);
  solver.set_pins(0, test::pins_at_rest(asset, "corners"));
  solver.set_wind({{1, 0, 2}, 0.3F, 1, 1, 0.2F});
  for (uint32_t f = 0; f < 20; ++f) {
    solver.set_colliders(
        std::vector<Collider>{{"ball", Sphere{{0, -0.2F, 0.02F * static_cast<float>(f) - 0.2F}, 0.2F}, 0.3F, {}},
                              {"floor", Plane{{0, -0.5F, 0}, {0, 1, 0}}, 0.3F, {}}});
    solver.step();
  }
  return hash_state(asset, test::positions_of(solver));
}

TEST(Determinism, SameBitsInEveryRunAndForAnyNumberOfThreads) {
  const ClothAsset asset = make_sheet({.nx = 97, .ny = 101, .charts_x = 5, .charts_y = 3});
  for (const uint32_t relaxation_steps : {1U, 3U}) {
    const uint64_t one = hash_of_run(asset, 1, relaxation_steps);
    EXPECT_EQ(hash_of_run(asset, 1, relaxation_steps), one);
    EXPECT_EQ(hash_of_run(asset, 2, relaxation_steps), one);
    EXPECT_EQ(hash_of_run(asset, 7, relaxation_steps), one);
  }
}

TEST(State, CanBeReadAndWrittenBack) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9, .charts_x = 2});
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  test::run(solver, 5);
  const std::vector<Vec3> x = test::positions_of(solver), v = test::velocities_of(solver);
  test::run(solver, 5);
  solver.write_state(0, x, v);
  EXPECT_EQ(test::positions_of(solver), x);
  for (size_t p = 0; p < v.size(); ++p) EXPECT_LT(length(test::velocities_of(solver)[p] - v[p]), 2e-3F);
  std::vector<Vec3> normals;
  solver.read_normals(0, normals);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    EXPECT_NEAR(length(normals[p]), asset.valid(p) ? 1 : 0, 1e-5);
  }
}

TEST(State, SeveralClothsKeepToThemselves) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9});
  ClothDesc left = test::describe(asset), right = test::describe(asset);
  right.transform.translate = {5, 0, 0};
  right.material.damping = 5;
  Solver solver(std::vector{left, right}, test::cpu_settings());
  solver.set_pins(1, test::pins_at_rest(asset, "top", {5, 0, 0}));
  test::run(solver, 20);
  EXPECT_EQ(solver.cloth_count(), 2U);
  EXPECT_LT(test::positions_of(solver, 0)[0].y, 0.1F);
  EXPECT_EQ(test::positions_of(solver, 1)[0], (Vec3{4.5F, 0.5F, 0}));
  EXPECT_EQ(solver.statistics().particles, 162U);
}

TEST(State, ScaleMakesTheSameClothLarger) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9});
  ClothDesc cloth = test::describe(asset);
  cloth.transform.scale = 3;
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  Solver solver(std::vector{cloth}, settings);
  test::run(solver, 5);
  EXPECT_NEAR(measure_stretch(asset, 3, test::positions_of(solver)).max, 1, 1e-4);
  const Energy energy =
      measure_energy(cloth, {0, -1, 0}, std::vector<Vec3>(81, Vec3{0, 1, 0}), std::vector<Vec3>(81, Vec3{1, 0, 0}));
  EXPECT_NEAR(energy.potential, 9 * 0.2, 1e-5);
  EXPECT_NEAR(energy.kinetic, 0.5 * 9 * 0.2, 1e-5);
}

TEST(Guards, SliversWithHardlyAnyAreaAreNoWeightlessParticles) {
  ClothAsset asset = make_sheet({.nx = 9, .ny = 9, .charts_x = 2, .jitter = 0.3F});
  for (uint32_t p = 0; p < asset.pixel_count(); p += 3)
    if (asset.valid(p)) asset.area[p] = 1e-30F;
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  solver.set_pins(0, test::pins_at_rest(asset, "top"));
  test::run(solver, 60);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST(Guards, SpringsWithoutLengthAreLeftOut) {
  ClothAsset asset = make_sheet({.nx = 9, .ny = 9});
  for (uint32_t x = 2; x < 6; ++x) asset.rest_position[40 + x - 4] = asset.rest_position[38];
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  solver.set_pins(0, test::pins_at_rest(asset, "top"));
  test::run(solver, 60);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST(Guards, VeryIrregularSpringsStayStable) {
  for (const float jitter : {0.3F, 0.45F}) {
    const ClothAsset asset = make_sheet({.nx = 33, .ny = 33, .charts_x = 3, .charts_y = 2, .jitter = jitter});
    const ClothDesc cloth = test::describe(asset, test::undamped());
    SolverSettings settings = test::cpu_settings();
    Solver solver(std::vector{cloth}, settings);
    solver.set_pins(0, test::pins_at_rest(asset, "corners"));
    test::run(solver, 120);
    EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
    for (const Vec3& v : test::velocities_of(solver)) EXPECT_LT(length(v), 20);
    EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  }
}

TEST(Refusals, EveryValueOutOfRangeIsNamed) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5});
  const auto refused = [&](const std::function<void(ClothDesc&, SolverSettings&)>& spoil) {
    ClothDesc cloth = test::describe(asset);
    SolverSettings settings = test::cpu_settings();
    spoil(cloth, settings);
    EXPECT_THROW(Solver(std::vector{cloth}, settings), Error);
  };
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  refused([](ClothDesc& c, SolverSettings&) { c.asset = nullptr; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.areal_density = 0; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.stretch_warp = kNaN; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.damping = -1; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.stiffness = 2; });
  refused([](ClothDesc& c, SolverSettings&) { c.transform.scale = 0; });
  refused([](ClothDesc& c, SolverSettings&) { c.transform.translate.x = kNaN; });
  refused([](ClothDesc& c, SolverSettings&) { c.transform.rotate.w = 3; });
  refused([](ClothDesc&, SolverSettings& s) { s.substeps = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.substeps = 257; });
  refused([](ClothDesc&, SolverSettings& s) { s.relaxation_steps = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.frame_time = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.threads = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.gravity.y = kNaN; });
  EXPECT_THROW(Solver(std::vector<ClothDesc>{}, test::cpu_settings()), Error);

  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  const auto collider = [](ColliderShape shape) { return std::vector<Collider>{{"solid", shape, 0.3F, {}}}; };
  EXPECT_THROW(solver.set_colliders(collider(Sphere{{0, 0, 0}, -1})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Sphere{{kNaN, 0, 0}, 1})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Plane{{0, 0, 0}, {0, 0, 0}})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Box{{0, 0, 0}, {1, 0, 1}, {}})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Ellipsoid{{0, 0, 0}, {1, kNaN, 1}, {}})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Capsule{{0, 0, 0}, {0, 1, 0}, 0, 1})), Error);
  EXPECT_THROW(solver.set_wind({{kNaN, 0, 0}, 0, 1, 1, 0}), Error);
  EXPECT_THROW(solver.set_gravity({0, kNaN, 0}), Error);
  EXPECT_THROW(solver.set_pins(0, std::vector<Pin>{{25, {}}}), Error);
  EXPECT_THROW(solver.set_pins(0, std::vector<Pin>{{0, {kNaN, 0, 0}}}), Error);
  EXPECT_THROW(solver.set_pins(1, {}), Error);
  EXPECT_THROW(solver.write_state(0, std::vector<Vec3>(3), std::vector<Vec3>(3)), Error);
  test::run(solver, 1);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

// `--backend cpu --device ...` ran on the cpu whatever it was told, and the cpu's own name was that of no device.
TEST(Refusals, TheCpuIsADeviceWithAName) {
  const std::string name = enumerate_devices().front().name;
  const ClothAsset asset = make_sheet({.nx = 6, .ny = 6});
  const std::vector cloths{test::describe(asset)};
  for (const Backend backend : {Backend::cpu, Backend::automatic}) {
    SolverSettings settings;
    settings.backend = backend;
    settings.device = name;
    EXPECT_EQ(Solver(cloths, settings).statistics().device, name);
  }
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.device = "Voodoo 2";
  try {
    const Solver solver(cloths, settings);
    ADD_FAILURE() << "ran on " << name;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::device);
    EXPECT_THAT(e.what(), testing::HasSubstr("'Voodoo 2'"));
  }
}

TEST(Refusals, CopiesThatDisagreeCannotBeWritten) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5, .charts_x = 2});
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  std::vector<Vec3> x = test::positions_of(solver);
  x[asset.splits.pixel[1]].x += 0.01F;
  EXPECT_THROW(solver.write_state(0, x, std::vector<Vec3>(x.size())), Error);
}

}  // namespace
}  // namespace geocloth
