// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "geocloth/solver/solid.h"

namespace geocloth::test {

/// A ball of triangles, whose poles are on the y axis.
/// @param around, along  triangles around it and from pole to pole
inline TriangleSurface ball_surface(const Vec3& center, float radius, uint32_t around = 48, uint32_t along = 24) {
  TriangleSurface surface;
  for (uint32_t j = 0; j <= along; ++j) {
    for (uint32_t i = 0; i < around; ++i) {
      const float u = std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(along);
      const float v = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(around);
      surface.position.push_back(center +
                                 radius * Vec3{std::sin(u) * std::cos(v), std::cos(u), -std::sin(u) * std::sin(v)});
    }
  }
  for (uint32_t j = 0; j < along; ++j) {
    for (uint32_t i = 0; i < around; ++i) {
      const uint32_t a = j * around + i, b = j * around + (i + 1) % around;
      surface.triangle.push_back({a, a + around, b + around});
      surface.triangle.push_back({a, b + around, b});
    }
  }
  return surface;
}

}  // namespace geocloth::test
