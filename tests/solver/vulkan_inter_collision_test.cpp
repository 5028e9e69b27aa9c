// SPDX-License-Identifier: GPL-3.0-or-later
// Cloths against each other on Vulkan: the same bits as on the cpu where roots and divisions are exact, on every path.

#include <string>

#include <gtest/gtest.h>

#include "support/vulkan_play.h"

namespace geocloth::test {
namespace {

SheetOptions level_sheet(uint32_t points, float size, float y, uint32_t charts) {
  return {.nx = points,
          .ny = points,
          .width = size,
          .height = size,
          .charts_x = charts,
          .charts_y = charts,
          .horizontal = true,
          .center = {0, y, 0}};
}

/// A sheet that is held at one edge, one that falls onto it, and one beside them that meets nobody.
Play falling(uint32_t charts, SolverPath path = SolverPath::automatic) {
  const SheetOptions held = level_sheet(15, 0.3F, 0, charts);
  Play scene{.cloths = {cloth_of(level_sheet(9, 0.1F, 0.1F, 1)), cloth_of(held),
                        cloth_of(level_sheet(13, 0.2F, 0.03F, charts))},
             .settings = settings_of(8),
             .frames = 16};
  for (size_t c = 1; c < 3; ++c) scene.cloths[c].inter_collision = InterCollision{};
  scene.settings.path = path;
  scene.before_frame = [held, asset = scene.cloths[1].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) solver.set_pins(1, pins_of_top(held, *asset));
  };
  return scene;
}

class VulkanInterCollisionTest : public VulkanBackendTest {
 protected:
  /// How far the falling sheet is above where it would be alone [m].
  static float held_up(const Play& scene, const Outcome& outcome) {
    Play alone = scene;
    alone.cloths[2].inter_collision = {};
    alone.before_frame = [](Solver&, uint32_t) {};
    alone.settings.backend = Backend::cpu;
    const Outcome other = play(Solver(alone.cloths, alone.settings), alone);
    float most = 0;
    for (size_t p = 0; p < outcome.positions[2].size(); ++p)
      most = std::max(most, outcome.positions[2][p].y - other.positions[2][p].y);
    return most;
  }
};

TEST_F(VulkanInterCollisionTest, SheetsOfOneChart) {
  const Play scene = falling(1);
  const Outcome outcome = expect_same_as_cpu(scene);
  EXPECT_GE(held_up(scene, outcome), 0.02F) << "they did not meet";
}

TEST_F(VulkanInterCollisionTest, SheetsOfSeveralCharts) {
  expect_same_as_cpu(falling(2));
}

/// A cut parts the copies of a seam: there are more points afterwards.
TEST_F(VulkanInterCollisionTest, ASheetThatIsCutAlongItsSeam) {
  Play scene = falling(2);
  scene.before_frame = [hold = scene.before_frame](Solver& solver, uint32_t frame) {
    hold(solver, frame);
    if (frame != 10) return;
    EXPECT_GT(solver.cut(1, {Vec3{0, -1, -1}, Vec3{0, -1, 1}, Vec3{0, 2, 0}}).springs, 0U);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanInterCollisionTest, ClothThatCollidesWithItselfToo) {
  Play scene = falling(1);
  for (ClothDesc& cloth : scene.cloths) cloth.self_collision = SelfCollision{};
  expect_same_as_cpu(scene);
}

TEST_F(VulkanInterCollisionTest, TilesBetweenThePasses) {
  Play tiles = falling(1, SolverPath::tiled);  // slow on a software device
  tiles.frames = 8;
  tiles.cloths[2].transform.translate.y = -0.02F;
  EXPECT_EQ(expect_same_as_cpu(tiles).statistics.path, "tiled");
  Play tiny = falling(2, SolverPath::tiny);
  tiny.frames = 1;
  EXPECT_EQ(expect_same_as_cpu(tiny).statistics.path, "tiny, plain");
}

}  // namespace
}  // namespace geocloth::test
