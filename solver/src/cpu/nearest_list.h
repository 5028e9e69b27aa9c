// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "cpu/self_set.h"

namespace geocloth::cpu {

/// The neighbours of a point that self_keep() of lib/self_collide.h keeps: the nearest ones.
class NearestList {
 public:
  /// Adds a point if it may touch `own`, and if it is nearer than the farthest of a full list.
  /// @param distance2  [m^2] between where both were seen, squared
  void add_if_near(const shader::SelfSet& set, const shader::SelfRoom& room, const shader::SelfPoint& own,
                   uint32_t other, float distance2) {
    const shader::SelfPoint& neighbor = self_point(set, other);
    const float reach = self_pair_reach(set, room, own, neighbor);
    if (!(distance2 < reach * reach)) return;
    const uint32_t marked = self_is_thin(set, room, own, neighbor) ? other | shader::kSelfThinBit : other;
    if (count_ < kMost) {
      entries_[count_++] = {marked, distance2};
      return;
    }
    if (!farthest_known_) find_farthest();
    if (!is_nearer({marked, distance2}, entries_[farthest_])) return;
    entries_[farthest_] = {marked, distance2};
    farthest_known_ = false;
  }

  /// In the order of their numbers.
  void write(const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t point) {
    std::sort(entries_.begin(), entries_.begin() + count_,
              [](const Entry& a, const Entry& b) { return a.number() < b.number(); });
    set_self_word(set, shader::self_count_word(room, point), count_);
    for (uint32_t k = 0; k < count_; ++k)
      set_self_word(set, shader::self_neighbor_word(room, point, k), entries_[k].marked);
  }

 private:
  static constexpr uint32_t kMost = shader::kSelfMostNeighbors;
  struct Entry {
    uint32_t marked;
    float distance2;
    [[nodiscard]] uint32_t number() const { return marked & ~shader::kSelfThinBit; }
  };
  static bool is_nearer(const Entry& a, const Entry& b) {
    return shader::self_is_nearer(a.distance2, a.number(), b.distance2, b.number());
  }
  void find_farthest() {
    farthest_ = 0;
    for (uint32_t k = 1; k < count_; ++k)
      if (is_nearer(entries_[farthest_], entries_[k])) farthest_ = k;
    farthest_known_ = true;
  }

  std::array<Entry, kMost> entries_;
  uint32_t count_ = 0, farthest_ = 0;
  bool farthest_known_ = false;
};

}  // namespace geocloth::cpu
