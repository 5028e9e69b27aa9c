// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "backend.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// Appends the ties between whole points, by colour after all others, and says how many colours they take.
void add_whole_ties(const ClothAsset& asset, const RestShape& rest, ClothData& data);

}  // namespace geocloth
