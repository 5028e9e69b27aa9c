// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth moves as if the colliders that it does not meet did not exist. A cape that its wearer's arms catch on, or ten
// characters that push each other's skirts, are what people get otherwise.
#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

enum : uint32_t { kFloor = 1, kBall = 2, kThin = 4, kHull = 8 };

/// A floor, a fast ball, a thin rod that triangles meet, and a hull that comes closer.
std::vector<Collider> colliders_at(int frame) {
  const auto t = static_cast<float>(frame);
  std::vector<Collider> all{
      {"floor", Plane{{0, -0.55F, 0}, {0, 1, 0}}},
      {"ball", Sphere{{0.1F, -0.9F + 0.12F * t, 0.05F}, 0.15F}},
      {"rod", Capsule{{-1, -0.1F, 0.02F}, {1, -0.1F, 0.02F}, 0.01F, 0.01F}},
      {"hull",
       convex_hull(std::vector<Vec3>{{-0.3F, -0.4F, -0.4F}, {0.1F, -0.4F, -0.4F}, {0, 0, -0.4F}, {0, -0.2F, -0.1F}})}};
  for (uint32_t i = 0; i < all.size(); ++i) all[i].groups = 1U << i;
  all[3].pose.translate = {0, 0, 0.01F * t};
  return all;
}

std::vector<Collider> only(const std::vector<Collider>& all, uint32_t groups) {
  std::vector<Collider> out;
  for (const Collider& c : all)
    if ((c.groups & groups) != 0) out.push_back(c);
  return out;
}

ClothDesc sheet(uint32_t charts, uint32_t meets) {
  ClothDesc cloth = test::describe(test::make_sheet({.nx = 10, .ny = 10, .charts_x = charts, .charts_y = charts}));
  cloth.meets = meets;
  return cloth;
}

class CollisionGroups : public test::MachineTest<> {};
class CollisionGroupsOnEveryPath : public CollisionGroups {};

TEST_P(CollisionGroupsOnEveryPath, WhatAClothDoesNotMeetDoesNotExistForIt) {
  const bool also_plain = machine().backend == Backend::cpu;
  std::vector<ClothDesc> cloths{sheet(1, ~0U),   sheet(2, kFloor | kThin), sheet(1, 0),
                                sheet(2, kBall), sheet(1, kFloor | kThin), sheet(1, kHull | 64)};
  SolverSettings settings;
  settings.substeps = 4;
  settings.check_copies = true;
  const int frames = machine().slow() ? 5 : 12;
  if (machine().slow()) cloths.resize(3);
  for (const SolverPath path : {SolverPath::automatic, SolverPath::plain}) {
    if (path == SolverPath::plain && !also_plain) continue;
    settings.path = path;
    Solver together = make(cloths, settings);
    for (int f = 0; f < frames; ++f) {
      together.set_colliders(colliders_at(f), f == 0);
      together.step();
    }
    for (uint32_t c = machine().slow() ? 1 : 0; c < (machine().slowest() ? 2 : cloths.size()); ++c) {
      Solver alone = make(cloths[c], settings);
      for (int f = 0; f < frames; ++f) {
        alone.set_colliders(only(colliders_at(f), cloths[c].meets), f == 0);
        alone.step();
      }
      EXPECT_EQ(test::positions_of(together, c), test::positions_of(alone)) << c;
      EXPECT_EQ(test::velocities_of(together, c), test::velocities_of(alone)) << c;
      EXPECT_LE(alone.statistics().penetration, together.statistics().penetration) << c;
    }
    EXPECT_NE(test::positions_of(together, 0), test::positions_of(together, 1));
  }
}

/// One that comes from somewhere, goes on evenly and turns.
Collider thrown(std::mt19937& random, int frame) {
  std::uniform_real_distribution<float> any(-1, 1);
  const auto vector = [&](float most) {
    const float x = any(random), y = any(random), z = any(random);
    return most * Vec3{x, y, z};
  };
  const Vec3 from = vector(1.5F), way = (1.F / 6) * (vector(0.4F) - from), size = vector(0.1F), turn = vector(20);
  const Vec3 half{0.03F + std::abs(size.x), 0.03F + std::abs(size.y), 0.03F + std::abs(size.z)};
  const std::array<ColliderShape, 4> shapes{
      Sphere{{}, half.x}, Capsule{-4.F * half, 4.F * half, 0.03F, 0.1F}, Box{{0.2F, 0, 0}, half, {}},
      convex_hull(std::vector<Vec3>{{half.x, 0, 0}, {0, 3 * half.y, 0}, {0, 0, half.z}, {-half.x, -half.y, -half.z}})};
  const auto t = static_cast<float>(frame);
  return {"thrown", shapes[random() % shapes.size()], 0.3F, {from + t * way, quat_from_euler_deg(t * turn), 1}};
}

