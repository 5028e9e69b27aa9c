// SPDX-License-Identifier: GPL-3.0-or-later
// Cloths against each other: a jacket stays outside the shirt, a blanket on the sheet, whatever grids they have; who
// asks for nothing moves as before, and nothing is gained or lost in between.

#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/self_contact.h"

namespace geocloth::test {
namespace {

SheetOptions level_sheet(uint32_t points, float size, float y) {
  return {.nx = points, .ny = points, .width = size, .height = size, .horizontal = true, .center = {0, y, 0}};
}

ClothDesc meeting(const SheetOptions& options, bool meets = true) {
  ClothDesc cloth = describe(make_sheet(options));
  if (meets) cloth.inter_collision = InterCollision{};
  return cloth;
}

/// A sheet that hangs between two of its edges, and a smaller one above it.
std::vector<ClothDesc> sheet_and_blanket(bool meets, uint32_t points = 31, uint32_t blanket_points = 31) {
  return {meeting(level_sheet(points, 0.6F, 0), meets), meeting(level_sheet(blanket_points, 0.3F, 0.1F), meets)};
}

Solver spread(const std::vector<ClothDesc>& cloths, SolverSettings settings = cpu_settings()) {
  Solver solver(cloths, settings);
  std::vector<Pin> pins = pins_at_rest(*cloths[0].asset, "left");
  for (const Pin& pin : pins_at_rest(*cloths[0].asset, "right")) pins.push_back(pin);
  solver.set_pins(0, pins);
  return solver;
}

/// Pairs of triangles that cut through each other, one of each cloth: they have grids of the same width.
uint64_t count_cuts(Solver& solver) {
  const ClothAsset &first = *solver.asset(0), &second = *solver.asset(1);
  const ClothAsset both = beside(first, second);
  std::vector<Vec3> positions = positions_of(solver);
  positions.resize(positions.size() + first.width);
  const std::vector<Vec3> others = positions_of(solver, 1);
  positions.insert(positions.end(), others.begin(), others.end());
  return count_intersections(both, positions) - count_intersections(first, positions_of(solver)) -
         count_intersections(second, others);
}

float lowest(const std::vector<Vec3>& positions) {
  float y = positions.front().y;
  for (const Vec3& p : positions) y = std::min(y, p.y);
  return y;
}

TEST(InterCollision, ABlanketLiesOnASheet) {
  const std::vector<ClothDesc> cloths = sheet_and_blanket(true);
  Solver solver = spread(cloths);
  for (int k = 0; k < 10; ++k) {
    run(solver, 12);
    EXPECT_EQ(count_cuts(solver), 0U) << "after " << 12 * (k + 1) << " frames";
  }
  EXPECT_GE(lowest(positions_of(solver, 1)), lowest(positions_of(solver)));
  EXPECT_LE(measure_stretch(*cloths[0].asset, 1, positions_of(solver)).max, 1.15);

  Solver other = spread(sheet_and_blanket(false));
  run(other, 120);
  EXPECT_LE(lowest(positions_of(other, 1)), -1) << "there was nothing to prevent";
}

TEST(InterCollision, GridsMayDiffer) {
  for (const auto& [sheet, blanket] : {std::pair{13U, 41U}, std::pair{49U, 9U}}) {
    Solver solver = spread(sheet_and_blanket(true, sheet, blanket));
    run(solver, 120);
    EXPECT_GE(lowest(positions_of(solver, 1)), lowest(positions_of(solver))) << sheet << " and " << blanket;
  }
}

TEST(InterCollision, WhatAsksForNothingMovesAsBefore) {
  // One of two asks: there is nobody for it to meet. And two that ask, but do not meet, move as if they had not.
  const auto hash_of = [](const std::vector<ClothDesc>& cloths, uint32_t frames) {
    Solver solver = spread(cloths);
    run(solver, frames);
    return std::array{hash_state(*cloths[0].asset, positions_of(solver)),
                      hash_state(*cloths[1].asset, positions_of(solver, 1))};
  };
  std::vector<ClothDesc> one = sheet_and_blanket(false);
  one[1].inter_collision = InterCollision{};
  EXPECT_EQ(hash_of(one, 60), hash_of(sheet_and_blanket(false), 60));
  EXPECT_EQ(hash_of(sheet_and_blanket(true), 5), hash_of(sheet_and_blanket(false), 5));
  EXPECT_NE(hash_of(sheet_and_blanket(true), 60), hash_of(sheet_and_blanket(false), 60));
}

TEST(InterCollision, CopiesOfASeamGoTogether) {
  std::vector<ClothDesc> cloths = sheet_and_blanket(true);
  for (ClothDesc& cloth : cloths) {
    SheetOptions options = level_sheet(25, cloth.asset == cloths[0].asset ? 0.6F : 0.3F, 0.1F);
    if (cloth.asset == cloths[0].asset) options.center = {};
    options.charts_x = 3;
    options.charts_y = 2;
    cloth = meeting(options);
  }
  Solver solver = spread(cloths);
  run(solver, 120);
  EXPECT_EQ(solver.statistics().copy_gap, 0);
  EXPECT_EQ(count_cuts(solver), 0U);
  EXPECT_GE(lowest(positions_of(solver, 1)), lowest(positions_of(solver)));
}

TEST(InterCollision, ThreadsAndPathsGiveTheSameBits) {
  std::vector<ClothDesc> cloths = sheet_and_blanket(true, 41, 41);
  cloths.push_back(meeting(level_sheet(13, 0.2F, 0.15F)));
  cloths.push_back(meeting(level_sheet(13, 0.2F, 0.2F), false));
  const auto play = [&](uint32_t threads, SolverPath path) {
    SolverSettings settings = cpu_settings();
    settings.threads = threads;
    settings.path = path;
    Solver solver = spread(cloths, settings);
    run(solver, 40);
    std::vector<uint64_t> hashes;
    for (uint32_t c = 0; c < cloths.size(); ++c)
      hashes.push_back(hash_state(*cloths[c].asset, positions_of(solver, c)));
    return hashes;
  };
  const std::vector<uint64_t> first = play(1, SolverPath::automatic);
  for (const uint32_t threads : {1U, 2U, 3U, 5U}) EXPECT_EQ(play(threads, SolverPath::automatic), first) << threads;
  EXPECT_EQ(play(1, SolverPath::plain), first);
  EXPECT_EQ(play(2, SolverPath::plain), first);
}

// Two layers of a cell may be in one bucket of the hash: their points were listed twice by whoever looked through both,
// and pushed twice as hard. Which cells do depends on the place.
TEST(InterCollision, NobodyIsPushedTwiceWhereverThreeClothsMeet) {
  const auto ends_at = [](float place, SolverPath path) {
    std::vector<ClothDesc> cloths;
    for (const float y : {0.F, 0.4F, 0.8F})
      cloths.push_back(meeting({.nx = 9, .ny = 9, .horizontal = true, .center = {place, y, 0.6F * place}}));
    SolverSettings settings = cpu_settings();
    settings.path = path;
    settings.substeps = 2;
    Solver solver(cloths, settings);
    for (uint32_t c = 0; c < 3; ++c) {  // nearer than they keep
      std::vector<Vec3> together = positions_of(solver, c);
      for (Vec3& p : together) p.y = 0.04F * static_cast<float>(c);
      solver.write_state(c, together, std::vector<Vec3>(together.size()));
    }
    run(solver, 1);
    return std::array{positions_of(solver, 0), positions_of(solver, 1), positions_of(solver, 2)};
  };
  for (int k = 0; k < 60; ++k) {
    const float place = 1.37F * static_cast<float>(k);
    ASSERT_EQ(ends_at(place, SolverPath::plain), ends_at(place, SolverPath::automatic)) << place;
  }
}

TEST(InterCollision, LayersThatStartNearerStayThere) {
  // A lining a millimetre inside: it must not be blown out to the distance.
  std::vector<ClothDesc> cloths{meeting(level_sheet(21, 0.4F, 0)), meeting(level_sheet(21, 0.4F, 0.001F))};
  SolverSettings settings = cpu_settings();
  settings.gravity = {};
  Solver solver(cloths, settings);
  run(solver, 30);
  for (uint32_t c = 0; c < 2; ++c) {
    const std::vector<Vec3> positions = positions_of(solver, c);
    for (size_t p = 0; p < positions.size(); ++p)
      EXPECT_LE(length(positions[p] - cloths[c].asset->rest_position[p]), 1e-6F);
  }
}

/// Two squares that fly at each other at 2 m/s, the upper one sideways too.
TEST(InterCollision, MomentumIsKept) {
  std::vector<ClothDesc> cloths{meeting(level_sheet(13, 0.2F, 0)), meeting(level_sheet(17, 0.2F, 0.05F))};
  cloths[1].material.areal_density *= 3;
  for (ClothDesc& cloth : cloths) cloth.material.damping = 0;
  SolverSettings settings = cpu_settings();
  settings.gravity = {};
  Solver solver(cloths, settings);
  solver.write_state(1, positions_of(solver, 1), std::vector<Vec3>(cloths[1].asset->pixel_count(), {0.5F, -2, 0}));
  const auto momentum = [&](uint32_t axis) {
    double sum = 0;
    for (uint32_t c = 0; c < 2; ++c) {
      const std::vector<Vec3> v = velocities_of(solver, c);
      const std::vector<double> mass = masses_of(cloths[c]);
      for (size_t p = 0; p < v.size(); ++p)
        sum += mass[p] * static_cast<double>(axis == 0 ? v[p].x : axis == 1 ? v[p].y : v[p].z);
    }
    return sum;
  };
  const std::array before{momentum(0), momentum(1), momentum(2)};
  run(solver, 30);
  EXPECT_LE(velocities_of(solver)[84].y, -0.5F) << "nothing collided";
  for (uint32_t k = 0; k < 3; ++k) EXPECT_NEAR(momentum(k), before[k], 1e-4 * std::abs(before[1])) << "axis " << k;
}

TEST(InterCollision, FrictionOfBothHoldsABlanketOnASlope) {
  // By 20 degrees: a slope of 0.36. The sheet is held everywhere.
  const auto slide = [](float friction) {
    std::vector<ClothDesc> cloths{meeting(level_sheet(21, 0.6F, 0)), meeting(level_sheet(11, 0.2F, 0.04F))};
    for (ClothDesc& cloth : cloths) cloth.material.friction = friction;
    SolverSettings settings = cpu_settings();
    constexpr float kSteep = 0.349F;
    settings.gravity = {9.81F * std::sin(kSteep), -9.81F * std::cos(kSteep), 0};
    Solver solver(cloths, settings);
    std::vector<Pin> pins;
    for (uint32_t p = 0; p < cloths[0].asset->pixel_count(); ++p)
      pins.push_back({p, cloths[0].asset->rest_position[p]});
    solver.set_pins(0, pins);
    run(solver, 30);
    const float x = positions_of(solver, 1)[60].x;
    run(solver, 15);
    return positions_of(solver, 1)[60].x - x;
  };
  EXPECT_LE(slide(0.9F), 0.002F);
  EXPECT_GE(slide(0), 0.1F);  // points as balls have to climb over each other
}

TEST(InterCollision, LayersDoNotCreepDownASlope) {
  // A jacket over a shirt stays on its wearer: by 15 degrees, a slope of 0.27, friction of 0.5 holds both. What layers
  // press each other aside by is no speed, but the floor has to hold it, too: both crept by 4 mm a second.
  std::vector<ClothDesc> cloths{meeting(level_sheet(16, 0.2F, 0.004F)), meeting(level_sheet(16, 0.2F, 0.03F))};
  for (ClothDesc& cloth : cloths) cloth.material.friction = 0.5F;
  SolverSettings settings = cpu_settings();
  settings.substeps = 16;
  constexpr float kSteep = 0.2618F;
  settings.gravity = {9.81F * std::sin(kSteep), -9.81F * std::cos(kSteep), 0};
  Solver solver(cloths, settings);
  const std::vector<Collider> floor{{"floor", Plane{{}, {0, 1, 0}}, 0.5F, {}}};
  solver.set_colliders(floor);
  const auto middle_of = [&](uint32_t cloth) { return positions_of(solver, cloth)[136].x; };
  run(solver, 240);
  const std::array before{middle_of(0), middle_of(1)};
  run(solver, 240);
  for (const uint32_t cloth : {0U, 1U}) EXPECT_NEAR(middle_of(cloth), before[cloth], 2e-4F) << "cloth " << cloth;
}

TEST(InterCollision, ACutLetsTheBlanketFall) {
  std::vector<ClothDesc> cloths = sheet_and_blanket(true);
  for (ClothDesc& cloth : cloths) cloth.self_collision = SelfCollision{};  // the sheet crumples
  Solver solver = spread(cloths);
  run(solver, 60);
  // The sheet is severed beside both of its pinned edges.
  for (const float x : {-0.25F, 0.25F})
    EXPECT_GT(solver.cut(0, {Vec3{x, -2, -3}, Vec3{x, -2, 3}, Vec3{x, 4, 0}}).springs, 0U);
  run(solver, 30);
  EXPECT_LE(lowest(positions_of(solver, 1)), -0.5F);
  EXPECT_EQ(count_cuts(solver), 0U) << "it falls with the sheet, not through it";
}

TEST(InterCollision, ClothsFallAsleepAndWakeTogether) {
  std::vector<ClothDesc> cloths = sheet_and_blanket(true, 21, 21);
  for (ClothDesc& cloth : cloths) cloth.material.damping = 4;
  SolverSettings settings = cpu_settings();
  settings.sleep_speed = 0.02F;
  Solver solver = spread(cloths, settings);
  uint32_t frames = 0;
  for (; frames < 900 && !solver.asleep(0); ++frames) {
    solver.step();
    EXPECT_EQ(solver.asleep(0), solver.asleep(1));
  }
  ASSERT_TRUE(solver.asleep(0));
  Collider ball;
  ball.shape = Sphere{{0, 0.3F, 0}, 0.02F};
  for (int f = 0; f < 60 && solver.asleep(0); ++f) {  // down onto the blanket
    std::get<Sphere>(ball.shape).center.y -= 0.01F;
    solver.set_colliders(std::vector<Collider>{ball}, f == 0);
    solver.step();
    EXPECT_EQ(solver.asleep(0), solver.asleep(1));
  }
  EXPECT_FALSE(solver.asleep(0));
}

TEST(InterCollision, NothingThatIsWrittenIntoAStateStopsIt) {
  const std::vector<ClothDesc> cloths = sheet_and_blanket(true, 13, 13);
  Solver solver(cloths, cpu_settings());
  const std::vector<Vec3> still(cloths[0].asset->pixel_count());
  for (const Vec3& place : {Vec3{0, 0.1F, 0}, Vec3{9e5F, 0.1F, -9e5F}, Vec3{0, 0.1F, 0}}) {
    for (uint32_t c = 0; c < 2; ++c) solver.write_state(c, std::vector<Vec3>(still.size(), place), still);
    run(solver, 3);
    for (uint32_t c = 0; c < 2; ++c) EXPECT_TRUE(all_finite(positions_of(solver, c)));
  }
}

TEST(InterCollision, WhatCannotBeIsRefused) {
  std::vector<ClothDesc> cloths = sheet_and_blanket(true);
  for (const float distance : {0.F, 10 * cloths[0].asset->spacing, std::numeric_limits<float>::quiet_NaN()}) {
    cloths[0].inter_collision = InterCollision{distance};
    EXPECT_THROW(Solver(cloths, cpu_settings()), Error) << distance;
  }
  cloths[0].inter_collision = InterCollision{2 * cloths[0].asset->spacing};
  EXPECT_NO_THROW(Solver(cloths, cpu_settings()));
  cloths[1].transform.scale = 0.01F;
  try {
    const Solver solver(cloths, cpu_settings());
    ADD_FAILURE() << "points of one would be lost between those of the other";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("cloth 0 has a spacing"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace geocloth::test
