// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "backend.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// After add_bends: spans over seams, as entries a, b and rest of the list over seams, by colour.
/// @param short_seams  pixels_of_short_seams() before any cut
void add_seam_spans(const ClothAsset& asset, const RestShape& rest, float scale, const std::vector<bool>& short_seams,
                    ClothData& data);

}  // namespace geocloth
