// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "colliders/beside_triangle.h"
#include "colliders/triangle_tree.h"
#include "geocloth/asset/cloth_asset.h"

namespace geocloth {

/// Where a point is at rest: beside a triangle.
struct RestPlace {
  Triangle triangle;
  PlaceBeside beside;
};

/// Triangles of a garment at rest. Nearest may be what is far along the cloth: a lining, or what lies beyond a slit.
class RestSurface {
 public:
  RestSurface(std::span<const Vec3> position, std::vector<Triangle> triangles, float spacing);

  /// On the nearest triangle that may be taken, or on the nearest one where that is nearer by more than a spacing.
  /// @param may_take  a triangle, by its number
  /// @return none where no triangle has an area
  [[nodiscard]] std::optional<RestPlace> place_of(const Vec3d& p, const TriangleTree::MayTake& may_take) const;

  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  [[nodiscard]] double distance(const Vec3d& p, uint32_t triangle) const;

  std::vector<Triangle> triangles_;
  std::vector<TriangleCorners> corners_;
  TriangleTree tree_;
  double spacing_;
};

/// The mesh that a garment was converted from: which of its triangles the pixels lie on.
class SourceSurface {
 public:
  explicit SourceSurface(const ClothAsset& asset);

  /// Where a pixel lies at rest, on what is bound near it in the image, or near one of its copies, which lie at the
  /// same place. None where the mesh has no triangle with an area.
  [[nodiscard]] std::optional<RestPlace> place_of(uint32_t pixel) const;

 private:
  const ClothAsset& asset_;
  std::vector<uint32_t> row_of_pixel_;  ///< of the split-vertex table; kNoPixel for a single pixel
  RestSurface surface_;
};

/// Whether a triangle of the mesh is bound to pixels in the chart of a pixel that are no farther from it than the
/// triangle is large, and two more.
[[nodiscard]] bool is_bound_near(const ClothAsset& asset, const Triangle& triangle, uint32_t pixel);

}  // namespace geocloth
