// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "backend.h"
#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// Which pixels are copies of points of short seams: of a few points that have no other seam beside them.
[[nodiscard]] std::vector<bool> pixels_of_short_seams(const ClothAsset& asset);

/// Spans through the points of short seams, from each side to each other one in all directions.
/// @param asset  perhaps cut
/// @param short_seams  pixels_of_short_seams() before any cut
[[nodiscard]] std::vector<shader::SeamSpring> spans_through_short_seams(const ClothAsset& asset, float scale,
                                                                        const std::vector<bool>& short_seams);

/// How many of them any cut may leave.
[[nodiscard]] size_t most_spans_through_short_seams(const ClothAsset& asset, const std::vector<bool>& short_seams);

/// Which points, by their first copies, lie a few springs from a short seam.
[[nodiscard]] std::vector<bool> points_near_short_seams(const ClothAsset& asset, const std::vector<bool>& short_seams);

}  // namespace geocloth
