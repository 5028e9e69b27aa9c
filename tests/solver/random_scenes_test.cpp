// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes that nobody would think of. The plain path runs the shaders' own text pass by pass; vectors of every
// instruction set have to give its bits, with any number of threads, and also where a state is saved in every third
// frame and goes on in another solver. GEOCLOTH_RANDOM_SCENES=5000 in the environment plays so many of them.

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "random_scene.h"
#include "support/vector_targets.h"

namespace geocloth {
namespace {

constexpr uint32_t kScenes = 60, kFrames = 10;

/// Who plays it.
struct Player {
  const char* name;
  SolverPath path;
  uint32_t threads;
  int64_t vectors;  ///< instruction set, Highway's bit; 0: the best one
  bool changes_solver;
};

std::vector<uint64_t> played(const test::RandomScene& scene, const Player& player) {
  hwy::SetSupportedTargetsForTest(player.vectors);
  SolverSettings settings = scene.settings;
  settings.path = player.path;
  settings.threads = player.threads;
  const auto make_solver = [&] { return std::make_unique<Solver>(scene.cloths, settings); };
  std::vector<uint64_t> hashes = play_random_scene(scene, kFrames, make_solver, player.changes_solver);
  hwy::SetSupportedTargetsForTest(0);
  return hashes;
}

TEST(RandomScenes, HaveTheSameBitsOnAllPathsOfTheCpu) {
  std::vector<Player> players;
  for (const int64_t vectors : test::vector_targets()) {
    players.push_back({"vectors", SolverPath::automatic, 1, vectors, false});
    players.push_back({"vectors on three threads, in several solvers", SolverPath::automatic, 3, vectors, true});
  }
  for (uint32_t seed = 0; seed < test::random_scene_count(kScenes); ++seed) {
    SCOPED_TRACE("scene " + std::to_string(seed));
    const test::RandomScene scene = test::make_random_scene(seed, kFrames);
    const std::vector<uint64_t> plain = played(scene, {"plain", SolverPath::plain, 1, 0, false});
    const Player& player = players[seed % players.size()];
    EXPECT_EQ(played(scene, player), plain) << player.name << " " << hwy::TargetName(player.vectors);
  }
}

}  // namespace
}  // namespace geocloth
