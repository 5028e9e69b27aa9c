// SPDX-License-Identifier: GPL-3.0-or-later
// The solver against closed forms: what a user would compute by hand must come out, whatever the resolution, the number
// of substeps and the way the cloth is cut into charts.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "solver_fixture.h"
#include "support/momentum.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::SheetOptions;

constexpr double kGravity = 9.81;

TEST(FreeFall, FarFromTheWorldsOriginIsAsPrecise) {
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 60;
  Solver solver(
      std::vector{test::describe(make_sheet({.nx = 8, .ny = 8, .center = {1000, 4000, -2000}}), test::undamped())},
      settings);
  const std::vector<Vec3> start = test::positions_of(solver);
  test::run(solver, 60);
  EXPECT_NEAR(test::positions_of(solver)[0].y - start[0].y, -0.5 * kGravity * (1 + settings.frame_time / 60), 1e-3);
}

// Positions have the digits of single precision about an origin that goes along. Where it stayed behind, what had
// fallen for 25 m trembled on the floor for ever.
TEST(FreeFall, FromHighAboveEndsInRest) {
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 64;
  ClothDesc cloth = test::describe(make_sheet({.nx = 33, .ny = 33}), find_material_preset("cotton")->material);
  Solver solver(std::vector{cloth}, settings);
  solver.set_colliders(std::vector<Collider>{{"floor", Plane{{0, -25, 0}, {0, 1, 0}}, 0.3F, {}}});
  test::run(solver, 780);
  const double tremble = test::tremble(solver, 20);
  RecordProperty("mm", std::to_string(1000 * tremble));
  EXPECT_LT(tremble, 8e-6);
}

// What ties pulled together over the tip at every frame's end went apart by another way: cotton trembled there by 0.7
// mm from frame to frame (the root of the mean square), for ever, and heaps of garments turned on the floor.
TEST(Rest, ClothOverThePointOfAPyramidComesToIt) {
  const test::SheetOptions sheet{.nx = 65, .ny = 65, .horizontal = true, .center = {0, 0.85F, 0}};
  const ClothDesc cloth = test::describe(test::make_sheet(sheet), find_material_preset("cotton")->material);
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 16;
  Solver solver({&cloth, 1}, settings);
  const std::array<Vec3, 4> corners{Vec3{-0.3F, 0.3F, -0.2F}, Vec3{0.3F, 0.3F, -0.2F}, Vec3{0, 0.3F, 0.4F},
                                    Vec3{0, 0.8F, 0}};
  const std::vector<Collider> colliders{{"pyramid", convex_hull(corners), 0.5F},
                                        {"floor", Plane{{0, 0, 0}, {0, 1, 0}}, 0.5F}};
  solver.set_colliders(colliders);
  test::run(solver, 420);
  const double tremble = test::tremble(solver, 30);
  RecordProperty("mm", std::to_string(1000 * tremble));
  EXPECT_LT(tremble, 5e-5);
}

TEST(Damping, TakesTheSameShareOfSpeedAtAnyNumberOfSubsteps) {
  for (const uint32_t substeps : {4U, 64U}) {
    SolverSettings settings = test::cpu_settings();
    settings.substeps = substeps;
    settings.gravity = {};
    Material material;
    material.damping = 2;
    Solver solver(std::vector{test::describe(make_sheet({.nx = 4, .ny = 4}), material)}, settings);
    const std::vector<Vec3> start = test::positions_of(solver);
    solver.write_state(0, start, std::vector<Vec3>(start.size(), Vec3{1, 0, 0}));
    test::run(solver, 30);
    EXPECT_NEAR(test::velocities_of(solver)[0].x, std::exp(-1.0), 2e-3) << substeps;
  }
}

