// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "cpu/sweep_plan.h"

namespace geocloth::cpu {

/// What threads do at once between two waits.
struct BandPhase {
  enum class Kind : uint8_t {
    bands,   ///< a sweep's bands of rows
    gaps,    ///< what they have left out between them
    shares,  ///< a pass that does not go by rows, in as many shares as there are bands
    alone    ///< such passes by one thread, because they are short or measure something
  };
  Kind kind;
  uint32_t first_part, last_part;  ///< of the plan: first <= part < last
  uint32_t tasks;
};

/// How threads share out a substep that is made of several sweeps.
struct BandPlan {
  std::vector<uint32_t> rows;     ///< where bands begin, and the image's height
  std::vector<BandPhase> phases;  ///< of a substep

  [[nodiscard]] uint32_t count() const { return static_cast<uint32_t>(rows.size() - 1); }
};

/// One band for each thread if there is room for so many, with as many pixels each as rows allow.
[[nodiscard]] BandPlan plan_bands(const SweepPlan& plan, const ClothState& state, const std::vector<Run>& runs,
                                  uint32_t threads);

/// A task's rows in a phase of bands or gaps.
[[nodiscard]] SweepBand band_of_task(const BandPlan& plan, const Sweep& sweep, BandPhase::Kind kind, uint32_t task);

}  // namespace geocloth::cpu
