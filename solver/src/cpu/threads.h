// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <thread>

namespace geocloth::cpu {

/// For threads that look at something again and again.
inline void pause_thread() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}

/// Tasks that are done one after another, by one thread at a time.
class TaskChain {
 public:
  /// Tasks that are done; all that they have written can be read.
  [[nodiscard]] uint32_t done() const { return done_.load(std::memory_order_acquire); }
  void start_again() { done_.store(0, std::memory_order_relaxed); }

  /// Nobody else does its tasks until let_go().
  [[nodiscard]] bool take() {
    return !taken_.load(std::memory_order_relaxed) && !taken_.exchange(true, std::memory_order_acquire);
  }
  void let_go() { taken_.store(false, std::memory_order_release); }

  /// Does tasks as long as they are ready; to be called by whoever has taken it.
  /// @param ready, body  of the task with this number
  /// @param patience     how often a task may be found not ready
  /// @return whether there was any
  template <class Ready, class Body>
  bool go_on(uint32_t tasks, uint32_t patience, const Ready& ready, const Body& body) {
    const uint32_t first = done_.load(std::memory_order_relaxed);
    uint32_t task = first;
    for (uint32_t waited = 0; task < tasks && waited < patience;) {
      if (ready(task)) {
        body(task);
        done_.store(++task, std::memory_order_release);
        waited = 0;
      } else {
        ++waited;
        pause_thread();
      }
    }
    return task > first;
  }

 private:
  // Cache lines of their own: processors fetch two at once.
  alignas(128) std::atomic<uint32_t> done_{0};
  alignas(128) std::atomic<bool> taken_{false};
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
  /// Runs chains of as many tasks each at once. A thread keeps to a chain, so that what it works on stays in its cache,
  /// in the next call, too; but after waiting a little it does what is ready in others: their threads may be elsewhere.
  /// @param ready  ready(chain, task): what it needs of other chains is done
  /// @param body   body(chain, task); must not throw
  template <class Ready, class Body>
  void for_chains(std::span<TaskChain> chains, uint32_t tasks, const Ready& ready, const Body& body) const {
    for (TaskChain& chain : chains) chain.start_again();
    const auto count = static_cast<uint32_t>(chains.size());
    for_each_thread(count, [&] {
      const auto go_on = [&](uint32_t c, uint32_t patience) {
        if (chains[c].done() == tasks || !chains[c].take()) return false;
        const bool any = chains[c].go_on(
            tasks, patience, [&](uint32_t task) { return ready(c, task); }, [&](uint32_t task) { body(c, task); });
        chains[c].let_go();
        return any;
      };
      const uint32_t own = own_place() % count;
      while (!all_done(chains, tasks)) {
        bool any = go_on(own, kPatience);
        for (uint32_t k = 1; k < count && !any; ++k) any = go_on((own + k) % count, 1);
        if (!any) std::this_thread::yield();  // a thread that this one waits for may be waiting for this core
      }
    });
  }
  [[nodiscard]] uint32_t count() const { return count_; }

 private:
  static constexpr uint32_t kPatience = 200;  ///< a few microseconds
  static bool all_done(std::span<const TaskChain> chains, uint32_t tasks) {
    return std::all_of(chains.begin(), chains.end(), [&](const TaskChain& chain) { return chain.done() >= tasks; });
  }
  /// Of this thread among those of for_each_thread().
  static uint32_t own_place();
  void run_range(uint32_t count, uint32_t grain, const std::function<void(uint32_t, uint32_t)>& body) const;
  void run_in_each(uint32_t most, const std::function<void()>& body) const;

  struct Arena;
  uint32_t count_ = 1, part_ = 0, parts_ = 1;
  std::unique_ptr<Arena> arena_;  ///< none for a single thread
};

}  // namespace geocloth::cpu
