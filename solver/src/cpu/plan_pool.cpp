// SPDX-License-Identifier: Apache-2.0
// Plans are compared whole once they are made: what they were made from is not kept.

#include "cpu/plan_pool.h"

#include <algorithm>
#include <utility>

namespace geocloth::cpu {

std::shared_ptr<const SweepPlan> PlanPool::share(std::unique_ptr<SweepPlan> plan) {
  if (!plan) return nullptr;
  const std::lock_guard lock(mutex_);
  std::erase_if(plans_, [](const auto& known) { return known.expired(); });
  for (const std::weak_ptr<const SweepPlan>& known : plans_) {
    std::shared_ptr<const SweepPlan> other = known.lock();
    if (other && other->can_stand_for(*plan)) return other;
  }
  std::shared_ptr<const SweepPlan> own = std::move(plan);
  plans_.push_back(own);
  return own;
}

size_t PlanPool::memory_bytes() const {
  size_t sum = 0;
  for (const std::weak_ptr<const SweepPlan>& known : plans_)
    if (const auto plan = known.lock()) sum += plan->memory_bytes();
  return sum;
}

}  // namespace geocloth::cpu
