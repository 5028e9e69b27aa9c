// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts on the device: springs, cells and tables are replaced while frames go on, on every path, with the cpu's bits.
#include "support/vulkan_play.h"

namespace geocloth {
namespace {

using test::hanging;
using test::kCut;
using test::kUncut;
using test::Outcome;
using test::pins_of_top;
using test::Play;
using test::SheetOptions;
using Triangle3 = std::array<Vec3, 3>;

class VulkanCuttingTest : public test::VulkanBackendTest, public testing::WithParamInterface<SolverPath> {
 protected:
  /// Cuts while it swings: across, along a seam if there is one, and several in one frame.
  static Play cut_in_flight(const SheetOptions& options, const Material& material = {}) {
    Play scene = hanging(options, material);
    scene.frames = 8;
    scene.settings.path = GetParam();
    scene.settings.check_copies = true;
    scene.before_frame = [options, asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
      if (frame == 0) solver.set_pins(0, pins_of_top(options, *asset));
      Collider ball;
      ball.shape = Sphere{{0, -0.3F, -0.12F}, 0.1F};
      solver.set_colliders(std::vector{ball});
      if (frame == 2) {
        EXPECT_GT(solver.cut(0, level(0.03F)).springs, 0U);
      }
      if (frame == 5) {
        EXPECT_GT(solver.cut(0, {Vec3{0.05F, -6, -8}, Vec3{0.05F, -6, 8}, Vec3{0.05F, 0.3F, 0}}).springs, 0U);
        EXPECT_GT(solver.cut(0, level(-0.27F)).springs, 0U);
      }
    };
    return scene;
  }
  static Triangle3 level(float y) { return {Vec3{-3, y, -2}, Vec3{3, y, -2}, Vec3{0, y, 4}}; }
};

TEST_P(VulkanCuttingTest, OneChart) {
  expect_same_as_cpu(cut_in_flight(kUncut));
}

TEST_P(VulkanCuttingTest, SeveralCharts) {
  expect_same_as_cpu(cut_in_flight(kCut));
}

TEST_P(VulkanCuttingTest, AlongASeamOfFourChartsWithAttachments) {
  Material material;
  material.max_stretch = 0.02F;
  const SheetOptions options{.nx = 13, .ny = 13, .charts_x = 2, .charts_y = 2};
  Play scene = cut_in_flight(options, material);
  scene.before_frame = [options, asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) {
      solver.set_pins(0, pins_of_top(options, *asset));
      EXPECT_EQ(solver.cut(0, level(0)).parted_points, 13U);
    }
    if (frame == 4) {
      EXPECT_GT(solver.cut(0, level(0.2F)).springs, 0U);
    }
  };
  const Outcome outcome = expect_same_as_cpu(scene);
  EXPECT_LT(outcome.positions[0][test::sheet_pixel(options, 6, 12)].y, -0.55F);  // falls
}

TEST_P(VulkanCuttingTest, SpringsOverTwoPixelsAndSeveralRelaxationSteps) {
  Material material;
  material.stiffness = 0.8F;
  material.bend_stiffness = 0.2F;
  Play scene = cut_in_flight(kCut, material);
  scene.settings.relaxation_steps = 2;
  expect_same_as_cpu(scene);
}

INSTANTIATE_TEST_SUITE_P(Paths, VulkanCuttingTest,
                         testing::Values(SolverPath::plain, SolverPath::tiled, SolverPath::tiny),
                         [](const auto& path) { return std::string(to_string(path.param)); });

}  // namespace
}  // namespace geocloth
