// SPDX-License-Identifier: GPL-3.0-or-later
// Position based dynamics (Mueller et al. 2007) at rest: springs out of bounds are projected on to them, one after the
// other, a few times.
#include "image/limit_springs.h"

#include <algorithm>
#include <array>
#include <vector>

#include "geocloth/asset/grid_mesh.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

/// Bounds of springs and how far a pixel may move from the surface for them [spacing]: for nearly all, and for those
/// that would be left far out.
struct Bounds {
  double shortest, longest, farthest;
};
constexpr std::array kBounds{Bounds{0.35, 1.85, 0.8}, Bounds{0.33, 1.97, 1.1}};
constexpr double kNoLength = 0.05;  // [spacing] below, a spring's own direction means nothing
constexpr int kLimitSweeps = 30;

/// The point of the ball around `home` that is nearest to p.
Point3 held(const Point3& p, const Point3& home, double radius) {
  const double away = distance(p, home);
  return away <= radius ? p : home + (p - home) * (radius / away);
}

/// A structural spring between two points (first copies), and the pixels next to it in its row or column.
struct Spring {
  uint32_t a, b, before, after;
};

std::vector<Spring> structural_springs(const ClothAsset& asset, const std::vector<uint32_t>& first) {
  std::vector<Spring> springs;
  const auto joined = [&](uint32_t pixel, uint8_t bit) { return (asset.spring_mask[pixel] & bit) != 0; };
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    for (const auto& [bit, step] :
         {std::pair(uint8_t{kSpringRight}, 1U), std::pair(uint8_t{kSpringDown}, asset.width)}) {
      if (!joined(i, bit)) continue;
      const uint32_t before = i >= step && joined(i - step, bit) ? i - step : i;
      const uint32_t after = joined(i + step, bit) ? i + 2 * step : i + step;
      springs.push_back({first[i], first[i + step], first[before], first[after]});
    }
  }
  return springs;
}

}  // namespace

void limit_springs(ClothAsset& asset) {
  const std::vector<uint32_t> first = first_copies(asset);
  std::vector<Point3> place;
  place.reserve(asset.pixel_count());
  for (const Vec3& p : asset.rest_position) place.push_back(to_double(p));
  const std::vector<Point3> home = place;
  const double spacing = asset.spacing;
  const std::vector<Spring> springs = structural_springs(asset, first);
  // Where a fold lies flat, its two sides part along their normals.
  std::vector<Vec3> normal;
  const auto outwards = [&](uint32_t p) -> Point3 {
    if (normal.empty()) compute_normals(asset, asset.rest_position, normal);
    return {normal[p].x, normal[p].y, normal[p].z};
  };
  std::vector<uint8_t> moved(asset.pixel_count(), 0);
  const auto limit = [&](const Spring& s, const Bounds& bounds) {
    Point3 along = place[s.b] - place[s.a];
    const double is = length(along), wanted = std::clamp(is, bounds.shortest * spacing, bounds.longest * spacing);
    if (is == wanted) return false;
    if (is < kNoLength * spacing) along = place[s.after] - place[s.before];
    if (length(along) < kNoLength * spacing) along = outwards(s.b) - outwards(s.a);
    const double l = length(along);
    if (!(l > 0)) return false;
    const Point3 move = along * ((wanted - is) / (2 * l));
    place[s.a] = held(place[s.a] - move, home[s.a], bounds.farthest * spacing);
    place[s.b] = held(place[s.b] + move, home[s.b], bounds.farthest * spacing);
    moved[s.a] = moved[s.b] = 1;
    return true;
  };
  for (const Bounds& bounds : kBounds) {
    bool still = false;
    for (int sweep = 0; sweep < kLimitSweeps && !still; ++sweep) {
      still = true;
      for (const Spring& s : springs) {
        if (limit(s, bounds)) still = false;
      }
    }
  }
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i) || moved[first[i]] == 0) continue;
    asset.rest_position[i] = to_single(place[first[i]]);
  }
}

}  // namespace geocloth
