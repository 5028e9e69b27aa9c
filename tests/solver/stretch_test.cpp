// SPDX-License-Identifier: GPL-3.0-or-later
// How far cloth that hangs is stretched, with as few substeps as games can pay: where NvCloth with tethers at the same
// work was measured to stretch the sheet by 11.6 % at most. Its scene does not tell the ball, so every ball has to do.

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "solver_fixture.h"
#include "support/swing.h"

namespace geocloth {
namespace {

constexpr uint32_t kFiveSeconds = 300;

class Ball : public ::testing::TestWithParam<std::pair<double, double>> {};

TEST_P(Ball, StretchesASheetByLessThanNvClothAtEightSubsteps) {
  const auto [ball, behind] = GetParam();
  const StretchStatistics stretch = test::stretch_of_swing({.ball = ball, .behind = behind}, kFiveSeconds);
  RecordProperty("max_percent", std::to_string(100 * (stretch.max - 1)));
  RecordProperty("mean_percent", std::to_string(100 * (stretch.mean - 1)));
  EXPECT_LE(stretch.max, 1.11);
  EXPECT_LE(stretch.p99, 1.045);
  EXPECT_LE(stretch.mean, 1.008);
}

INSTANTIATE_TEST_SUITE_P(Swing, Ball,
                         ::testing::Values(std::pair{0.1, 0.0}, std::pair{0.15, 0.0}, std::pair{0.2, 0.0},
                                           std::pair{0.3, 0.0}, std::pair{0.15, -0.1}, std::pair{0.15, 0.1},
                                           std::pair{0.25, 0.15}));

TEST(Swing, SixteenSubstepsHalveIt) {
  const StretchStatistics stretch = test::stretch_of_swing({.substeps = 16}, kFiveSeconds);
  RecordProperty("max_percent", std::to_string(100 * (stretch.max - 1)));
  EXPECT_LE(stretch.max, 1.05);
  EXPECT_LE(stretch.mean, 1.0028);
}

// The worst case: two seams cross where the ball presses, and spans end at seams (18 %, uncut 5 %).
TEST(Swing, CutIntoChartsItStretchesLittleMore) {
  const StretchStatistics stretch = test::stretch_of_swing({.charts = 2}, kFiveSeconds);
  RecordProperty("max_percent", std::to_string(100 * (stretch.max - 1)));
  EXPECT_LE(stretch.max, 1.20);
  EXPECT_LE(stretch.mean, 1.008);
}

// Spans, attachments and contacts take energy and give none, at any number of substeps.
TEST(Swing, OntoABallGainsNoEnergy) {
  for (const uint32_t substeps : {8U, 16U, 60U}) {
    test::SwingScene scene = test::make_swing({.points = 33, .substeps = substeps, .ball = 0.2});
    double highest = -1;
    for (uint32_t f = 0; f < 120; ++f) {
      scene.solver.step();
      const Energy e = measure_energy(scene.cloth, {0, -9.81F, 0}, test::positions_of(scene.solver),
                                      test::velocities_of(scene.solver));
      highest = std::max(highest, e.kinetic + e.potential);
    }
    EXPECT_LE(highest, 0.0) << substeps;
  }
}

TEST(Spans, AreTheSameOnEveryPath) {
  for (const uint32_t charts : {1U, 2U}) {
    for (const uint32_t relaxation_steps : {1U, 2U}) {
      test::Swing swing{.points = 61, .charts = charts, .relaxation_steps = relaxation_steps};
      test::SwingScene swept = test::make_swing(swing);
      swing.path = SolverPath::plain;
      test::SwingScene plain = test::make_swing(swing);
      for (test::SwingScene* scene : {&swept, &plain}) test::run(scene->solver, 40);
      EXPECT_EQ(hash_state(*swept.cloth.asset, test::positions_of(swept.solver)),
                hash_state(*plain.cloth.asset, test::positions_of(plain.solver)))
          << charts << ' ' << relaxation_steps;
    }
  }
}

}  // namespace
}  // namespace geocloth
