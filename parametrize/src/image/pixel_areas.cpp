// SPDX-License-Identifier: GPL-3.0-or-later
// Lumped areas: every copy of a split vertex gets the share on its own side of the cut, so that the mass of the cloth
// is counted once however it is cut.
#include "image/pixel_areas.h"

#include <algorithm>

#include "geocloth/asset/grid_mesh.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

/// Area share of a pixel whose triangles have collapsed, as a share of spacing^2: it must have some mass.
constexpr double kLeastAreaShare = 1e-6;

}  // namespace

void share_area(ClothAsset& asset) {
  std::vector<double> area(asset.pixel_count(), 0);
  const auto at = [&](uint32_t i) {
    const Vec3& p = asset.rest_position[i];
    return Point3{p.x, p.y, p.z};
  };
  for (const Triangle& t : pixel_triangles(asset)) {
    const double third = triangle_area(at(t[0]), at(t[1]), at(t[2])) / 3;
    for (const uint32_t pixel : t) area[pixel] += third;
  }
  const double least = kLeastAreaShare * asset.spacing * asset.spacing;
  asset.area.assign(asset.pixel_count(), 0);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.valid(i)) asset.area[i] = static_cast<float>(std::max(area[i], least));
  }
}

}  // namespace geocloth
