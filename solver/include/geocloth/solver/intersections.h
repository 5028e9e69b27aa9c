// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// A cloth as it stands.
struct PosedCloth {
  const ClothAsset& asset;              ///< as cuts have left it, see Solver::asset
  std::span<const Vec3> position = {};  ///< [m] one per pixel
};

/// Pairs of triangles that cut through each other.
struct Intersections {
  uint64_t within = 0;   ///< of one cloth
  uint64_t between = 0;  ///< of two
};
/// Where cloths have got through themselves and each other, over the triangles of their grids: a side of one triangle
/// goes through another one. Such as share a point, also one that is to be sewn, do not count, nor do those that only
/// touch or lie in one plane. Collisions of cloth keep what is 0 at 0; they do not draw apart what lies through each
/// other. In double precision, about 2 us a triangle on one thread, on all threads that there are.
/// @throws Error(invalid_argument) unless each cloth has one position for each pixel. Triangles with a corner that is
///   not finite are left out.
[[nodiscard]] Intersections count_intersections(std::span<const PosedCloth> cloths);

}  // namespace geocloth
