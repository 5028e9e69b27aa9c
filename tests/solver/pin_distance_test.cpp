// SPDX-License-Identifier: GPL-3.0-or-later
// Pins that let their points go as far as a distance from where they would be: what keeps a coat near its animated skin
// without taking its motion from it.

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::SheetOptions;

const SheetOptions kSheet{.nx = 21, .ny = 21, .width = 0.5, .height = 0.5, .charts_x = 2};
constexpr float kFar = 0.05F;  // [m]

/// Every point may go so far from where it is at rest.
std::vector<Pin> leashes(const ClothAsset& asset, float max_distance, const Vec3& shift = {}) {
  std::vector<Pin> pins;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (asset.valid(p))
      pins.push_back({.pixel = p, .target = asset.rest_position[p] + shift, .max_distance = max_distance});
  }
  return pins;
}

/// [m] Of the farthest point from its target.
float farthest(const std::vector<Pin>& pins, Solver& solver) {
  const std::vector<Vec3> position = test::positions_of(solver);
  float way = 0;
  for (const Pin& pin : pins) way = std::max(way, length(position[pin.pixel] - pin.target));
  return way;
}

TEST(PinDistance, InAGaleEveryPointIsFreeAsFarAsItsDistance) {
  const ClothAsset asset = make_sheet(kSheet);
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  const std::vector<Pin> pins = leashes(asset, kFar);
  solver.set_wind({.velocity = {0, 0, 15}, .turbulence = 0.5F, .frequency = 3});
  float most = 0, least = 1;
  for (int f = 0; f < 60; ++f) {
    solver.set_pins(0, pins);
    solver.step();
    const float way = farthest(pins, solver);
    most = std::max(most, way);
    if (f > 20) least = std::min(least, way);
  }
  EXPECT_LT(most, kFar + 5e-4F);
  EXPECT_GT(least, 0.9F * kFar) << "the wind has not blown it that far: the test shows nothing";
  EXPECT_LT(solver.statistics().copy_gap, 1e-6);
}

TEST(PinDistance, TargetsThatMoveTakeTheClothAlongOnceTheyAreFarEnough) {
  const ClothAsset asset = make_sheet(kSheet);
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  Solver solver(std::vector{test::describe(asset, test::undamped())}, settings);
  Vec3 shift;
  for (int f = 1; f <= 60; ++f) {
    shift.x += 0.03F;
    const std::vector<Pin> pins = leashes(asset, kFar, shift);
    solver.set_pins(0, pins);
    solver.step();
    EXPECT_LT(farthest(pins, solver), kFar + 1e-4F) << f;
    if (shift.x < 0.9F * kFar) {
      EXPECT_NEAR(farthest(leashes(asset, kFar), solver), 0, 1e-5) << "it was taken along at once";
    }
  }
}

TEST(PinDistance, WhatHangsByOneHangsThatMuchLower) {
  const SheetOptions strip{.nx = 9, .ny = 81, .width = 0.1F, .height = 1};
  const ClothAsset asset = make_sheet(strip);
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  std::vector<Pin> pins = test::pins_at_rest(asset, "top");
  for (Pin& pin : pins) pin.max_distance = kFar;
  for (int f = 0; f < 240; ++f) {
    solver.set_pins(0, pins);
    solver.step();
  }
  for (const Pin& pin : pins) {
    const Vec3 way = test::positions_of(solver)[pin.pixel] - pin.target;
    EXPECT_NEAR(way.y, -kFar, 3e-3F);  // the springs below pull once more after it
  }
}

TEST(PinDistance, FarAwayItIsNoPin) {
  const ClothAsset asset = make_sheet(kSheet);
  const auto fallen = [&](const std::vector<Pin>& pins) {
    Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
    solver.set_pins(0, pins);
    test::run(solver, 20);
    return test::positions_of(solver);
  };
  const std::vector<Vec3> free = fallen({}), on_leash = fallen(leashes(asset, 100));
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) EXPECT_LT(length(free[p] - on_leash[p]), 1e-5F);
}

TEST(PinDistance, ASoftOneIsDrawnWithinIt) {
  const ClothAsset asset = make_sheet(kSheet);
  const auto way = [&](float frequency, float max_distance) {
    Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
    std::vector<Pin> pins = leashes(asset, max_distance);
    for (Pin& pin : pins) pin.frequency = frequency;
    solver.set_pins(0, pins);
    test::run(solver, 120);
    return farthest(pins, solver);
  };
  // A spring of the frequency f carries a weight g / (2 pi f)^2 below its end: 0.248 m for 1/s, 0.0099 m for 5/s.
  EXPECT_NEAR(way(5, kFar), 0.00994F, 2e-4F);
  EXPECT_NEAR(way(5, 0), 0.00994F, 2e-4F);
  EXPECT_NEAR(way(1, kFar), kFar, 1e-3F);
  EXPECT_NEAR(way(1, 0), 0.2485F, 5e-3F);
}

