// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// Sets ClothAsset::area: a third of every triangle goes to each of its pixels.
void share_area(ClothAsset& asset);

}  // namespace geocloth
