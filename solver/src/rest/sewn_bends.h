// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "backend.h"
#include "rest/fabrics.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// Appends the bends over seams that are sewn (ClothAsset::sewing), by colour after the threads, and says how many
/// colours they take. They hold once the seams are closed. None without a rigidity.
void add_sewn_bends(const ClothDesc& cloth, const FabricMap& fabrics, const RestShape& rest, ClothData& data);

}  // namespace geocloth