// The ball is round: a point that has gone to the side gets lower than one that lies on its top.
TEST(PinBackstop, PointsComeToRestOnIt) {
  const ClothAsset asset = make_sheet({.nx = 21, .ny = 21, .width = 0.5, .height = 0.5, .charts_x = 2});
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {0, 0, -9.81F};  // the sheet lies in x and y
  const auto rests_at = [&](const Backstop& backstop) {
    Solver solver(std::vector{test::describe(asset)}, settings);
    std::vector<Pin> pins = leashes(asset, kFar);
    for (Pin& pin : pins) pin.backstop = backstop;
    solver.set_pins(0, pins);
    test::run(solver, 60);
    float lowest = 0, highest = -1;
    for (const Pin& pin : pins) {
      const float z = test::positions_of(solver)[pin.pixel].z;
      lowest = std::min(lowest, z);
      highest = std::max(highest, z);
    }
    EXPECT_NEAR(lowest, highest, 1e-4F);
    EXPECT_LT(solver.statistics().copy_gap, 1e-6);
    return lowest;
  };
  EXPECT_NEAR(rests_at({{0, 0, 1}, 0.02F, 0.1F}), -0.02F, 1e-4F);
  EXPECT_NEAR(rests_at({{0, 0, 1}, 0, 10}), 0, 1e-4F);
  EXPECT_NEAR(rests_at({{0, 0, 1}, 0.2F, 0.1F}), -kFar, 1e-3F) << "the distance comes first";
  const float aside = std::sqrt(0.5F);  // 5 cm below its target a point is on the far side of a ball of 2 cm
  EXPECT_NEAR(rests_at({{aside, 0, aside}, 0.001F, 0.01F}), -kFar, 1e-3F);
}

TEST(PinBackstop, OneThatIsNoneIsRefused) {
  const ClothAsset asset = make_sheet(kSheet);
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  const auto said = [&](const Pin& pin) -> std::string {
    try {
      solver.set_pins(0, std::vector{pin});
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  const auto has = [&](const Pin& pin, const std::string& part) {
    EXPECT_NE(said(pin).find("pin of pixel 0: " + part), std::string::npos) << said(pin);
  };
  const Backstop good{{0, 1, 0}};
  EXPECT_EQ(said({.pixel = 0, .max_distance = 1, .backstop = good}), "nothing");
  EXPECT_EQ(said({.pixel = 0, .frequency = 1, .backstop = good}), "nothing");
  has({.pixel = 0, .backstop = good}, "a backstop is for points that are not held");
  has({.pixel = 0, .max_distance = 1, .backstop = Backstop{{0, 0, 0}}}, "the normal of its backstop");
  has({.pixel = 0, .max_distance = 1, .backstop = Backstop{{0, std::nanf(""), 0}}}, "the normal of its backstop");
  has({.pixel = 0, .max_distance = 1, .backstop = Backstop{{0, 1, 0}, -1}}, "the distance of its backstop");
  for (const float radius : {0.F, 1000.F, std::nanf("")})
    has({.pixel = 0, .max_distance = 1, .backstop = Backstop{{0, 1, 0}, 0, radius}}, "the radius of its backstop");
}

TEST(PinDistance, OnlyThoseWithoutOneAreHeld) {
  const ClothAsset asset = make_sheet(kSheet);
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  std::vector<Pin> pins = test::pins_at_rest(asset, "top");
  pins.front().max_distance = kFar;
  solver.set_pins(0, pins);
  const std::vector<uint32_t> held = solver.held_pixels(0);
  EXPECT_FALSE(std::ranges::binary_search(held, pins.front().pixel));
  EXPECT_TRUE(std::ranges::binary_search(held, pins.back().pixel));
}

TEST(PinDistance, OneThatIsNoDistanceIsRefused) {
  const ClothAsset asset = make_sheet(kSheet);
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  for (const float bad : {-1.F, std::nanf(""), HUGE_VALF}) {
    try {
      solver.set_pins(0, std::vector{Pin{.pixel = 0, .max_distance = bad}});
      ADD_FAILURE() << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
      EXPECT_NE(std::string(error.what()).find("pin of pixel 0: max_distance"), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace geocloth
