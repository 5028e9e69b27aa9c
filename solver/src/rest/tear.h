// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rest/cut_asset.h"

namespace geocloth {

/// A structural spring, by the pixels that it joins.
struct StrainedSpring {
  uint32_t a, b;
  double stretch;  ///< length / length at rest
};

/// The springs of warp and weft at which a cloth begins to tear or goes on tearing: those longer than `stretch` times
/// their length at rest, of several near each other the one that is longest for it. The others are let go by that: a
/// sheet that tore at every spring that is too long would fall to dust.
/// @param scale  of the cloth
/// @return none, mostly; the most stretched ones first
[[nodiscard]] std::vector<StrainedSpring> springs_that_tear(const ClothAsset& asset, std::span<const Vec3> position,
                                                            float scale, float stretch);

/// A triangle for cut_asset() that severs a spring and what runs beside it.
[[nodiscard]] std::array<Vec3, 3> blade_across(const ClothAsset& asset, const ClothPose& pose,
                                               const StrainedSpring& spring);

}  // namespace geocloth
