// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that nobody would think of have the cpu's bits on every path of Vulkan, one solver or several after each
// other. GEOCLOTH_RANDOM_SCENES=500 in the environment plays so many of them.

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "random_scene.h"
#include "support/vulkan_play.h"

namespace geocloth {
namespace {

constexpr uint32_t kScenes = 5, kFrames = 4;

class VulkanRandomScenes : public test::VulkanBackendTest {};

TEST_F(VulkanRandomScenes, HaveTheBitsOfTheCpuOnAllPaths) {
  constexpr std::array kPaths{SolverPath::plain, SolverPath::tiled, SolverPath::tiny};
  for (uint32_t seed = 0; seed < test::random_scene_count(kScenes); ++seed) {
    test::RandomScene scene = test::make_random_scene(seed, kFrames);
    scene.settings.path = kPaths[seed % kPaths.size()];
    SCOPED_TRACE("scene " + std::to_string(seed) + ", " + to_string(scene.settings.path));
    const bool changes_solver = seed % 2 == 1;
    bool exact = true;
    const std::vector<uint64_t> vulkan = play_random_scene(
        scene, kFrames,
        [&] {
          auto solver = std::make_unique<Solver>(make_solver(scene.cloths, scene.settings));
          exact = exact_device(solver->statistics());
          return solver;
        },
        changes_solver);
    if (!exact) GTEST_SKIP() << "the device rounds in its own way";
    scene.settings.path = SolverPath::automatic;
    EXPECT_EQ(vulkan,
              play_random_scene(
                  scene, kFrames, [&] { return std::make_unique<Solver>(scene.cloths, scene.settings); }, false));
  }
}

}  // namespace
}  // namespace geocloth
