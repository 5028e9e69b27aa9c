// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "geocloth/solver/solver.h"

namespace geocloth {

/// A cloth where it is when it is cut, in the coordinates of the blade.
struct ClothPose {
  const std::vector<Vec3>& position;  ///< [m] one per pixel; copies agree
  const std::vector<Vec3>& normal;    ///< one per pixel
  float scale = 1;                    ///< of the cloth
};

struct CutCloth {
  std::shared_ptr<const ClothAsset> asset;  ///< null: the blade meets nothing
  CutResult result;
};

/// The asset without what a triangle severs: springs, cells, bends over seams, copies that a cut along a seam parts,
/// and triangles of the source mesh. Vertices of the source that were bound across the cut are bound to their own side,
/// where they are. Pixels, areas and the number of vertices stay.
[[nodiscard]] CutCloth cut_asset(const ClothAsset& asset, const ClothPose& pose, const std::array<Vec3, 3>& blade);

}  // namespace geocloth
