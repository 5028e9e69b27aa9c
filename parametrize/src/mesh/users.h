// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace geocloth {

/// For every point the elements of a list that use it.
class Users {
 public:
  template <class Element>
  Users(std::size_t points, const std::vector<Element>& elements) : first_(points + 1, 0) {
    for (const Element& e : elements) {
      for (const uint32_t p : e) ++first_[p + 1];
    }
    for (std::size_t i = 0; i < points; ++i) first_[i + 1] += first_[i];
    user_.resize(first_.back());
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    for (uint32_t k = 0; k < elements.size(); ++k) {
      for (const uint32_t p : elements[k]) user_[next[p]++] = k;
    }
  }
  [[nodiscard]] std::span<const uint32_t> operator[](uint32_t point) const {
    return {user_.data() + first_[point], user_.data() + first_[point + 1]};
  }

 private:
  std::vector<uint32_t> first_, user_;  // rows and entries
};

}  // namespace geocloth
