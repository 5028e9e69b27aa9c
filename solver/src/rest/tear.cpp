// SPDX-License-Identifier: Apache-2.0
// Tears as cuts across single springs. A blade is as wide as to meet the diagonals of the two cells beside its spring,
// and not the springs next to it: they are for the frames to come, when they carry what it carried.

#include "rest/tear.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace geocloth {
namespace {

constexpr size_t kMostTears = 16;  ///< of a cloth in a frame: each costs as a cut does
constexpr uint32_t kNear = 3;      ///< pixels in which one tear is enough at a time

struct Strained {
  uint32_t a, b;  ///< pixels
  double stretch;
};

std::vector<Strained> strained_springs(const ClothAsset& asset, const ClothPose& pose, float stretch) {
  std::vector<Strained> found;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    for (uint32_t c = 0; c < 2; ++c) {
      if ((asset.spring_mask[p] & (1U << c)) == 0) continue;
      const uint32_t q = c == 0 ? p + 1 : p + asset.width;
      const double rest = static_cast<double>(pose.scale * length(asset.rest_position[q] - asset.rest_position[p]));
      const auto now = static_cast<double>(length(pose.position[q] - pose.position[p]));
      if (now > static_cast<double>(stretch) * rest) found.push_back({p, q, now / rest});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Strained& x, const Strained& y) { return x.stretch > y.stretch; });
  return found;
}

bool are_near(const ClothAsset& asset, const Strained& x, const Strained& y) {
  const auto apart = [](uint32_t i, uint32_t k) { return i > k ? i - k : k - i; };
  return apart(x.a % asset.width, y.a % asset.width) <= kNear && apart(x.a / asset.width, y.a / asset.width) <= kNear;
}

/// Half as wide at the height of the cloth as at its foot, which lies as far below the cloth as its tip above it.
std::array<Vec3, 3> blade_across(const ClothAsset& asset, const ClothPose& pose, const Strained& spring) {
  constexpr float kWidth = 0.75F, kHeight = 0.5F;  // [spacings] to either side at the height of the cloth; above it
  const Vec3 way = pose.position[spring.b] - pose.position[spring.a];
  const Vec3 middle = pose.position[spring.a] + 0.5F * way;
  const float spacing = asset.spacing * pose.scale;
  Vec3 side = cross(pose.normal[spring.a] + pose.normal[spring.b], way);
  if (!(length(side) > 0)) side = cross(std::abs(way.y) < 0.5F * length(way) ? Vec3{0, 1, 0} : Vec3{1, 0, 0}, way);
  side = (1 / length(side)) * side;
  const Vec3 up = (kHeight * spacing / length(way)) * cross(way, side), across = (2 * kWidth * spacing) * side;
  return {middle - up - across, middle - up + across, middle + up};
}

}  // namespace

std::vector<std::array<Vec3, 3>> blades_of_tears(const ClothAsset& asset, const ClothPose& pose, float stretch) {
  std::vector<Strained> torn;
  for (const Strained& spring : strained_springs(asset, pose, stretch)) {
    if (torn.size() == kMostTears) break;
    const auto is_near = [&](const Strained& other) { return are_near(asset, spring, other); };
    if (std::none_of(torn.begin(), torn.end(), is_near)) torn.push_back(spring);
  }
  std::vector<std::array<Vec3, 3>> blades;
  blades.reserve(torn.size());
  for (const Strained& spring : torn) blades.push_back(blade_across(asset, pose, spring));
  return blades;
}

}  // namespace geocloth
