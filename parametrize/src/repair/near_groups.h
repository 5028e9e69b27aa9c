// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <vector>

#include "mesh/point_math.h"

namespace geocloth {

struct NearPair {
  double distance;
  uint32_t a, b;
  bool operator<(const NearPair& o) const {
    return distance != o.distance ? distance < o.distance : a != o.a ? a < o.a : b < o.b;
  }
};

/// Groups of places, joined pair by pair while every two of a group are within each other's reach. Two ends of an edge
/// never are. The root of a group is its first place.
class NearGroups {
 public:
  /// Both have to outlive it.
  NearGroups(const std::vector<Point3>& place, const std::vector<double>& reach)
      : place_(place), reach_(reach), parent_(place.size()) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  /// @returns whether two groups became one
  bool join(const NearPair& pair) {
    uint32_t a = find(pair.a), b = find(pair.b);
    if (a == b) return false;
    if (b < a) std::swap(a, b);
    if (!compact(a, b)) return false;
    parent_[b] = a;
    std::vector<uint32_t>& all = members(a);
    const std::vector<uint32_t> more = members(b);
    all.insert(all.end(), more.begin(), more.end());
    return true;
  }

  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  /// Of the group with this root.
  std::vector<uint32_t>& members(uint32_t root) {
    const auto [it, fresh] = member_.try_emplace(root);
    if (fresh) it->second.push_back(root);
    return it->second;
  }

 private:
  bool compact(uint32_t a, uint32_t b) {
    const std::vector<uint32_t> first = members(a);
    return std::all_of(first.begin(), first.end(), [&](uint32_t i) {
      const std::vector<uint32_t>& second = members(b);
      return std::all_of(second.begin(), second.end(),
                         [&](uint32_t j) { return distance(place_[i], place_[j]) <= std::min(reach_[i], reach_[j]); });
    });
  }

  const std::vector<Point3>& place_;
  const std::vector<double>& reach_;
  std::vector<uint32_t> parent_;
  std::unordered_map<uint32_t, std::vector<uint32_t>> member_;
};

}  // namespace geocloth
