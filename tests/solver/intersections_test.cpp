// SPDX-License-Identifier: GPL-3.0-or-later
// Where cloth has got through cloth: what simulate reports and warns of.

#include "geocloth/solver/intersections.h"

#include <array>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/self_contact.h"

namespace geocloth::test {
namespace {

Intersections measured(const std::vector<PosedCloth>& cloths) {
  return geocloth::count_intersections(cloths);
}

ClothAsset sheet(bool horizontal, uint32_t charts = 1) {
  return make_sheet({.nx = 21,
                     .ny = 21,
                     .width = 1,
                     .height = 1,
                     .charts_x = charts,
                     .charts_y = charts,
                     .horizontal = horizontal,
                     .center = {0.011F, horizontal ? 0.013F : 0, horizontal ? 0.023F : 0}});
}

// A line across 20 cells of 5 cm goes through 40 triangles of either sheet.
TEST(Intersections, OfTwoSheetsThatCrossAreTheTrianglesAlongTheirLine) {
  const ClothAsset level = sheet(true), upright = sheet(false);
  const std::array cloths{PosedCloth{level, level.rest_position}, PosedCloth{upright, upright.rest_position}};
  const Intersections found = measured({cloths.begin(), cloths.end()});
  EXPECT_EQ(found.within, 0U);
  const ClothAsset both = beside(level, upright);
  EXPECT_EQ(found.between, count_intersections(both, both.rest_position));
  EXPECT_GE(found.between, 40U);

  const PosedCloth as_one{both, both.rest_position};
  const Intersections in_one = measured({as_one});
  EXPECT_EQ(in_one.within, found.between) << "what is within one cloth counts as that";
  EXPECT_EQ(in_one.between, 0U);
}

// A sheet that fell in a heap as if it were not there for itself; seams are no place where it cuts through itself.
TEST(Intersections, AgreeWithAnotherMeasureInAHeap) {
  for (const uint32_t charts : {1U, 2U}) {
    ClothDesc cloth = describe(sheet(false, charts));
    cloth.transform.rotate = quat_from_euler_deg({3, 0, 2});
    Solver solver(std::vector<ClothDesc>{cloth}, cpu_settings());
    Collider ball;  // a floor would have triangles in one plane
    ball.shape = Sphere{{0, -0.8F, 0}, 0.25F};
    solver.set_colliders(std::vector<Collider>{ball}, true);
    EXPECT_EQ(measured({PosedCloth{*cloth.asset, positions_of(solver)}}).within, 0U) << charts;
    run(solver, 90);
    const std::vector<Vec3> positions = positions_of(solver);
    const Intersections found = measured({PosedCloth{*cloth.asset, positions}});
    EXPECT_GT(found.within, 100U) << charts;
    const auto other = static_cast<double>(count_intersections(*cloth.asset, positions));
    EXPECT_NEAR(static_cast<double>(found.within), other, 0.01 * other) << charts << ": what touches is all the same";
  }
}

// What is sewn together lies in one place, 10 um apart here.
TEST(Intersections, AreNoneAtPointsThatAreSewn) {
  ClothAsset level = sheet(true), upright = sheet(false);
  ClothAsset both = beside(level, upright);
  const auto edge = [&](uint32_t x) { return 10 * both.width + x; };  // of the level sheet, amid the other one
  const uint32_t shift = (level.height + 1) * both.width;
  for (uint32_t x = 0; x < both.width; ++x) {
    both.rest_position[edge(x)] = both.rest_position[edge(x) + shift];
    both.rest_position[edge(x)].z += x % 2 == 0 ? 1e-5F : -1e-5F;
  }
  const auto within = [&] { return measured({PosedCloth{both, both.rest_position}}).within; };
  EXPECT_GT(within(), 0U);
  for (uint32_t x = 0; x < both.width; ++x) both.sewing.push_back({edge(x), edge(x) + shift});
  EXPECT_EQ(within(), 0U);
}

TEST(Intersections, LeaveOutWhatIsNotFiniteAndRefuseOtherSizes) {
  const ClothAsset level = sheet(true), upright = sheet(false);
  std::vector<Vec3> position = upright.rest_position;
  for (Vec3& p : position) p.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(measured({PosedCloth{level, level.rest_position}, PosedCloth{upright, position}}).between, 0U);
  EXPECT_EQ(measured({}).between, 0U);
  position.pop_back();
  EXPECT_THROW(static_cast<void>(measured({PosedCloth{upright, position}})), Error);
}

}  // namespace
}  // namespace geocloth::test
