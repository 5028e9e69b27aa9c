// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Takes back short ways that pixels went along the surface, where they have made springs meet further from a right
/// angle than before and than a few degrees. Long ways were worth it: there the surface is folded.
/// @param position  per pixel, before they moved [m]
/// @param first     per pixel: the first copy of its point
/// @param shift     per first copy: how far it has moved [m]; changes
void hold_angles(const ClothAsset& asset, std::span<const Point3> position, std::span<const uint32_t> first,
                 std::vector<Point3>& shift);

}  // namespace geocloth