/// A strip that hangs from its top edge, at rest after enough time; returns its elongation [m].
double hanging_elongation(uint32_t columns, uint32_t rows, const Material& material, uint32_t charts_y,
                          double* top_strain = nullptr) {
  const SheetOptions options{.nx = columns, .ny = rows, .width = 0.25F, .charts_y = charts_y};
  const ClothAsset asset = make_sheet(options);
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 32;
  settings.relaxation_steps = 8;
  Solver solver(std::vector{test::describe(asset, material)}, settings);
  solver.set_pins(0, test::pins_at_rest(asset, "top"));
  test::run(solver, 120);
  const std::vector<Vec3> x = test::positions_of(solver);
  const uint32_t column = options.nx / 2;
  if (top_strain != nullptr) {
    const double rest = 1.0 / (rows - 1);
    *top_strain = (x[test::sheet_pixel(options, column, 0)].y - x[test::sheet_pixel(options, column, 1)].y) / rest - 1;
  }
  return x[test::sheet_pixel(options, column, 0)].y - x[test::sheet_pixel(options, column, rows - 1)].y - 1.0;
}

TEST(HangingStrip, StretchesByItsWeightOverItsModulus) {
  Material material;
  material.areal_density = 0.2F;
  material.stretch_warp = material.stretch_weft = 1000;
  material.shear = 100;
  material.damping = 4;
  const double expected = 0.2 * kGravity / (2 * 1000);  // rho g L^2 / (2 K)
  // Square cells and cells four times as high as wide: the modulus must not depend on how the cloth was sampled.
  for (const auto& [columns, rows] : {std::pair{4U, 15U}, std::pair{8U, 29U}, std::pair{22U, 22U}}) {
    double top_strain = 0;
    EXPECT_NEAR(hanging_elongation(columns, rows, material, 1, &top_strain), expected, 0.06 * expected) << rows;
    const double at_first_spring = 0.2 * kGravity / 1000 * (1 - 0.5 / (rows - 1));
    EXPECT_NEAR(top_strain, at_first_spring, 0.1 * at_first_spring) << rows;
  }
}

TEST(HangingStrip, IsAsLongCutAcrossAsUncut) {
  Material material;
  material.damping = 4;
  const double uncut = hanging_elongation(8, 29, material, 1);
  EXPECT_NEAR(hanging_elongation(8, 29, material, 2), uncut, 0.03 * uncut);
  EXPECT_NEAR(hanging_elongation(8, 29, material, 4), uncut, 0.06 * uncut);
}

// A seam between a chart whose cells are thin there and one whose cells are not passes on as much of a pull as any
// other.
TEST(HangingStrip, HangsBySeamsWhoseSidesWeighUnalike) {
  const SheetOptions options{.nx = 8, .ny = 41, .width = 0.175F, .charts_y = 2};
  const ClothAsset even = make_sheet(options);
  ClothAsset uneven = even;
  for (uint32_t row = 0; row < even.splits.rows(); ++row) {
    const uint32_t first = even.splits.offset[row];
    ASSERT_EQ(even.splits.offset[row + 1] - first, 2U);
    uneven.area[even.splits.pixel[first]] *= 1 / 16.F;
    uneven.area[even.splits.pixel[first + 1]] *= 2 - 1 / 16.F;
  }
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 8;
  const auto hung = [&](const ClothAsset& asset) {
    Material material;
    material.max_stretch = 0;  // by its springs alone
    Solver solver(std::vector{test::describe(asset, material)}, settings);
    solver.set_pins(0, test::pins_at_rest(asset, "top"));
    test::run(solver, 60);
    return test::positions_of(solver);
  };
  const std::vector<Vec3> expected = hung(even), is = hung(uneven);
  for (size_t p = 0; p < is.size(); ++p) EXPECT_LT(length(is[p] - expected[p]), 1e-5F) << p;
}

class Cutting : public ::testing::TestWithParam<std::pair<uint32_t, uint32_t>> {};

