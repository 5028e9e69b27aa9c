// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth that is drawn too far tears: from its weakest place on and across the pull, and not to dust.

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include "geocloth/asset/error.h"
#include "geocloth/solver/scene.h"
#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

const test::SheetOptions kStrip{.nx = 13, .ny = 25, .width = 0.24F, .height = 0.48F};
constexpr float kTears = 1.3F;

size_t count_parts(const ClothAsset& asset) {
  const std::vector<uint32_t> part = connected_parts(asset);
  std::set<uint32_t> parts;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) parts.insert(part[p]);
  return parts.size();
}

/// Springs of warp and weft that two assets do not share.
std::vector<uint32_t> severed(const ClothAsset& before, const ClothAsset& after) {
  std::vector<uint32_t> pixels;
  for (uint32_t p = 0; p < before.pixel_count(); ++p)
    if (((before.spring_mask[p] ^ after.spring_mask[p]) & 3) != 0) pixels.push_back(p);
  return pixels;
}

class Tearing : public test::MachineTest<> {
 protected:
  [[nodiscard]] Solver strip(const ClothAsset& asset) {
    SolverSettings settings;
    settings.gravity = {};
    return make(test::describe(asset), settings);
  }
  /// Draws the ends of a strip apart.
  static void draw(Solver& solver, const ClothAsset& asset, float way) {
    std::vector<Pin> pins = test::pins_at_rest(asset, "top", {0, 0.5F * way, 0});
    const std::vector<Pin> below = test::pins_at_rest(asset, "bottom", {0, -0.5F * way, 0});
    pins.insert(pins.end(), below.begin(), below.end());
    solver.set_pins(0, pins);
  }
};

TEST_P(Tearing, AStripThatIsDrawnApartEndsInTwo) {
  const ClothAsset asset = test::make_sheet(kStrip);
  Solver solver = strip(asset);
  CutResult torn;
  for (int f = 0; f < 40; ++f) {
    draw(solver, asset, 0.008F * static_cast<float>(f));  // in the end by two thirds of its length
    torn += solver.tear(0, kTears);
    solver.step();
  }
  EXPECT_GE(torn.springs, 13U);
  EXPECT_GT(torn.cells, 11U);
  const ClothAsset& after = *solver.asset(0);
  EXPECT_EQ(count_parts(asset), 1U);
  EXPECT_GE(count_parts(after), 2U);
  EXPECT_LE(count_parts(after), 6U) << "it has fallen to dust";
  EXPECT_LT(severed(asset, after).size(), asset.pixel_count() / 4) << "it has fallen to dust";
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST_P(Tearing, ACrackGoesOnFromWhereItBegan) {
  const ClothAsset asset = test::make_sheet(kStrip);
  Solver solver = strip(asset);
  const float notch = asset.rest_position[test::sheet_pixel(kStrip, 0, 12)].y - 0.01F;
  solver.cut(0, {Vec3{-0.5F, notch, -1}, Vec3{-0.5F, notch, 1}, Vec3{-0.05F, notch, 0}});
  const ClothAsset notched = *solver.asset(0);
  ASSERT_EQ(count_parts(notched), 1U);
  for (int f = 0; f < 100; ++f) {  // slowly: what is drawn fast is longer near its ends
    draw(solver, asset, 0.0016F * static_cast<float>(f));
    solver.tear(0, kTears);
    solver.step();
  }
  const std::vector<uint32_t> torn = severed(notched, *solver.asset(0));
  ASSERT_GT(torn.size(), 5U);
  const auto is_beside = [&](uint32_t p) {
    const uint32_t row = p / asset.width;
    return row >= 10 && row <= 14;
  };
  EXPECT_GE(std::ranges::count_if(torn, is_beside), static_cast<std::ptrdiff_t>(torn.size() * 4 / 5));
}

TEST_P(Tearing, ClothThatHangsIsWhole) {
  const ClothAsset asset = test::make_sheet({.nx = 13, .ny = 13, .charts_x = 2});
  const auto hung = [&](bool tears) {
    Solver solver = make(test::describe(asset), SolverSettings());
    solver.set_pins(0, test::pins_at_rest(asset, "top"));
    for (int f = 0; f < (machine().slow() ? 4 : 30); ++f) {
      if (tears) {
        EXPECT_EQ(solver.tear(0, kTears), CutResult());
      }
      solver.step();
    }
    return test::positions_of(solver);
  };
  EXPECT_EQ(hung(true), hung(false));
}

TEST_P(Tearing, AStretchThatIsNoneIsRefused) {
  const ClothAsset asset = test::make_sheet(kStrip);
  Solver solver = strip(asset);
  for (const float bad : {1.F, 0.F, std::numeric_limits<float>::quiet_NaN()}) {
    EXPECT_THROW(static_cast<void>(solver.tear(0, bad)), Error) << bad;
  }
  EXPECT_THROW(static_cast<void>(solver.tear(1, kTears)), Error);
}

INSTANTIATE_TEST_SUITE_P(On, Tearing, test::first_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
