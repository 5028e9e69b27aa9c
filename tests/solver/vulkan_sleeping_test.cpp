// SPDX-License-Identifier: GPL-3.0-or-later
// Sleeping on the device: it falls asleep in the same frame as on the cpu, with the same bits, and wakes.
#include "support/vulkan_play.h"

namespace geocloth {
namespace {

using test::kCut;
using test::pins_of_top;

class VulkanSleepingTest : public test::VulkanBackendTest, public testing::WithParamInterface<SolverPath> {};

TEST_P(VulkanSleepingTest, SleepsAndWakesInTheSameFrames) {
  Material material;
  material.damping = 25;
  std::vector<ClothDesc> cloths(2, test::cloth_of(kCut, material));
  cloths[1].transform.translate = {2, 0, 0};
  SolverSettings settings = test::settings_of(2);
  settings.path = GetParam();
  settings.sleep_speed = 0.02F;
  settings.sleep_time = 0.1F;
  SolverSettings on_cpu = settings;
  on_cpu.backend = Backend::cpu;
  Solver device = make_solver(cloths, settings), cpu(cloths, on_cpu);
  const auto is_awake = [](Solver& solver) { return !solver.asleep(0) || !solver.asleep(1); };
  Collider ball{"ball", Sphere{{0, 0, 0}, 0.2F}, 0.3F, {{2, 0, 2}, {}, 1}};
  const auto step_both = [&](float shift, float ball_shift = 0) {
    std::vector<Vec3> a, b;
    ball.pose.translate.z += ball_shift;
    for (Solver* solver : {&device, &cpu}) {
      solver->set_pins(0, pins_of_top(kCut, *cloths[0].asset, {shift, 0, 0}));
      solver->set_pins(1, pins_of_top(kCut, *cloths[1].asset, {2, 0, 0}));
      solver->set_colliders(std::vector{ball});
      solver->step();
    }
    for (uint32_t c = 0; c < 2; ++c) {
      ASSERT_EQ(device.asleep(c), cpu.asleep(c));
      device.read_positions(c, a);
      cpu.read_positions(c, b);
      if (exact_device(device.statistics())) {
        ASSERT_EQ(hash_state(*cloths[c].asset, a), hash_state(*cloths[c].asset, b));
      }
    }
  };
  uint32_t frames = 0;
  for (; frames < 150 && is_awake(cpu); ++frames) step_both(0, 0.001F);
  ASSERT_FALSE(is_awake(cpu)) << "150 frames";
  for (int f = 0; f < 3; ++f) step_both(0);
  for (int f = 1; f <= 4; ++f) step_both(0.01F * static_cast<float>(f));
  EXPECT_FALSE(device.asleep(0));
  EXPECT_TRUE(device.asleep(1));
  while (ball.pose.translate.z > 0.2F) step_both(0.04F, -0.3F);
  EXPECT_FALSE(device.asleep(1));
}

INSTANTIATE_TEST_SUITE_P(Paths, VulkanSleepingTest,
                         testing::Values(SolverPath::plain, SolverPath::tiled, SolverPath::tiny),
                         [](const auto& path) { return std::string(to_string(path.param)); });

}  // namespace
}  // namespace geocloth
