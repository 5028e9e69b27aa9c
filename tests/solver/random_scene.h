// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "geocloth/solver/solver.h"

namespace geocloth::test {

/// Something that a caller does before a frame.
struct Deed {
  uint32_t frame, kind, cloth, seed;
};

/// Garments, materials, colliders and all that a caller can do between two frames, by chance.
struct RandomScene {
  std::vector<ClothDesc> cloths;
  SolverSettings settings;
  std::vector<Collider> colliders;
  std::vector<Vec3> ways, turns;  ///< [m], [degrees] of the colliders in a frame
  std::vector<Deed> deeds;        ///< ascending frames
};
/// @param frames  that it is played for
[[nodiscard]] RandomScene make_random_scene(uint32_t seed, uint32_t frames);

using SolverMaker = std::function<std::unique_ptr<Solver>()>;
/// Hashes of positions and velocities of all cloths, frame by frame; every position has to be finite.
/// @param changes_solver  in every third frame the state is saved and goes on in another solver
[[nodiscard]] std::vector<uint64_t> play_random_scene(const RandomScene& scene, uint32_t frames,
                                                      const SolverMaker& make_solver, bool changes_solver);

/// As many as the environment's GEOCLOTH_RANDOM_SCENES says.
[[nodiscard]] uint32_t random_scene_count(uint32_t unless_told);

}  // namespace geocloth::test
