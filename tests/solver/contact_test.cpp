// SPDX-License-Identifier: GPL-3.0-or-later
// Contact and friction against closed forms, and fast things that must not pass through each other.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "solver_fixture.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::SheetOptions;

constexpr double kGravity = 9.81;

/// Cloth on an incline; returns how far it has slid after a second [m].
double slid(double tangent, double friction) {
  const double angle = std::atan(tangent);
  SheetOptions options{.nx = 9, .ny = 9, .width = 0.2F, .height = 0.2F, .charts_x = 2, .horizontal = true};
  options.center = {0, 0.002F, 0};
  Material material = test::undamped();
  material.friction = static_cast<float>(friction);
  SolverSettings settings = test::cpu_settings();
  // Gravity is tilted instead of the plane.
  settings.gravity = {static_cast<float>(kGravity * std::sin(angle)), static_cast<float>(-kGravity * std::cos(angle)),
                      0};
  Solver solver(std::vector{test::describe(make_sheet(options), material)}, settings);
  solver.set_colliders(std::vector<Collider>{{"plane", Plane{}, static_cast<float>(friction), {}}});
  const std::vector<Vec3> start = test::positions_of(solver);
  test::run(solver, 60);
  const std::vector<Vec3> end = test::positions_of(solver);
  return end[test::sheet_pixel(options, 4, 4)].x - start[test::sheet_pixel(options, 4, 4)].x;
}

TEST(Incline, SticksBelowTheAngleOfFrictionAndSlidesByCoulombAboveIt) {
  for (const double mu : {0.2, 0.5, 0.9}) {
    EXPECT_NEAR(slid(0.95 * mu, mu), 0, 1e-3) << mu;
    for (const double tangent : {1.1 * mu, 2 * mu}) {
      const double angle = std::atan(tangent);
      const double acceleration = kGravity * (std::sin(angle) - mu * std::cos(angle));
      EXPECT_NEAR(slid(tangent, mu), 0.5 * acceleration, 0.02 * 0.5 * acceleration + 1e-3) << mu << ' ' << tangent;
    }
  }
}

TEST(Incline, WithoutFrictionNothingHolds) {
  EXPECT_NEAR(slid(0.1, 0), 0.5 * kGravity * std::sin(std::atan(0.1)), 0.01);
}

/// Capstan: a strip over a horizontal cylinder, half a turn. At which ratio of the loads on its ends does it begin to
/// slide? The load is gravity on hanging lengths, so the longer end is cut back until the strip stays.
/// @return shift of the strip [m] in a second, the long end's length being `ratio` times the short one's
double capstan_shift(double ratio, double mu) {
  constexpr double kRadius = 0.1, kShort = 0.1;
  const double arc = std::numbers::pi * kRadius;
  const double length = kShort + arc + ratio * kShort;
  const SheetOptions options{.nx = 4,
                             .ny = static_cast<uint32_t>(std::lround(length / 0.02)) + 1,
                             .width = 0.06F,
                             .height = static_cast<float>(length)};
  const ClothAsset asset = make_sheet(options);
  Material material;
  material.damping = 0.5F;
  material.friction = static_cast<float>(mu);
  material.stretch_warp = material.stretch_weft = 3000;
  material.bend_warp = material.bend_weft = 0;
  material.thickness = 0;
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 32;
  settings.relaxation_steps = 8;
  Solver solver(std::vector{test::describe(asset, material)}, settings);
  std::vector<Vec3> x(asset.pixel_count());
  for (uint32_t j = 0; j < options.ny; ++j)
    for (uint32_t i = 0; i < options.nx; ++i) {
      const double s = length * j / (options.ny - 1) - kShort;  // along the arc from where it touches
      const double z = 0.02 * i;
      Vec3 p{static_cast<float>(-kRadius), static_cast<float>(s), static_cast<float>(z)};
      if (s > arc) p = {static_cast<float>(kRadius), static_cast<float>(arc - s), static_cast<float>(z)};
      if (s > 0 && s <= arc) {
        const double angle = s / kRadius;
        p = {static_cast<float>(-kRadius * std::cos(angle)), static_cast<float>(kRadius * std::sin(angle)),
             static_cast<float>(z)};
      }
      x[test::sheet_pixel(options, i, j)] = p;
    }
  solver.write_state(0, x, std::vector<Vec3>(x.size()));
  solver.set_colliders(
      std::vector<Collider>{{"cylinder",
                             Capsule{{0, 0, -2}, {0, 0, 2}, static_cast<float>(kRadius), static_cast<float>(kRadius)},
                             static_cast<float>(mu),
                             {}}});
  test::run(solver, 60);
  const uint32_t end = test::sheet_pixel(options, 1, options.ny - 1);
  return x[end].y - test::positions_of(solver)[end].y;
}

