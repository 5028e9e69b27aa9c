// SPDX-License-Identifier: Apache-2.0
#include "scene/source_surface.h"

namespace geocloth {
namespace {

std::vector<TriangleCorners> corners_of_all(const SourceMesh& source) {
  std::vector<TriangleCorners> corners;
  corners.reserve(source.triangle.size());
  for (const Triangle& t : source.triangle) corners.push_back(corners_of(t, source.position));
  return corners;
}

}  // namespace

SourceSurface::SourceSurface(const ClothAsset& asset)
    : asset_(asset), corners_(corners_of_all(asset.source)), tree_(corners_) {}

std::optional<SourceSurface::Place> SourceSurface::place_of(uint32_t pixel) const {
  const Vec3d p = to_double(asset_.rest_position[pixel]);
  const std::optional<uint32_t> nearest = tree_.nearest(p);
  if (!nearest) return {};
  const TriangleCorners& t = corners_[*nearest];
  return Place{asset_.source.triangle[*nearest], corner_shares(t, closest_on_triangle(t, p))};
}

}  // namespace geocloth
