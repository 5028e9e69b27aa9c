// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <gtest/gtest.h>

#include "geocloth/asset/topology.h"

namespace geocloth::test {

inline std::vector<Triangle> over_points(const std::vector<Triangle>& triangle, const std::vector<uint32_t>& point) {
  std::vector<Triangle> result;
  for (const auto& [a, b, c] : triangle) result.push_back({point[a], point[b], point[c]});
  return result;
}

inline void expect_same_topology(const Topology& a, const Topology& b) {
  EXPECT_EQ(a.components, b.components);
  EXPECT_EQ(a.boundary_loops, b.boundary_loops);
  EXPECT_EQ(a.euler_characteristic, b.euler_characteristic);
  EXPECT_EQ(a.orientable, b.orientable);
}

}  // namespace geocloth::test
