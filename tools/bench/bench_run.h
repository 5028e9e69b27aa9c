// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/bench_scene.h"
#include "geocloth/solver/solver.h"

namespace geocloth {

/// How long a case may take.
struct BenchBudget {
  uint32_t frames = 300;  ///< at most, those before the measurement included
  double seconds = 2;     ///< then it stops, with at least one measured frame
};

/// One measured case. A constraint solve is one projection of one spring or bending constraint; collision, attachments
/// and stitching count in the time and not in the number.
struct BenchResult {
  std::string scene, backend, device, path;
  uint32_t threads = 1;
  uint32_t cloths = 1, width = 0, height = 0;  ///< of one cloth
  uint64_t particles = 0, springs = 0;         ///< of all cloths
  uint32_t substeps = 1;
  uint32_t frames = 0;      ///< simulated for the measurement
  double ms_per_frame = 0;  ///< median
  double ms_per_frame_min = 0;
  double springs_per_second = 0;
  double roofline_share = 0;  ///< shortest time that the machine allows / ms_per_frame; 0 on a real GPU: not known
  uint64_t memory_bytes = 0;  ///< state and constants of all cloths
  StretchStatistics stretch;  ///< after BenchScene::stretch_after
  std::vector<std::pair<std::string, double>> passes_ms;  ///< pass by pass in a run of its own, which is slower
};

/// Runs a scene and measures it.
/// @param settings  substeps and threads are the case's
/// @param stretch   what the same backend has reached with the same substeps; nothing: it is simulated
[[nodiscard]] BenchResult run_bench(const std::string& name, const BenchScene& scene, const SolverSettings& settings,
                                    const BenchBudget& budget, const std::optional<StretchStatistics>& stretch);

}  // namespace geocloth
