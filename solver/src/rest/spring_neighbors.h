// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "geocloth/asset/cloth_asset.h"
#include "rest/bend_directions.h"

namespace geocloth {

/// Pixels from one to the next in one of the directions of bend_directions.h.
[[nodiscard]] inline uint32_t step_in(const ClothAsset& asset, uint32_t direction) {
  return static_cast<uint32_t>(kSpringOffset[direction][0] +
                               static_cast<int32_t>(asset.width) * kSpringOffset[direction][1]);
}

/// Whether springs lead on from a pixel to both sides of a direction.
[[nodiscard]] inline bool runs_through(const ClothAsset& asset, uint32_t p, uint32_t direction) {
  const auto bit = static_cast<uint8_t>(1U << direction);
  const uint32_t step = step_in(asset, direction);
  return p >= step && (asset.spring_mask[p] & asset.spring_mask[p - step] & bit) != 0;
}

/// Calls visit(pixel) for those that a structural or a shear spring joins to p.
template <class Visit>
void for_spring_neighbors(const ClothAsset& asset, uint32_t p, const Visit& visit) {
  for (uint32_t direction = 0; direction < kBendDirections; ++direction) {
    const auto bit = static_cast<uint8_t>(1U << direction);
    const uint32_t step = step_in(asset, direction);
    if ((asset.spring_mask[p] & bit) != 0) visit(p + step);
    if (p >= step && (asset.spring_mask[p - step] & bit) != 0) visit(p - step);
  }
}

}  // namespace geocloth
