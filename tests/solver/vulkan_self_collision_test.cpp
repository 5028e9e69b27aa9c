// SPDX-License-Identifier: GPL-3.0-or-later
// Self-collision on Vulkan: the same bits as on the cpu where roots and divisions are exact, on every path.

#include <string>

#include <gtest/gtest.h>

#include "support/self_contact.h"
#include "support/vulkan_play.h"

namespace geocloth::test {
namespace {

/// A narrow sheet that stands on its edge and folds up on the floor.
Play folding(uint32_t charts, SolverPath path = SolverPath::automatic) {
  const SheetOptions options{.nx = 15,
                             .ny = 25,
                             .width = 0.14F,
                             .height = 0.24F,
                             .charts_x = charts,
                             .charts_y = charts,
                             .center = {0, 0.13F, 0}};
  Play scene{.cloths = {cloth_of(options)}, .settings = settings_of(8), .frames = 24};
  scene.cloths[0].transform.rotate = quat_from_euler_deg({4, 0, 3});
  scene.cloths[0].self_collision = SelfCollision{};
  scene.settings.path = path;
  scene.before_frame = [](Solver& solver, uint32_t frame) {
    Collider floor;
    floor.shape = Plane{{0, 0, 0}, {0, 1, 0}};
    if (frame == 0) solver.set_colliders(std::vector<Collider>{floor}, true);
  };
  return scene;
}

class VulkanSelfCollisionTest : public VulkanBackendTest {};

TEST_F(VulkanSelfCollisionTest, AFoldOfOneChart) {
  const Play scene = folding(1);
  const Outcome outcome = expect_same_as_cpu(scene);
  EXPECT_EQ(count_intersections(*scene.cloths[0].asset, outcome.positions[0]), 0U);
}

TEST_F(VulkanSelfCollisionTest, AFoldOfSeveralCharts) {
  expect_same_as_cpu(folding(2));
}

/// A cut parts the copies of a seam: there are more points afterwards.
TEST_F(VulkanSelfCollisionTest, AFoldThatIsCutAlongItsSeam) {
  Play scene = folding(2);
  scene.frames = 16;
  scene.before_frame = [fall = scene.before_frame](Solver& solver, uint32_t frame) {
    fall(solver, frame);
    if (frame == 2) {
      const CutResult cut = solver.cut(0, {Vec3{-1, 0.13F, -1}, Vec3{1, 0.13F, -1}, Vec3{0, 0.13F, 2}});
      EXPECT_GT(cut.springs, 0U);
    }
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanSelfCollisionTest, TilesBetweenThePasses) {
  Play tiles = folding(1, SolverPath::tiled);  // slow on a software device
  tiles.frames = 13;                           // it touches itself after ten
  EXPECT_EQ(expect_same_as_cpu(tiles).statistics.path, "tiled");
  Play tiny = folding(2, SolverPath::tiny);
  tiny.frames = 1;
  EXPECT_EQ(expect_same_as_cpu(tiny).statistics.path, "plain");
}

}  // namespace
}  // namespace geocloth::test
