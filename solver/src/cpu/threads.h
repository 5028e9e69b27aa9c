// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

namespace geocloth::cpu {

/// A fixed number of threads that share out ranges. What a range computes must not depend on how it is split.
class Threads {
 public:
  explicit Threads(uint32_t count);
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
  [[nodiscard]] uint32_t count() const { return count_; }

 private:
  void run_range(uint32_t count, uint32_t grain, const std::function<void(uint32_t, uint32_t)>& body) const;
  void run_in_each(uint32_t most, const std::function<void()>& body) const;

  struct Arena;
  uint32_t count_;
  std::unique_ptr<Arena> arena_;  ///< none for a single thread
};

}  // namespace geocloth::cpu
