// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Components that are sewn together: they share points.
class SewnGroups {
 public:
  /// @param left_out  per component: whether it is not there; empty: all are
  explicit SewnGroups(const CleanSurface& clean, std::span<const uint8_t> left_out = {})
      : parent_(clean.component_count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
    std::vector<uint32_t> first(clean.point_count, kNone);  // component of a point
    for (size_t t = 0; t < clean.triangle.size(); ++t) {
      const uint32_t c = clean.component[t];
      if (!left_out.empty() && left_out[c] != 0) continue;
      for (const uint32_t v : clean.triangle[t]) {
        uint32_t& other = first[clean.point[v]];
        if (other == kNone) other = c;
        if (other != c) join(group(other), group(c));
      }
    }
  }
  /// The lowest of its group.
  [[nodiscard]] uint32_t group(uint32_t c) const {
    while (parent_[c] != c) c = parent_[c];
    return c;
  }

 private:
  void join(uint32_t a, uint32_t b) { parent_[std::max(a, b)] = std::min(a, b); }

  std::vector<uint32_t> parent_;
};

}  // namespace geocloth