// Cloth is not told of what is far from where it can be, as the bodies of all others in a crowd: it must not miss
// anything by that, whether pins hold it or it flies about. Of two it is always told.
TEST_P(CollisionGroups, WhatIsFarAwayChangesNothing) {
  constexpr int kFrames = 10, kSettled = 31;  // where pins say where it is from half a second on
  SolverSettings settings;
  settings.substeps = 4;
  ClothDesc cloth = sheet(2, ~0U);
  cloth.material = find_material_preset("cotton")->material;
  int touched = 0;
  for (uint32_t seed = 0; seed < (machine().slow() ? 1U : 60U); ++seed) {
    SCOPED_TRACE(seed);
    Solver alone = make(cloth, settings), among = make(cloth, settings), free = make(cloth, settings);
    for (Solver* solver : {&alone, &among, &free}) {
      if (seed % 3 == 1) continue;
      solver->set_pins(0, test::pins_at_rest(*cloth.asset, seed % 3 == 0 ? "top" : "left"));
      test::run(*solver, kSettled);
    }
    for (int f = 0; f < kFrames; ++f) {
      std::mt19937 random(seed);
      std::vector<Collider> colliders{{"far", Sphere{{9, 0, 0}, 1}}, thrown(random, f)};
      alone.set_colliders(colliders, f == 0);
      const std::array<Vec3, 6> places{{{5, 0, 0}, {-5, 1, 0}, {0, 0, 6}, {0, 1, -5}, {0, 6, 0}, {0, -7, 1}}};
      for (uint32_t k = 0; k < (seed % 2 == 0 ? 6U : 18U); ++k)  // with few of them pins are asked alone
        colliders.insert(colliders.begin(), {"far", Sphere{(1 + 0.1F * static_cast<float>(k)) * places[k % 6], 1}});
      among.set_colliders(colliders, f == 0);
      for (Solver* solver : {&alone, &among, &free}) {
        if (seed % 6 == 4) solver->set_parent(0, {{0.05F * static_cast<float>(f), 0, 0}, {}, 1});
        solver->step();
      }
    }
    EXPECT_EQ(test::positions_of(among), test::positions_of(alone));
    EXPECT_EQ(test::velocities_of(among), test::velocities_of(alone));
    if (test::positions_of(alone) != test::positions_of(free)) ++touched;
  }
  EXPECT_GE(touched, machine().slow() ? 0 : 10);
}

TEST_P(CollisionGroups, ChangeWhileItRuns) {
  std::vector<ClothDesc> cloths{sheet(1, kFloor), sheet(1, kFloor)};
  SolverSettings settings;
  settings.substeps = 4;
  Solver solver = make(cloths, settings);
  std::vector<Collider> floor = only(colliders_at(0), kFloor);
  floor[0].shape = Plane{{0, -0.5F, 0}, {0, 1, 0}};
  solver.set_colliders(floor);
  test::run(solver, 4);
  solver.set_meets(1, kBall);
  test::run(solver, 6);
  const auto lowest = [&](uint32_t cloth) {
    float low = 1;
    for (const Vec3& p : test::positions_of(solver, cloth)) low = std::min(low, p.y);
    return low;
  };
  EXPECT_GT(lowest(0), -0.5F);
  EXPECT_LT(lowest(1), -0.55F);
  floor[0].groups = kBall;
  solver.set_colliders(floor);
  test::run(solver, 4);
  EXPECT_LT(lowest(0), -0.5F);
  EXPECT_GT(lowest(1), -0.5F);
  EXPECT_THROW(solver.set_meets(2, 0), Error);
}

/// A sheet that lies on a floor at once, and soon sleeps.
ClothDesc just_above_the_floor() {
  Material material;
  material.damping = 40;
  return test::describe(test::make_sheet({.nx = 6, .ny = 6, .horizontal = true, .center = {0, 0.003F, 0}}), material);
}

SolverSettings sleepy() {
  SolverSettings settings;
  settings.substeps = 2;
  settings.sleep_speed = 0.05F;
  settings.sleep_time = 0.05F;
  return settings;
}

