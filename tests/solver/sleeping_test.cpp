// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth that has come to rest is left alone until something happens to it: it must cost nothing, not drift, and go on
// from where it was as if it had never slept.

#include <algorithm>
#include <functional>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/solver/scene.h"
#include "solver_fixture.h"

namespace geocloth {
namespace {

using test::describe;
using test::make_sheet;
using test::pins_at_rest;
using test::positions_of;
using test::run;

const test::SheetOptions kSheet{.nx = 13, .ny = 13, .charts_x = 2};
constexpr uint32_t kLongEnough = 900;  // frames

ClothDesc damped_sheet() {
  Material material;
  material.damping = 4;
  return describe(make_sheet(kSheet), material);
}

SolverSettings sleepy() {
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 4;
  settings.sleep_speed = 0.005F;
  return settings;
}

Solver hanging(const SolverSettings& settings = sleepy(), uint32_t cloths = 1) {
  const ClothDesc cloth = damped_sheet();
  Solver solver(std::vector(cloths, cloth), settings);
  for (uint32_t c = 0; c < cloths; ++c) solver.set_pins(c, pins_at_rest(*cloth.asset, "top"));
  return solver;
}

/// Frames until the cloth sleeps.
uint32_t run_to_sleep(Solver& solver, uint32_t cloth = 0) {
  uint32_t frames = 0;
  for (; frames < kLongEnough && !solver.asleep(cloth); ++frames) solver.step();
  EXPECT_TRUE(solver.asleep(cloth));
  return frames;
}

uint64_t hash_of(Solver& solver, uint32_t cloth = 0) {
  return hash_state(*solver.asset(cloth), positions_of(solver, cloth));
}

Collider ball_at(float z) {
  Collider ball;
  ball.shape = Sphere{{0, -0.2F, z}, 0.15F};
  return ball;
}

TEST(Sleeping, ClothAtRestStaysAsItIsAndNoPassRuns) {
  SolverSettings settings = sleepy();
  settings.timings = true;
  Solver solver = hanging(settings);
  EXPECT_GT(run_to_sleep(solver), 30U);  // half a second at least
  const auto seconds = [&] {
    double sum = 0;
    for (const PassTiming& pass : solver.statistics().passes) sum += pass.seconds;
    return sum;
  };
  const uint64_t hash = hash_of(solver);
  const double before = seconds();
  run(solver, 100);
  EXPECT_EQ(hash_of(solver), hash);
  EXPECT_EQ(seconds(), before);
  EXPECT_EQ(solver.statistics().asleep, 1U);
}

TEST(Sleeping, IsOffUnlessAskedFor) {
  SolverSettings settings = sleepy();
  settings.sleep_speed = 0;
  Solver solver = hanging(settings);
  run(solver, kLongEnough);
  EXPECT_FALSE(solver.asleep(0));
}

TEST(Sleeping, AMovingColliderWakesItAndItGoesOnAsIfAwake) {
  SolverSettings settings = sleepy();
  settings.sleep_speed = 0.001F;
  Solver sleeper = hanging(settings);
  settings.sleep_speed = 1e-9F;  // has the same passes and never sleeps
  Solver awake = hanging(settings);
  for (Solver* solver : {&sleeper, &awake}) solver->set_colliders(std::vector{ball_at(0.4F)});
  const uint32_t frames = run_to_sleep(sleeper);
  run(awake, frames);
  run(sleeper, 60);
  run(awake, 60);
  EXPECT_FALSE(awake.asleep(0));
  const std::vector<Vec3> before = positions_of(sleeper);
  for (int f = 1; f <= 60; ++f) {
    const float z = 0.4F - 0.007F * static_cast<float>(f);
    for (Solver* solver : {&sleeper, &awake}) {
      solver->set_colliders(std::vector{ball_at(z)});
      solver->step();
    }
    if (z < 0.22F || z > 0.26F) {  // the ball, the way of a frame, the spacing and the thickness end at 0.242
      EXPECT_EQ(sleeper.asleep(0), z > 0.24F) << z;
    }
  }
  const std::vector<Vec3> a = positions_of(sleeper), b = positions_of(awake);
  double apart = 0, moved = 0;
  for (size_t p = 0; p < a.size(); ++p) {
    apart = std::max(apart, static_cast<double>(length(a[p] - b[p])));
    moved = std::max(moved, static_cast<double>(length(a[p] - before[p])));
  }
  EXPECT_GT(moved, 0.08);
  EXPECT_LT(apart, 0.004);
}

TEST(Sleeping, WhatMovesElsewhereNeitherWakesItNorKeepsItAwake) {
  Solver quiet = hanging(), busy = hanging();
  quiet.set_colliders(std::vector{ball_at(2)});
  const uint32_t frames = run_to_sleep(quiet);
  for (uint32_t f = 1; f <= frames; ++f) {
    busy.set_colliders(std::vector{ball_at(2 + 0.01F * static_cast<float>(f % 7))});
    busy.step();
  }
  EXPECT_TRUE(busy.asleep(0));
  EXPECT_EQ(hash_of(busy), hash_of(quiet));
}

// Slower than what counts as motion; were it to doze off now and then, it would halt each time.
TEST(Sleeping, ClothOnASlowLiftStaysAwakeUntilItStops) {
  const test::SheetOptions flat{.nx = 9, .ny = 9, .horizontal = true, .center = {0, 0.01F, 0}};
  Material material;
  material.damping = 4;
  Solver solver(std::vector{describe(make_sheet(flat), material)}, sleepy());
  Collider lift{"lift", Box{{0, -0.1F, 0}, {1, 0.1F, 1}, {}}, 0.5F, {}};
  const auto go = [&](uint32_t frames, float step) {
    bool slept = false;
    for (uint32_t f = 0; f < frames; ++f) {
      lift.pose.translate.y += step;
      solver.set_colliders(std::vector{lift});
      solver.step();
      slept = slept || solver.asleep(0);
    }
    return slept;
  };
  EXPECT_FALSE(go(300, 0.003F / 60));
  EXPECT_TRUE(go(300, 0));
}

// Wherever it comes from and whatever it is: it must find the cloth awake.
TEST(Sleeping, EveryShapeWakesItBeforeItTouches) {
  const std::vector<ColliderShape> shapes{
      Sphere{{}, 0.2F},
      Capsule{{-0.4F, 0, 0}, {0.4F, 0.1F, 0}, 0.05F, 0.1F},
      Box{{}, {0.3F, 0.1F, 0.2F}, quat_from_euler_deg({20, 30, 40})},
      Ellipsoid{{}, {0.3F, 0.1F, 0.2F}, quat_from_euler_deg({20, 30, 40})},
      convex_hull(std::vector<Vec3>{{-0.3F, 0, -0.2F}, {0.3F, 0, -0.2F}, {0, 0.3F, 0}, {0, 0, 0.3F}}),
      Plane{{0, 0, -0.3F}, {0, 0.28F, 0.96F}}};
  for (size_t k = 0; k < shapes.size(); ++k) {
    SolverSettings settings = sleepy();
    settings.sleep_time = 0.2F;
    Solver solver = hanging(settings);
    Collider shape{"shape", shapes[k], 0.3F, {{0, 0, -2}, {}, 1}};
    solver.set_colliders(std::vector{shape});
    run_to_sleep(solver);
    uint32_t asleep = 0;
    for (int f = 1; f <= 45; ++f) {
      shape.pose.translate.z += 0.05F;
      shape.pose.rotate = quat_from_euler_deg({0, 0, 5 * static_cast<float>(f)});
      solver.set_colliders(std::vector{shape});
      solver.step();
      if (!solver.asleep(0)) continue;
      ++asleep;
      const std::vector<Vec3> x = positions_of(solver);
      for (uint32_t p = 0; p < x.size(); ++p) {
        if (solver.asset(0)->valid(p)) {
          ASSERT_GT(signed_distance(shape, x[p]), Material{}.thickness) << k << ' ' << f;
        }
      }
    }
    EXPECT_GT(asleep, 20U) << k;
    EXPECT_FALSE(solver.asleep(0)) << k;
  }
}

TEST(Sleeping, WindKeepsItAwakeAndStillAirDoesNot) {
  Solver windy = hanging(), still = hanging();
  windy.set_wind({.velocity = {0.01F, 0, 0}, .turbulence = 0, .frequency = 1, .drag = 1, .lift = 0});
  run(windy, kLongEnough);
  EXPECT_FALSE(windy.asleep(0));
  still.set_wind({.turbulence = 0, .frequency = 1, .drag = 1, .lift = 0});
  run_to_sleep(still);
  windy.set_wind_scale(0, 0);
  run_to_sleep(windy);
  windy.set_wind_scale(0, 1);
  windy.step();
  EXPECT_FALSE(windy.asleep(0));
}

TEST(Sleeping, OneOfTenIsDisturbed) {
  Solver solver = hanging(sleepy(), 10);
  for (uint32_t c = 0; c < 10; ++c) run_to_sleep(solver, c);
  std::vector<uint64_t> hashes;
  for (uint32_t c = 0; c < 10; ++c) hashes.push_back(hash_of(solver, c));
  const ClothDesc cloth = damped_sheet();
  for (int f = 1; f <= 20; ++f) {
    solver.set_pins(3, pins_at_rest(*cloth.asset, "top", {0.01F * static_cast<float>(f), 0, 0}));
    solver.step();
    EXPECT_EQ(solver.statistics().asleep, 9U);
  }
  for (uint32_t c = 0; c < 10; ++c) EXPECT_EQ(hash_of(solver, c) == hashes[c], c != 3) << c;
  run_to_sleep(solver, 3);
}

struct Disturbance {
  const char* name;
  std::function<void(Solver&)> disturb;
  bool wakes = true;
};

TEST(Sleeping, WhatChangesWakesItAndWhatStaysDoesNot) {
  const ClothDesc cloth = damped_sheet();
  const Wind still{.turbulence = 0, .frequency = 1, .drag = 1, .lift = 0};
  const std::vector<Disturbance> disturbances{
      {"gravity",
       [](Solver& s) {
         s.set_gravity({0, -9, 0});
       }},
      {"wind",
       [](Solver& s) {
         s.set_wind({.velocity = {1, 0, 0}});
       }},
      {"another drag", [](Solver& s) { s.set_wind({.turbulence = 0, .frequency = 1, .drag = 2}); }},
      {"step", [](Solver& s) { s.set_time_step(1.0 / 30, 4); }},
      {"pins gone", [](Solver& s) { s.set_pins(0, {}); }},
      {"collider moved there", [](Solver& s) { s.set_colliders(std::vector{ball_at(0.1F)}); }},
      {"collider moved past", [](Solver& s) { s.set_colliders(std::vector{ball_at(-1)}); }},
      {"collider placed", [](Solver& s) { s.set_colliders(std::vector{ball_at(0.1F)}, true); }},
      {"collider gone", [](Solver& s) { s.set_colliders({}); }},
      {"parent",
       [](Solver& s) {
         s.set_parent(0, {{0, 0.01F, 0}, {}, 1});
       }},
      {"teleport",
       [](Solver& s) {
         s.set_parent(0, {{0, 1, 0}, {}, 1}, {1, 1, 1}, true);
       }},
      {"cut",
       [](Solver& s) {
         s.cut(0, {Vec3{-3, 0.02F, -2}, Vec3{3, 0.02F, -2}, Vec3{0, 0.02F, 4}});
       }},
      {"written", [](Solver& s) { s.write_state(0, positions_of(s), test::velocities_of(s)); }},
      {"same gravity",
       [](Solver& s) {
         s.set_gravity({0, -9.81F, 0});
       },
       false},
      {"same air", [&](Solver& s) { s.set_wind(still); }, false},
      {"collider moved elsewhere", [](Solver& s) { s.set_colliders(std::vector{ball_at(0.5F)}); }, false},
      {"same collider", [](Solver& s) { s.set_colliders(std::vector{ball_at(1)}); }, false},
      {"same pins", [&](Solver& s) { s.set_pins(0, pins_at_rest(*cloth.asset, "top")); }, false},
      {"same step", [](Solver& s) { s.set_time_step(1.0 / 60, 4); }, false},
      {"same parent", [](Solver& s) { s.set_parent(0, {}); }, false}};
  for (const Disturbance& disturbance : disturbances) {
    SCOPED_TRACE(disturbance.name);
    Solver solver = hanging();
    solver.set_colliders(std::vector{ball_at(1)});
    solver.set_wind(still);
    solver.set_parent(0, {});
    run_to_sleep(solver);
    disturbance.disturb(solver);
    solver.step();
    EXPECT_EQ(solver.asleep(0), !disturbance.wakes);
    if (disturbance.wakes) {
      solver.step();
      EXPECT_FALSE(solver.asleep(0));
    }
  }
}

TEST(Sleeping, IsPartOfAScene) {
  const Scene scene = parse_scene(
      R"({ "version": 1, "cloths": [ { "asset": "a.glb" } ], "sleep": { "speed": 0.02, "time": 1.5 } })", "s.json");
  EXPECT_EQ(scene.sleep_speed, 0.02F);
  EXPECT_EQ(scene.sleep_time, 1.5F);
  EXPECT_EQ(parse_scene(R"({ "version": 1, "cloths": [ { "asset": "a.glb" } ] })", "s.json").sleep_speed, 0);
  EXPECT_THROW(static_cast<void>(parse_scene(
                   R"({ "version": 1, "cloths": [ { "asset": "a.glb" } ], "sleep": { "speed": -1 } })", "s.json")),
               Error);
  SolverSettings settings = sleepy();
  settings.sleep_time = -1;
  EXPECT_THROW(hanging(settings), Error);
}

}  // namespace
}  // namespace geocloth
