// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/asset/cloth_asset.h"

namespace geocloth::test {

/// A small sheet in four charts whose source mesh has everything that a garment can have: two parts, materials with
/// pictures, texture coordinates and vertex groups.
[[nodiscard]] ClothAsset sample_asset();

}  // namespace geocloth::test