TEST(Capstan, HoldsBelowAndSlidesAboveTheExponentialOfTheAngle) {
  // Equilibrium of a heavy strip on a cylinder: dT/dphi = mu (T + w r sin) + w r cos, T falling by w times the height.
  // From the short end T0 = w l up to the long end T1: integrated numerically, as no weight may be left out.
  constexpr double kRadius = 0.1, kShort = 0.1;
  for (const double mu : {0.2, 0.3}) {
    double tension = kShort;  // in units of the weight per length
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double phi = std::numbers::pi * (i + 0.5) / kSteps;
      const double normal = tension + kRadius * std::sin(phi);  // tension is over the radius, the weight presses too
      tension += (mu * normal + kRadius * std::cos(phi)) * std::numbers::pi / kSteps;
    }
    const double critical = tension / kShort;
    EXPECT_LT(capstan_shift(0.95 * critical, mu), 0.01) << "mu " << mu << " critical " << critical;
    EXPECT_GT(capstan_shift(1.05 * critical, mu), 0.03) << "mu " << mu << " critical " << critical;
  }
}

/// How often a ray from a point along +z meets the sheet.
uint32_t layers_ahead(const SheetOptions& options, const std::vector<Vec3>& x, const Vec3& from) {
  const auto side = [&](const Vec3& p, const Vec3& q) {
    return double{p.x - from.x} * double{q.y - from.y} - double{p.y - from.y} * double{q.x - from.x};
  };
  const auto meets = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
    const double c = side(p, q), a = side(q, r), b = side(r, p), sum = a + b + c;
    if (sum == 0 || a * sum < 0 || b * sum < 0 || c * sum < 0) return false;
    return (a * double{p.z} + b * double{q.z} + c * double{r.z}) / sum > double{from.z};
  };
  uint32_t layers = 0;
  for (uint32_t j = 0; j + 1 < options.ny; ++j) {
    for (uint32_t i = 0; i + 1 < options.nx; ++i) {
      const auto at = [&](uint32_t u, uint32_t v) { return x[test::sheet_pixel(options, i + u, j + v)]; };
      layers += meets(at(0, 0), at(0, 1), at(1, 1)) ? 1U : 0U;
      layers += meets(at(0, 0), at(1, 1), at(1, 0)) ? 1U : 0U;
    }
  }
  return layers;
}

// The sheet is 1 m long and hangs from its top: pushed 0.4 m out at its middle it still covers the ball; a little later
// its lower edge slips over it.
TEST(Fast, SphereAtTwentyMetresASecondPushesAHangingSheetAndNeverPasses) {
  for (const auto& [points, charts] : {std::pair{17U, 1U}, std::pair{33U, 1U}, std::pair{33U, 2U}}) {
    for (const float radius : {0.02F, 0.05F, 0.1F, 0.2F}) {
      const SheetOptions options{.nx = points, .ny = points, .charts_x = charts};
      const ClothAsset asset = make_sheet(options);
      Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
      solver.set_pins(0, test::pins_at_rest(asset, "top"));
      Collider ball{"ball", Sphere{{0, 0, -0.25F}, radius}, 0.3F, {}};
      solver.set_colliders(std::vector{ball});
      for (int f = 0; f < 2; ++f) {
        ball.pose.translate.z += 20.F / 60;
        solver.set_colliders(std::vector{ball});
        solver.step();
        const Vec3 center{0.0012F, 0.0007F, -0.25F + ball.pose.translate.z};  // on no spring
        EXPECT_GE(layers_ahead(options, test::positions_of(solver), center), 1U)
            << points << ' ' << charts << ' ' << radius << ' ' << f;
      }
      EXPECT_LE(solver.statistics().penetration, 0.002);
      EXPECT_EQ(solver.statistics().copy_gap, 0.0);
    }
  }
}

// A rod much thinner than the distance of the pixels has nothing but the triangles to meet.
TEST(Fast, ARodThatFitsBetweenPixelsIsHeldByTheClothBetweenThem) {
  for (const float speed : {1.F, 10.F}) {
    const SheetOptions options{.nx = 17, .ny = 17};
    const ClothAsset asset = make_sheet(options);
    SolverSettings settings = test::cpu_settings();
    settings.gravity = {};
    Solver solver(std::vector{test::describe(asset)}, settings);
    Collider rod{"rod", Capsule{{-1, 0.02F, -0.1F}, {1, 0.02F, -0.1F}, 0.005F, 0.005F}, 0.3F, {}};
    solver.set_colliders(std::vector{rod});
    for (float way = 0; way < 0.5F;) {
      rod.pose.translate.z = way += speed / 60;
      solver.set_colliders(std::vector{rod});
      solver.step();
    }
    EXPECT_GE(layers_ahead(options, test::positions_of(solver), {0.0012F, 0.02F, -0.1F + rod.pose.translate.z}), 1U)
        << speed;
  }
}

