// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "cpu/sweep_plan.h"

namespace geocloth::cpu {

/// The plans that cloths work by. Of a crowd in the same garment all have the same one: its constants, more than half
/// of what a frame reads, stay in the caches from one cloth to the next.
class PlanPool {
 public:
  /// @return a plan like this one that another cloth has, if there is one; else this. Threads may call it side by side.
  [[nodiscard]] std::shared_ptr<const SweepPlan> share(std::unique_ptr<SweepPlan> plan);

  /// Of all plans that a cloth has, each counted once.
  [[nodiscard]] size_t memory_bytes() const;

 private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<const SweepPlan>> plans_;
};

}  // namespace geocloth::cpu
