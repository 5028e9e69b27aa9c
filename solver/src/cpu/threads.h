// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <thread>

namespace geocloth::cpu {

/// Until a number that another thread raises is so large. Spins a little, then lets others run: that thread may be
/// waiting for this core.
/// @return the number
inline uint32_t wait_until(const std::atomic<uint32_t>& number, uint32_t value) {
  constexpr int kSpins = 200;
  for (int spin = 0;; ++spin) {
    if (const uint32_t now = number.load(std::memory_order_acquire); now >= value) return now;
    if (spin < kSpins) {
#if defined(__x86_64__) || defined(__i386__)
      __builtin_ia32_pause();
#endif
    } else {
      std::this_thread::yield();
    }
  }
}

/// How far a thread has come, for others to read. Each has cache lines of its own: processors fetch two at once.
struct alignas(128) Progress {
  std::atomic<uint32_t> done{0};
};

/// A fixed number of threads that share out ranges. What a range computes must not depend on how it is split.
class Threads {
 public:
  explicit Threads(uint32_t count);
  /// One of `parts` callers that share out ranges among themselves: each gets its own part of a range.
  Threads(uint32_t part, uint32_t parts);
  ~Threads();
  Threads(Threads&&) noexcept;
  Threads& operator=(Threads&&) noexcept;

  /// Calls body(first, last) for parts that cover 0..count; parts are at least `grain` long.
  template <class Body>
  void for_range(uint32_t count, uint32_t grain, const Body& body) const {
    run_range(count, grain, std::ref(body));  // by reference: nothing is allocated
  }
  /// Calls body() in as many threads at once as there are and `most` allows; at least once.
  template <class Body>
  void for_each_thread(uint32_t most, const Body& body) const {
    run_in_each(most, std::ref(body));
  }
  /// Runs tasks in phases: those of a phase at once, after all of the phases before. Tasks are taken in order, so
  /// whoever waits, waits for something that another thread is doing.
  /// @param first_task  of each phase, and the number of all tasks
  /// @param body        body(phase, task of the phase); must not throw
  template <class Body>
  void for_phases(std::span<const uint32_t> first_task, uint32_t most, const Body& body) const {
    std::atomic<uint32_t> next{0}, done{0};
    for_each_thread(most, [&] {
      size_t phase = 0;
      for (uint32_t t = next.fetch_add(1); t < first_task.back(); t = next.fetch_add(1)) {
        while (first_task[phase + 1] <= t) ++phase;
        wait_until(done, first_task[phase]);
        body(phase, t - first_task[phase]);
        done.fetch_add(1, std::memory_order_acq_rel);
      }
    });
  }
  [[nodiscard]] uint32_t count() const { return count_; }

 private:
  void run_range(uint32_t count, uint32_t grain, const std::function<void(uint32_t, uint32_t)>& body) const;
  void run_in_each(uint32_t most, const std::function<void()>& body) const;

  struct Arena;
  uint32_t count_ = 1, part_ = 0, parts_ = 1;
  std::unique_ptr<Arena> arena_;  ///< none for a single thread
};

}  // namespace geocloth::cpu
