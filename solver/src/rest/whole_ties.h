// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "backend.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// Appends the ties between whole points, by colour after all others, and says how many colours they take.
/// @param short_seams  pixels_of_short_seams() before any cut
void add_whole_ties(const ClothAsset& asset, const RestShape& rest, const std::vector<bool>& short_seams,
                    ClothData& data);

}  // namespace geocloth
