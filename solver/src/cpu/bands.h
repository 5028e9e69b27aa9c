// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "cpu/sweep_plan.h"

namespace geocloth::cpu {

/// What the thread of each band does after its task before.
struct BandTask {
  enum class Kind : uint8_t {
    head,   ///< of a sweep: what the band above waits for
    body,   ///< of a sweep: what no other band waits for, nor needs other bands
    tail,   ///< of a sweep: at the lower side, after the head of the band below
    rest,   ///< of a sweep: at the upper side, after the tail of the band above
    share,  ///< its share of a pass that does not go by rows
    alone   ///< such passes, by the first band only: they are short or measure something
  };
  Kind kind;
  bool after_all = false;                  ///< it needs all bands' tasks before
  uint32_t first_part = 0, last_part = 0;  ///< of the plan: first <= part < last
};

/// How threads share out a plan.
struct BandPlan {
  static constexpr uint32_t kSweepTasks = 4;  ///< kinds of tasks that are part of a sweep

  std::vector<uint32_t> rows;     ///< where bands begin, and the image's height
  std::vector<BandTask> tasks;    ///< of each band
  std::vector<SweepBand> sweeps;  ///< for each part of the plan and each band one for each kind of task

  [[nodiscard]] uint32_t count() const { return static_cast<uint32_t>(rows.size() - 1); }
  /// A band's rows in a task that is part of a sweep.
  [[nodiscard]] const SweepBand& rows_of(uint32_t part, uint32_t band, BandTask::Kind kind) const {
    return sweeps[(part * count() + band) * kSweepTasks + static_cast<uint32_t>(kind)];
  }
};

/// One band for each thread if there is room for so many, with as much work each as rows allow.
[[nodiscard]] BandPlan plan_bands(const SweepPlan& plan, const ClothState& state, uint32_t threads);

/// How many tasks of another band have to be done before a band may do one.
/// @param number  of its task, counted on from one repetition of the plan to the next, as the other's are
[[nodiscard]] inline uint32_t tasks_needed(const BandPlan& plan, uint32_t band, uint32_t number, uint32_t other) {
  const BandTask& task = plan.tasks[number % plan.tasks.size()];
  if (task.after_all) return number;
  if (task.kind == BandTask::Kind::tail && other == band + 1) return number - 1;  // the head
  if (task.kind == BandTask::Kind::rest && other + 1 == band) return number;
  return 0;
}

}  // namespace geocloth::cpu