double fastest(Solver& solver) {
  double fastest = 0;
  for (const Vec3& v : test::velocities_of(solver)) fastest = std::max(fastest, static_cast<double>(length(v)));
  return fastest;
}

// Cloth that is hit takes the speed of what hit it and no more, but for what springs give back.
TEST(Fast, ClothBetweenPixelsIsNotThrownByWhatPushesIt) {
  for (const float speed : {1.F, 10.F, 20.F}) {
    SolverSettings settings = test::cpu_settings();
    settings.gravity = {};
    Solver solver(std::vector{test::describe(make_sheet({.nx = 17, .ny = 17, .charts_x = 2}))}, settings);
    Collider rod{"rod", Capsule{{-1, 0.02F, -0.1F}, {1, 0.02F, -0.1F}, 0.005F, 0.005F}, 0.3F, {}};
    solver.set_colliders(std::vector{rod});
    for (float way = 0; way < 0.5F;) {
      rod.pose.translate.z = way += speed / 60;
      solver.set_colliders(std::vector{rod});
      solver.step();
      EXPECT_LE(fastest(solver), 2.5 * static_cast<double>(speed)) << speed << ' ' << way;
    }
    EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  }
}

// At steps below 1/5000 s constraints act on offsets; copies once were stitched by those after contacts of cells.
TEST(Fast, SeamsStayClosedUnderARodAtManySubsteps) {
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 120;
  Solver solver(std::vector{test::describe(make_sheet({.nx = 9, .ny = 9, .charts_x = 2, .charts_y = 2}))}, settings);
  Collider rod{"rod", Capsule{{-1, 0.02F, -0.02F}, {1, 0.02F, -0.02F}, 0.005F, 0.005F}, 0.3F, {}};
  solver.set_colliders(std::vector{rod});
  for (int f = 0; f < 5; ++f) {
    rod.pose.translate.z += 3.F / 60;
    solver.set_colliders(std::vector{rod});
    solver.step();
  }
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

TEST(Fast, ThinBladeSweepsThroughAHangingSheetWithoutPassing) {
  for (const float speed : {5.F, 20.F, 60.F}) {
    const SheetOptions options{.nx = 25, .ny = 25};
    Solver solver(std::vector{test::describe(make_sheet(options))}, test::cpu_settings());
    Collider blade{"blade", Box{{0, 0, -0.5F}, {2, 2, 0.001F}, {}}, 0.3F, {}};
    solver.set_colliders(std::vector{blade});
    for (int f = 0; f < 12; ++f) {
      blade.pose.translate.z += speed / 60;
      solver.set_colliders(std::vector{blade});
      solver.step();
    }
    for (const Vec3& p : test::positions_of(solver)) EXPECT_GT(p.z, -0.5F + blade.pose.translate.z) << speed;
  }
}

TEST(Fast, ClothThatLiesOnAThinPlateStaysAboveItWhenThePlateIsJerkedUp) {
  SheetOptions options{.nx = 9, .ny = 9, .horizontal = true};
  options.center = {0, 0.003F, 0};
  Solver solver(std::vector{test::describe(make_sheet(options))}, test::cpu_settings());
  Collider plate{"plate", Box{{0, 0, 0}, {2, 0.001F, 2}, {}}, 0.3F, {}};
  solver.set_colliders(std::vector{plate});
  test::run(solver, 20);
  for (int f = 0; f < 10; ++f) {
    plate.pose.translate.y += f < 5 ? 0.5F : -0.4F;  // 30 m/s up, then away below
    solver.set_colliders(std::vector{plate});
    solver.step();
    for (const Vec3& p : test::positions_of(solver)) EXPECT_GT(p.y, plate.pose.translate.y) << f;
  }
}

TEST(Air, ASheetThatFallsFlatEndsAtItsTerminalVelocity) {
  for (const float drag : {1.F, 2.F}) {
    SheetOptions options{.nx = 9, .ny = 9, .charts_x = 2, .horizontal = true};
    Material material = test::undamped();
    Solver solver(std::vector{test::describe(make_sheet(options), material)}, test::cpu_settings());
    solver.set_wind({{0, 0, 0}, 0, 1, drag, 0});
    test::run(solver, 120);
    const double expected = std::sqrt(2 * material.areal_density * kGravity / (1.204 * drag));
    EXPECT_NEAR(-test::velocities_of(solver)[0].y, expected, 0.01 * expected) << drag;
  }
}

TEST(Air, GustsNeverRepeatWithinAMinute) {
  // A stiff pinned strip cannot show the air itself, but a light free patch follows it.
  SheetOptions options{.nx = 3, .ny = 3, .width = 0.02F, .height = 0.02F};
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

}  // namespace
}  // namespace geocloth
