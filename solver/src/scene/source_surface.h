// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "colliders/closest.h"
#include "colliders/triangle_tree.h"
#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// The mesh that a garment was converted from: which of its triangles the pixels lie on.
class SourceSurface {
 public:
  explicit SourceSurface(const ClothAsset& asset);

  struct Place {
    Triangle triangle;     ///< render vertices
    Vec3d corner_share{};  ///< of the point of the triangle that is nearest; they sum to 1
  };
  /// Where a pixel lies at rest; copies lie at one place. None where the mesh has no triangle with an area.
  [[nodiscard]] std::optional<Place> place_of(uint32_t pixel) const;

 private:
  const ClothAsset& asset_;
  std::vector<TriangleCorners> corners_;
  TriangleTree tree_;
};

}  // namespace geocloth