// What lies on something falls when that is not there for it any more, though it was asleep.
TEST_P(CollisionGroups, AChangeWakesCloth) {
  const std::vector<ClothDesc> cloths(2, just_above_the_floor());
  Solver solver = make(cloths, sleepy());
  std::vector<Collider> floor{{"", Plane{{0, 0, 0}, {0, 1, 0}}}};
  solver.set_colliders(floor);
  for (int f = 0; f < 60 && !(solver.asleep(0) && solver.asleep(1)); ++f) solver.step();
  ASSERT_TRUE(solver.asleep(0) && solver.asleep(1));
  solver.set_meets(1, 2);
  test::run(solver, 3);
  EXPECT_TRUE(solver.asleep(0));
  EXPECT_FALSE(solver.asleep(1));
  EXPECT_LT(test::positions_of(solver, 1)[0].y, 0);
  floor[0].groups = 2;
  solver.set_colliders(floor);
  test::run(solver, 1);
  EXPECT_FALSE(solver.asleep(0));
}

// What is not met does not wake it, however near it comes.
TEST_P(CollisionGroups, SleepersSleepOnBesideWhatTheyDoNotMeet) {
  ClothDesc cloth = just_above_the_floor();
  cloth.meets = kFloor;
  Solver solver = make(cloth, sleepy());
  const auto scene_at = [](float x) {
    return std::vector<Collider>{{"", Plane{{0, 0, 0}, {0, 1, 0}}, 0.3F, {}, false, kFloor},
                                 {"", Sphere{{x, 0, 0}, 0.2F}, 0.3F, {}, false, kBall}};
  };
  int f = 0;
  for (; f < 60 && !solver.asleep(0); ++f) {
    solver.set_colliders(scene_at(2));
    solver.step();
  }
  ASSERT_TRUE(solver.asleep(0));
  for (int k = 0; k < 5; ++k) {
    solver.set_colliders(scene_at(2 - 0.5F * static_cast<float>(k)));
    solver.step();
    EXPECT_TRUE(solver.asleep(0)) << k;
  }
}

// Nor does what comes, jumps, grows or goes of that: in a crowd each has colliders of its own, and some always come.
TEST_P(CollisionGroups, SleepersSleepOnWhateverHappensToWhatTheyDoNotMeet) {
  ClothDesc cloth = just_above_the_floor();
  cloth.meets = kFloor;
  Solver solver = make(cloth, sleepy());
  const Collider floor{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, 0.3F, {}, false, kFloor};
  std::vector<Collider> scene{floor};
  solver.set_colliders(scene);
  for (int f = 0; f < 60 && !solver.asleep(0); ++f) solver.step();
  ASSERT_TRUE(solver.asleep(0));
  const auto sleeps_on = [&](const std::vector<Collider>& colliders) {
    solver.set_colliders(colliders);
    solver.step();
    return solver.asleep(0);
  };
  scene.insert(scene.begin(), {"ball", Sphere{{0, 0, 0}, 0.2F}, 0.3F, {}, false, kBall});
  EXPECT_TRUE(sleeps_on(scene)) << "one comes";
  scene[0].pose.translate = {1, 0, 0};
  scene[0].teleport = true;
  EXPECT_TRUE(sleeps_on(scene)) << "it jumps";
  scene[0].teleport = false;
  scene[0].shape = Sphere{{0, 0, 0}, 0.3F};
  EXPECT_TRUE(sleeps_on(scene)) << "it grows";
  std::vector<Collider> grown = scene;
  grown[0].friction = 0.5F;
  EXPECT_TRUE(sleeps_on(grown)) << "it becomes rough";
  const std::vector<std::byte> state = solver.save();
  solver.set_colliders(std::vector{floor});
  solver.restore(state);
  EXPECT_TRUE(sleeps_on(scene)) << "a state is restored";
  EXPECT_TRUE(sleeps_on({floor})) << "it goes";
  scene[0].groups = kBall | kFloor;
  scene[0].pose.translate = {9, 0, 0};
  EXPECT_FALSE(sleeps_on(scene)) << "one comes that it meets";
}

INSTANTIATE_TEST_SUITE_P(On, CollisionGroups, test::first_machine(), test::kMachineName);
INSTANTIATE_TEST_SUITE_P(On, CollisionGroupsOnEveryPath, test::every_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
