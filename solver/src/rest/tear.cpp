// SPDX-License-Identifier: Apache-2.0
// Tears as cuts across single springs. A blade is as wide as to meet the diagonals of the two cells beside its spring,
// and not the springs next to it: they are for the frames to come, when they carry what it carried.

#include "rest/tear.h"

#include <algorithm>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/asset/vec3d.h"

namespace geocloth {
namespace {

constexpr size_t kMostTears = 16;  ///< of a cloth in a frame: each costs as a cut does
constexpr uint32_t kNear = 3;      ///< pixels in which one tear is enough at a time

bool are_near(const ClothAsset& asset, const StrainedSpring& x, const StrainedSpring& y) {
  const auto apart = [](uint32_t i, uint32_t k) { return i > k ? i - k : k - i; };
  return apart(x.a % asset.width, y.a % asset.width) <= kNear && apart(x.a / asset.width, y.a / asset.width) <= kNear;
}

}  // namespace

std::vector<StrainedSpring> springs_that_tear(const ClothAsset& asset, std::span<const Vec3> position, float scale,
                                              float stretch) {
  std::vector<StrainedSpring> strained;
  for_structural_springs(asset, [&](uint32_t a, uint32_t b) {
    const auto rest = static_cast<double>(scale * length(asset.rest_position[b] - asset.rest_position[a]));
    const auto now = static_cast<double>(length(position[b] - position[a]));
    if (now > static_cast<double>(stretch) * rest) strained.push_back({a, b, now / rest});
  });
  std::stable_sort(strained.begin(), strained.end(),
                   [](const StrainedSpring& x, const StrainedSpring& y) { return x.stretch > y.stretch; });
  std::vector<StrainedSpring> torn;
  for (const StrainedSpring& spring : strained) {
    if (torn.size() == kMostTears) break;
    const auto is_near = [&](const StrainedSpring& other) { return are_near(asset, spring, other); };
    if (std::none_of(torn.begin(), torn.end(), is_near)) torn.push_back(spring);
  }
  return torn;
}

/// Half as wide at the height of the cloth as at its foot, which lies as far below the cloth as its tip above it.
std::array<Vec3, 3> blade_across(const ClothAsset& asset, const ClothPose& pose, const StrainedSpring& spring) {
  constexpr float kWidth = 0.75F, kHeight = 0.5F;  // [spacings] to either side at the height of the cloth; above it
  const Vec3 way = pose.position[spring.b] - pose.position[spring.a];
  const Vec3 middle = pose.position[spring.a] + 0.5F * way;
  const float spacing = asset.spacing * pose.scale;
  const Vec3d along = unit(to_double(way), {});
  const Vec3d side = unit(cross(to_double(pose.normal[spring.a] + pose.normal[spring.b]), along), any_across(along));
  const Vec3 across = (2 * kWidth * spacing) * to_float(side), up = (kHeight * spacing) * to_float(cross(along, side));
  return {middle - up - across, middle - up + across, middle + up};
}

}  // namespace geocloth
