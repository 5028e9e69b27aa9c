// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "geocloth/asset/vec3d.h"

namespace geocloth {

/// Nodes of a regular grid, x fastest, then y.
struct NodeGrid {
  std::array<uint32_t, 3> size{};
  Vec3d low;           ///< [m] of the first node
  double spacing = 0;  ///< [m]

  [[nodiscard]] size_t count() const { return size_t{size[0]} * size[1] * size[2]; }
  [[nodiscard]] size_t at(uint32_t x, uint32_t y, uint32_t z) const { return (size_t{z} * size[1] + y) * size[0] + x; }
  [[nodiscard]] Vec3d place(uint32_t x, uint32_t y, uint32_t z) const {
    return {low.x + spacing * x, low.y + spacing * y, low.z + spacing * z};
  }
};

/// Layers of nodes that are worth a look at all the triangles of a surface.
inline constexpr uint32_t kLayersAtOnce = 4;

}  // namespace geocloth
