// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "rest/cut_asset.h"

namespace geocloth {

/// Triangles for cut_asset() across the springs of warp and weft at which a cloth begins to tear or goes on tearing:
/// those longer than `stretch` times their length at rest, of several near each other the one that is longest for it.
/// The others are let go by that: a sheet that tore at every spring that is too long would fall to dust.
/// @return none, mostly; the most stretched ones first
[[nodiscard]] std::vector<std::array<Vec3, 3>> blades_of_tears(const ClothAsset& asset, const ClothPose& pose,
                                                               float stretch);

}  // namespace geocloth
