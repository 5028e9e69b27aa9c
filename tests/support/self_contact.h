// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth::test {

/// Pairs of triangles of the welded grid mesh that cut through each other and share no vertex.
[[nodiscard]] uint64_t count_intersections(const ClothAsset& asset, const std::vector<Vec3>& position);

/// [m] of the two points nearest to each other that lie at least `along` apart at rest (of copies one counts).
[[nodiscard]] double smallest_distance(const ClothAsset& asset, const std::vector<Vec3>& position, double along);

/// Two assets of the same width in one, the second below the first: two connected parts of one garment.
[[nodiscard]] ClothAsset beside(const ClothAsset& first, const ClothAsset& second);

}  // namespace geocloth::test
