// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "backend.h"

namespace geocloth {

/// A cloth that collides with others.
struct InterCloth {
  uint32_t cloth = 0;   ///< see InterPart
  uint32_t number = 0;  ///< what its user calls it
  double arrived = 0;   ///< [s] those that came together keep as near as they started
  const ClothAsset* asset = nullptr;
  Transform start = {};                      ///< where its rest shape started
  std::span<const float> inverse_mass = {};  ///< [1/kg] one per pixel, without pins
  float distance = -1;                       ///< [m] see InterCollision
  float friction = 0;
};

/// What these cloths need to collide with each other.
/// @throws Error(invalid_argument) where their grids are too unlike, Error(limit) for too many points
[[nodiscard]] InterData make_inter_data(std::span<const InterCloth> cloths, const Vec3& origin);

}  // namespace geocloth