// 8 substeps of 1/60 s. The step is as dissipative as a backward Euler step: a spin of w [1/s] loses the share w^2 dt a
// second, here 2e-4; and positions are rounded to 3e-8 m, which at many substeps is a larger error of the velocity.
TEST_P(Cutting, KeepsMomentumOfCloth_ThatFliesFreely) {
  const auto [charts_x, charts_y] = GetParam();
  const ClothDesc cloth =
      test::describe(make_sheet({.nx = 17, .ny = 17, .charts_x = charts_x, .charts_y = charts_y}), test::undamped());
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  settings.substeps = 8;
  Solver solver(std::vector{cloth}, settings);
  const std::vector<Vec3> x = test::positions_of(solver);
  std::vector<Vec3> v(x.size());
  for (size_t p = 0; p < x.size(); ++p) {  // flies, spins and flaps
    if (cloth.asset->valid(static_cast<uint32_t>(p))) v[p] = {1 - 0.3F * x[p].y, 0.3F * x[p].x, 0.5F * x[p].y * x[p].x};
  }
  solver.write_state(0, x, v);
  const test::Momentum before = test::momentum_of(solver, cloth);
  test::run(solver, 15);
  const test::Momentum after = test::momentum_of(solver, cloth);
  test::expect_same_momentum(after, before, "flying");
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

TEST_P(Cutting, DoesNotChangeHowAPinnedClothSwings) {
  const auto [charts_x, charts_y] = GetParam();
  const auto swing = [](uint32_t cx, uint32_t cy) {
    const SheetOptions options{.nx = 17, .ny = 17, .charts_x = cx, .charts_y = cy, .horizontal = true};
    const ClothAsset asset = make_sheet(options);
    SolverSettings settings = test::cpu_settings();
    settings.substeps = 32;
    Solver solver(std::vector{test::describe(asset)}, settings);
    solver.set_pins(0, test::pins_at_rest(asset, "top"));
    test::run(solver, 30);
    const std::vector<Vec3> x = test::positions_of(solver);
    std::vector<Vec3> points;
    for (uint32_t j = 0; j < options.ny; ++j)
      for (uint32_t i = 0; i < options.nx; ++i) points.push_back(x[test::sheet_pixel(options, i, j)]);
    return points;
  };
  const std::vector<Vec3> uncut = swing(1, 1), cut = swing(charts_x, charts_y);
  double largest = 0;
  for (size_t k = 0; k < uncut.size(); ++k) largest = std::max(largest, static_cast<double>(length(cut[k] - uncut[k])));
  RecordProperty("largest_difference_mm", std::to_string(1000 * largest));
  EXPECT_LT(largest, 0.02);
}

INSTANTIATE_TEST_SUITE_P(Charts, Cutting,
                         ::testing::Values(std::pair{1U, 1U}, std::pair{2U, 1U}, std::pair{1U, 2U}, std::pair{4U, 2U}),
                         [](const auto& cut) {
                           return std::to_string(cut.param.first) + "x" + std::to_string(cut.param.second);
                         });

TEST(Wind, CarriesLooseClothAlongAndGustsDiffer) {
  Solver solver(std::vector{test::describe(make_sheet({.nx = 9, .ny = 9}))}, test::cpu_settings());
  solver.set_wind({{0, 0, 5}, 0.5F, 1, 1.0F, 0.2F});
  test::run(solver, 30);
  const std::vector<Vec3> v = test::velocities_of(solver);
  double lowest = 1e9, highest = -1e9;
  for (const Vec3& u : v) {
    EXPECT_GT(u.z, 0.5F);
    lowest = std::min(lowest, static_cast<double>(u.z));
    highest = std::max(highest, static_cast<double>(u.z));
  }
  EXPECT_GT(highest - lowest, 1e-4);
}

TEST(Wind, OfHalfTheScaleIsAsIfItBlewHalfAsFast) {
  const auto flown = [](float speed, float scale) {
    Solver solver(std::vector{test::describe(make_sheet({.nx = 17, .ny = 17, .charts_x = 2}))}, test::cpu_settings());
    solver.set_wind({{speed, 0, speed}, 0, 1, 1.0F, 0.5F});
    solver.set_wind_scale(0, scale);
    test::run(solver, 30);
    return test::positions_of(solver);
  };
  EXPECT_EQ(flown(6, 0.5F), flown(3, 1));
  EXPECT_NE(flown(6, 1), flown(3, 1));
}

TEST(Wind, OfNoScaleIsStillAirThatDrags) {
  const auto fallen = [](const Wind& wind, float scale) {
    Solver solver(std::vector{test::describe(make_sheet({.nx = 17, .ny = 17}))}, test::cpu_settings());
    const std::vector<Vec3> start = test::positions_of(solver);
    solver.write_state(0, start, std::vector<Vec3>(start.size(), Vec3{0, 0, 3}));  // broadside on
    solver.set_wind(wind);
    solver.set_wind_scale(0, scale);
    test::run(solver, 30);
    return test::positions_of(solver);
  };
  const std::vector<Vec3> sheltered = fallen({{4, 0, 5}, 0.8F, 1, 1.5F, 0.5F}, 0);
  const std::vector<Vec3> still = fallen({{}, 0, 1, 1.5F, 0.5F}, 1), empty = fallen({{4, 0, 5}, 0.8F, 1, 0, 0}, 1);
  EXPECT_EQ(sheltered, still);
  EXPECT_NE(sheltered, empty);  // it is no vacuum
}

TEST(Wind, IsTheSameForAllCopies) {
  Solver solver(std::vector{test::describe(make_sheet({.nx = 17, .ny = 17, .charts_x = 4, .charts_y = 4}))},
                test::cpu_settings());
  solver.set_wind({{3, 1, 5}, 0.5F, 1, 1.0F, 0.5F});
  test::run(solver, 60);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST(Wind, GustsNeverRepeatWithinAMinute) {
  // A stiff pinned strip cannot show the air itself, but a light free patch follows it.
  const SheetOptions options{.nx = 3, .ny = 3, .width = 0.02F, .height = 0.02F};
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  settings.substeps = 2;
  Material material = test::undamped();
  material.areal_density = 0.01F;
  Solver solver(std::vector{test::describe(make_sheet(options), material)}, settings);
  solver.set_wind({{0, 0, 2}, 1, 1, 2, 0});
  const std::vector<Vec3> start = test::positions_of(solver);
  std::vector<double> speed;
  for (int f = 0; f < 1800; ++f) {
    solver.write_state(0, start, std::vector<Vec3>(start.size()));  // from rest at one place in every frame
    solver.step();
    speed.push_back(test::velocities_of(solver)[4].z);
  }
  // The slowest gust has a period of 60 frames: no shift by whole periods gives the same course again.
  for (size_t shift = 60; shift <= 900; shift += 60) {
    double difference = 0;
    for (size_t f = 0; f + shift < speed.size(); ++f)
      difference = std::max(difference, std::abs(speed[f] - speed[f + shift]));
    EXPECT_GT(difference, 0.05 * *std::max_element(speed.begin(), speed.end())) << shift;
  }
}

/// A small sheet on a plane tilted about z by `degrees`, resting on it; returns how far it slid in one second [m].
/// @param away  [m] down the slope, from the point that the plane is given by
double slide(double degrees, float friction, float away = 0, uint32_t substeps = test::cpu_settings().substeps) {
  const double angle = degrees * std::numbers::pi / 180;
  const Vec3 normal{static_cast<float>(-std::sin(angle)), static_cast<float>(std::cos(angle)), 0};
  ClothDesc cloth =
      test::describe(make_sheet({.nx = 9, .ny = 9, .width = 0.2F, .height = 0.2F, .charts_x = 2, .horizontal = true}),
                     test::undamped());
  cloth.material.friction = friction;
  cloth.transform.rotate = quat_from_euler_deg({0, 0, static_cast<float>(degrees)});
  cloth.transform.translate = cloth.material.thickness * normal - away * Vec3{normal.y, -normal.x, 0};
  SolverSettings settings = test::cpu_settings();
  settings.substeps = substeps;
  Solver solver(std::vector{cloth}, settings);
  solver.set_colliders(std::vector<Collider>{{"slope", Plane{{0, 0, 0}, normal}, friction, {}}});
  const std::vector<Vec3> start = test::positions_of(solver);
  test::run(solver, 60);
  return length(test::positions_of(solver)[0] - start[0]);
}

TEST(Friction, HoldsOnASlopeBelowItsAngleAndSlidesByCoulombAboveIt) {
  EXPECT_LT(slide(15, 0.3F), 1e-4);  // tan 15 deg = 0.268
  const double angle = 25 * std::numbers::pi / 180;
  const double expected = 0.5 * kGravity * (std::sin(angle) - 0.3 * std::cos(angle));
  EXPECT_NEAR(slide(25, 0.3F), expected, 0.02 * expected);
  // What friction may hold in small steps is less than single precision has at such a distance: cloth was glued there.
  EXPECT_NEAR(slide(25, 0.3F, 500, 32), expected, 0.03 * expected);
  const double smooth = 0.5 * kGravity * std::sin(angle);
  EXPECT_NEAR(slide(25, 0.F), smooth, 0.02 * smooth);
}

TEST(Pins, HoldMoveAndLetGo) {
  const ClothAsset asset = make_sheet({.nx = 13, .ny = 13, .charts_x = 3});
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  const std::vector<Pin> held = test::pins_at_rest(asset, "top");
  solver.set_pins(0, held);
  test::run(solver, 30);
  for (const Pin& pin : held) EXPECT_EQ(test::positions_of(solver)[pin.pixel], pin.target);

  const std::vector<Pin> moved = test::pins_at_rest(asset, "top", {0.05F, 0, 0.02F});
  solver.set_pins(0, moved);
  solver.step();
  for (const Pin& pin : moved) EXPECT_EQ(test::positions_of(solver)[pin.pixel], pin.target);

  solver.set_pins(0, {});
  test::run(solver, 30);
  for (const Pin& pin : moved) EXPECT_LT(test::positions_of(solver)[pin.pixel].y, pin.target.y - 0.7F);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

TEST(Pins, ThatCannotBeReachedTogetherGiveNoNaN) {
  const ClothAsset asset = make_sheet({.nx = 13, .ny = 13});
  Material material;
  material.max_stretch = 0.02F;
  Solver solver(std::vector{test::describe(asset, material)}, test::cpu_settings());
  std::vector<Pin> pins = test::pins_at_rest(asset, "left", {-50, 0, 0});
  for (const Pin& pin : test::pins_at_rest(asset, "right", {50, 0, 0})) pins.push_back(pin);
  solver.set_pins(0, pins);
  test::run(solver, 30);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));

  for (Pin& pin : pins) pin.target = {0, 0, 0};  // all in one point: springs without a direction
  solver.set_pins(0, pins);
  test::run(solver, 30);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST(MaxStretch, KeepsAHangingClothWithinItsLimitOverSeamsToo) {
  for (const uint32_t charts : {1U, 3U}) {
    const SheetOptions options{.nx = 33, .ny = 65, .charts_y = charts};
    const ClothAsset asset = make_sheet(options);
    Material material;
    material.max_stretch = 0.01F;
    SolverSettings settings = test::cpu_settings();
    settings.substeps = 8;  // too few to hold it by springs alone
    Solver solver(std::vector{test::describe(asset, material)}, settings);
    solver.set_pins(0, test::pins_at_rest(asset, "top"));
    test::run(solver, 60);
    const std::vector<Vec3> x = test::positions_of(solver);
    const float bottom = x[test::sheet_pixel(options, 16, 64)].y;
    EXPECT_GT(bottom, -0.5F - 0.0101F) << charts;
    EXPECT_LT(bottom, -0.5F) << charts;
    EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  }
}

TEST(MaxSpeed, IsKept) {
  Material material = test::undamped();
  material.max_speed = 1.5F;
  Solver solver(std::vector{test::describe(make_sheet({.nx = 5, .ny = 5}), material)}, test::cpu_settings());
  test::run(solver, 60);
  for (const Vec3& v : test::velocities_of(solver)) EXPECT_LE(length(v), 1.5F * 1.001F);
}

TEST(Seeds, ZellersParametersAreAccepted) {
  Material material;
  material.stiffness = 1;
  material.bend_stiffness = 0.5F;
  material.verlet_damping = 0.99F;
  const ClothAsset asset = make_sheet({.nx = 17, .ny = 17, .charts_x = 2});
  Solver solver(std::vector{test::describe(asset, material)}, test::cpu_settings());
  solver.set_pins(0, test::pins_at_rest(asset, "top"));
  test::run(solver, 60);
  const StretchStatistics stretch = measure_stretch(asset, 1, test::positions_of(solver));
  EXPECT_LT(stretch.max, 1.05);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

TEST(Tube, HangsAndKeepsItsSeamClosed) {
  const ClothAsset asset = test::make_tube({});
  SolverSettings settings = test::cpu_settings();
  Solver solver(std::vector{test::describe(asset)}, settings);
  solver.set_pins(0, test::pins_at_rest(asset, "top"));
  solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, -0.1F, 0}, 0.22F}, 0.3F, {}}});
  test::run(solver, 60);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  EXPECT_LE(solver.statistics().penetration, 0.0);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

