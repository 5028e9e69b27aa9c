// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "fit/far_points.h"
#include "geocloth/parametrize/rasterize.h"

namespace geocloth {

/// Brings an image nearer to the surface at the few places where it is so far from it that the largest deviation would
/// show: moves the few pixels around them. Even springs and right angles are not asked for there, only springs between
/// limits and no folded triangles; nothing moves where that does not help. Free borders stay, copies stay
/// bit-identical.
/// @param far  per first copy: the farthest place around it
void mend_far_places(const FlatSurface& flat, const Raster& raster, const std::vector<FarPlace>& far,
                     ClothAsset& asset);

}  // namespace geocloth
