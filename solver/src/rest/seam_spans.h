// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "backend.h"
#include "rest/rest_shape.h"

namespace geocloth {

/// After add_bends: spans over seams, as entries a, b and rest of the list over seams, by colour.
void add_seam_spans(const ClothAsset& asset, const RestShape& rest, ClothData& data);

}  // namespace geocloth
