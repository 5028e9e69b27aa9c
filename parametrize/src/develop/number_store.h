// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace geocloth {

/// Numbers that lie at the begin of a cache line and are whatever was there before. Freed ones are kept for whoever
/// asks next: systems are set up and thrown away by the thousand, and memory that comes anew from the operating system
/// costs more than the arithmetic in it. Threads share what is kept, which is little.
class NumberStore {
 public:
  NumberStore() = default;
  explicit NumberStore(size_t count);
  NumberStore(NumberStore&& other) noexcept;
  NumberStore& operator=(NumberStore&& other) noexcept;
  NumberStore(const NumberStore&) = delete;
  NumberStore& operator=(const NumberStore&) = delete;
  ~NumberStore();

  [[nodiscard]] double* data() const { return first_; }
  [[nodiscard]] bool empty() const { return first_ == nullptr; }

 private:
  double* first_ = nullptr;
  size_t size_ = 0;
};

}  // namespace geocloth
