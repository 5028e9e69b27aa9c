// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "backend.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// Appends the ties between copies that no spring joins, by colour after the spans over seams, and says how many
/// colours they take.
void add_seam_ties(const ClothAsset& asset, const RestShape& rest, ClothData& data);

}  // namespace geocloth
