// SPDX-License-Identifier: Apache-2.0
// oneTBB behind one function. Springs of a group, pixels and split rows are independent of each other, so any split of
// a range gives the same bits.

#include "cpu/threads.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

namespace geocloth::cpu {

struct Threads::Arena {
  /// More threads than the machine has would only wait for each other.
  explicit Arena(uint32_t count) : arena(std::min(static_cast<int>(count), tbb::info::default_concurrency())) {}
  tbb::task_arena arena;
};

Threads::Threads(uint32_t count) : count_(std::max(1U, count)) {
  if (count_ > 1) arena_ = std::make_unique<Arena>(count_);
}
Threads::Threads(uint32_t part, uint32_t parts) : part_(part), parts_(parts) {}
Threads::~Threads() = default;
Threads::Threads(Threads&&) noexcept = default;
Threads& Threads::operator=(Threads&&) noexcept = default;

void Threads::run_range(uint32_t count, uint32_t grain, const std::function<void(uint32_t, uint32_t)>& body) const {
  if (parts_ > 1) {
    const uint32_t parts = count <= grain ? 1 : parts_;
    const auto bound = [&](uint32_t k) { return static_cast<uint32_t>(uint64_t{count} * k / parts); };
    if (part_ < parts && count > 0) body(bound(part_), bound(part_ + 1));
    return;
  }
  if (!arena_ || count <= grain) {
    if (count > 0) body(0, count);
    return;
  }
  const uint32_t part = std::max(grain, (count + count_ - 1) / count_);
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<uint32_t>(0, count, part),
        [&](const tbb::blocked_range<uint32_t>& range) { body(range.begin(), range.end()); },
        tbb::simple_partitioner());
  });
}

uint32_t Threads::own_place() {
  return static_cast<uint32_t>(std::max(0, tbb::this_task_arena::current_thread_index()));
}

void Threads::run_in_each(uint32_t most, const std::function<void()>& body) const {
  const int workers = arena_ ? std::min(arena_->arena.max_concurrency(), static_cast<int>(most)) : 1;
  if (workers <= 1) return body();
  arena_->arena.execute([&] {
    tbb::parallel_for(
        0, workers, [&](int) { body(); }, tbb::simple_partitioner());
  });
}

}  // namespace geocloth::cpu
