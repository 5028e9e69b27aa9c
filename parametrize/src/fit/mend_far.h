// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/seams.h"

namespace geocloth {

/// A place of the surface, and the one of the image that stands for it.
struct FarPlace {
  double squared = 0;  ///< [m^2] about the distance between the two surfaces there
  Point3 surface{}, image{};
};

/// Brings an image nearer to the surface at the few places where it is so far from it that the largest deviation would
/// show: moves the few pixels around them. Even springs and right angles are not
/// asked for there, only springs between limits and no folded triangles; nothing moves where that does not help. Free
/// borders stay, copies stay bit-identical.
/// @param far  per first copy: the farthest place around it
void mend_far_places(const FlatSurface& flat, const Raster& raster, const std::vector<FarPlace>& far,
                     ClothAsset& asset);

}  // namespace geocloth