/// A cloth that lies on a ball, with gravity a little aslant: it stays, whatever the frame rate at one length of
/// substeps. What ends a frame drew it off by half a metre in three seconds at 480 frames a second.
TEST(Friction, HoldsAlikeAtAnyFrameRate) {
  const ClothDesc cloth =
      test::describe(test::make_sheet({.nx = 33, .ny = 33, .horizontal = true, .center = {0, 0.32F, 0}}), Material{});
  const Collider ball{"ball", Sphere{{0, 0, 0}, 0.3F}, 0.5F, {}};
  for (const uint32_t substeps : {16U, 4U, 1U}) {
    SolverSettings settings = test::cpu_settings();
    settings.substeps = substeps;
    settings.frame_time = substeps / 480.0;
    settings.gravity = {1, -9.81F, 0};
    Solver solver(std::vector{cloth}, settings);
    solver.set_colliders(std::vector{ball}, true);
    test::run(solver, 1440 / substeps);
    double sum = 0;
    const std::vector<Vec3> positions = test::positions_of(solver);
    for (const Vec3& p : positions) sum += static_cast<double>(p.x);
    EXPECT_NEAR(sum / static_cast<double>(positions.size()), 0, 0.06) << substeps << " substeps a frame";
  }
}

/// A curtain that is drawn: it hung in a plane, without wind, and lay squeezed in that plane instead of in folds.
TEST(Curtain, FoldsWhenItIsDrawn) {
  constexpr uint32_t kSide = 33;
  for (const float turn : {0.F, 90.F}) {
    for (const int waits : {0, 600}) {  // frames
      const SheetOptions sheet{.nx = kSide, .ny = kSide};
      ClothDesc cloth = test::describe(test::make_sheet(sheet));
      cloth.transform = {{0.3F, 1, 0.7F}, quat_from_euler_deg({0, turn, 0}), 1};
      SolverSettings settings = test::cpu_settings();
      settings.imperfection = 1e-6F;
      Solver solver(std::vector{cloth}, settings);
      const std::vector<Vec3> start = test::positions_of(solver);
      constexpr int kFrames = 90;
      for (int f = 0; f < waits + 2 * kFrames; ++f) {
        const float drawn = 0.6F * static_cast<float>(std::clamp(f - waits, 0, kFrames)) / kFrames;
        std::vector<Pin> pins;
        for (uint32_t x = 0; x < kSide; x += 4) {
          const uint32_t pixel = test::sheet_pixel(sheet, x, 0);
          const Vec3 along = start[pixel] - cloth.transform.translate;
          pins.push_back({pixel, start[pixel] - drawn * Vec3{along.x, 0, along.z}});
        }
        solver.set_pins(0, pins);
        solver.step();
      }
      double depth = 0;
      for (const Vec3& p : test::positions_of(solver)) {
        const Vec3 away = rotate(conjugate(cloth.transform.rotate), p - cloth.transform.translate);
        depth = std::max(depth, std::abs(static_cast<double>(away.z)));
      }
      EXPECT_GT(depth, 0.03) << turn << " deg, after " << waits << " frames";
    }
  }
}

}  // namespace
}  // namespace geocloth
