// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "solver/solver_fixture.h"

namespace geocloth::test {

inline double component(const Vec3& a, size_t k) {
  return static_cast<double>(k == 0 ? a.x : k == 1 ? a.y : a.z);
}

/// Linear and angular momentum about the centre of mass, with what they are measured by: the sums without signs.
struct Momentum {
  std::array<double, 3> linear{}, angular{};
  double linear_scale = 0, angular_scale = 0;
};
inline Momentum momentum_of(Solver& solver, const ClothDesc& cloth) {
  const std::vector<Vec3> x = positions_of(solver), v = velocities_of(solver);
  const std::vector<double> mass = masses_of(cloth);
  std::array<double, 3> center{}, mean{};
  double total = 0;
  for (size_t p = 0; p < x.size(); ++p) {
    total += mass[p];
    for (size_t k = 0; k < 3; ++k) {
      center[k] += mass[p] * component(x[p], k);
      mean[k] += mass[p] * component(v[p], k);
    }
  }
  Momentum sum;
  sum.linear = mean;
  for (size_t p = 0; p < x.size(); ++p) {
    std::array<double, 3> r{}, u{};
    for (size_t k = 0; k < 3; ++k) {
      r[k] = component(x[p], k) - center[k] / total;
      u[k] = component(v[p], k) - mean[k] / total;
    }
    for (size_t k = 0; k < 3; ++k)
      sum.angular[k] += mass[p] * (r[(k + 1) % 3] * u[(k + 2) % 3] - r[(k + 2) % 3] * u[(k + 1) % 3]);
    sum.linear_scale += mass[p] * static_cast<double>(length(v[p]));
    sum.angular_scale += mass[p] * std::hypot(r[0], r[1], r[2]) * std::hypot(u[0], u[1], u[2]);
  }
  return sum;
}

/// To 1e-4 of what they are measured by.
inline void expect_same_momentum(const Momentum& after, const Momentum& before, const std::string& where) {
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(after.linear[k], before.linear[k], 1e-4 * before.linear_scale) << where << ' ' << k;
    EXPECT_NEAR(after.angular[k], before.angular[k], 1e-4 * before.angular_scale) << where << ' ' << k;
  }
}

/// A lively start: the cloth spins once in two seconds, is stretched and sheared at 3 m/s and bends.
inline void spin_stretch_and_bend(Solver& solver, const ClothDesc& cloth) {
  const std::vector<Vec3> x = positions_of(solver);
  std::vector<Vec3> v(x.size());
  for (uint32_t p = 0; p < x.size(); ++p) {
    if (!cloth.asset->valid(p)) continue;
    v[p] = 3.F * Vec3{0.3F - x[p].y + 1.5F * x[p].x, x[p].x + x[p].y, 1.5F * x[p].x * x[p].y + 0.5F * x[p].x};
  }
  solver.write_state(0, x, v);
}

}  // namespace geocloth::test
