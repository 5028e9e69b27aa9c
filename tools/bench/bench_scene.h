// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "geocloth/solver/solver.h"

namespace geocloth {

/// What a benchmark simulates: cloths, what holds them, what they meet.
struct BenchScene {
  std::vector<ClothDesc> cloths;
  std::vector<std::vector<Pin>> pins;  ///< of each cloth
  std::vector<Collider> colliders;     ///< at the start
  /// Where they are at a time [s]; not set: where they were.
  std::vector<Collider> (*colliders_at)(double time) = nullptr;
  double frame_time = 1.0 / 60;  ///< [s]
  bool falls = false;            ///< frames differ from each other, as they do where colliders move
  double stretch_after = 5;      ///< [s] of the cloth's time, however long the measurement takes
};

/// A scene that can be made in any size.
struct BenchSceneKind {
  std::string_view name;
  std::string_view summary;
  std::vector<uint32_t> sizes;        ///< measured when no size is asked for [points a side]
  std::vector<uint32_t> quick_sizes;  ///< the same with --quick; none: only where the scene is asked for
  std::vector<uint32_t> substeps;     ///< measured when no number is asked for
  std::vector<uint32_t> quick_substeps;
  BenchScene (*make)(uint32_t size);
};
[[nodiscard]] const std::vector<BenchSceneKind>& bench_scene_kinds();

}  // namespace geocloth
