// SPDX-License-Identifier: GPL-3.0-or-later
#include "hold_angles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geocloth/asset/grid_mesh.h"
#include "point_math.h"

namespace geocloth {
namespace {

constexpr double kMost = 0.095;  // [cosine] 5.5 degrees: angles nearer to 90 may become what they like
constexpr double kShort = 0.06;  // [spacing] longer ways are left
constexpr double kKept = 0.7;    // of a way, per sweep and angle
constexpr int kSweeps = 6;

/// Two springs that meet, and the cosine of their angle before.
struct Meeting {
  uint32_t middle, beside, below;
  double before;
};

double cosine(const Point3& a, const Point3& b) {
  const double lengths = length(a) * length(b);
  return lengths > 0 ? std::abs(dot(a, b)) / lengths : 1;
}

std::vector<Meeting> meetings(const ClothAsset& asset, std::span<const Point3> position) {
  std::vector<Meeting> result;
  const uint32_t w = asset.width;
  const auto joined = [&](uint32_t pixel, uint8_t bit) { return (asset.spring_mask[pixel] & bit) != 0; };
  for (uint32_t y = 0; y < asset.height; ++y) {
    for (uint32_t x = 0; x < w; ++x) {
      const uint32_t i = y * w + x;
      if (!asset.valid(i)) continue;
      const std::array beside{std::pair(joined(i, kSpringRight), i + 1),
                              std::pair(x > 0 && joined(i - 1, kSpringRight), i - 1)};
      const std::array below{std::pair(joined(i, kSpringDown), i + w),
                             std::pair(y > 0 && joined(i - w, kSpringDown), i - w)};
      for (const auto& [has_beside, a] : beside) {
        for (const auto& [has_below, b] : below) {
          if (!has_beside || !has_below) continue;
          result.push_back({i, a, b, cosine(position[a] - position[i], position[b] - position[i])});
        }
      }
    }
  }
  return result;
}

/// Per first copy, of unit length where there is one.
std::vector<Point3> normals(const ClothAsset& asset, std::span<const Point3> position,
                            std::span<const uint32_t> first) {
  std::vector<Point3> normal(asset.pixel_count(), Point3{});
  for (const Triangle& t : pixel_triangles(asset)) {
    const Point3 n = cross(position[t[1]] - position[t[0]], position[t[2]] - position[t[0]]);
    for (const uint32_t v : t) normal[first[v]] = normal[first[v]] + n;
  }
  for (Point3& n : normal) {
    const double l = length(n);
    if (l > 0) n = n * (1 / l);
  }
  return normal;
}

}  // namespace

void hold_angles(const ClothAsset& asset, std::span<const Point3> position, std::span<const uint32_t> first,
                 std::vector<Point3>& shift) {
  const std::vector<Meeting> meeting = meetings(asset, position);
  const std::vector<Point3> normal = normals(asset, position, first);
  const auto across = [&](uint32_t p) { return normal[p] * dot(normal[p], shift[p]); };
  const auto moved = [&](uint32_t pixel) { return position[pixel] + shift[first[pixel]]; };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const Meeting& m : meeting) {
      const Point3 at = moved(m.middle);
      const double now = cosine(moved(m.beside) - at, moved(m.below) - at);
      if (now <= kMost || now <= m.before) continue;
      const std::array points{first[m.middle], first[m.beside], first[m.below]};
      const auto went_far = [&](uint32_t p) { return distance(shift[p], across(p)) > kShort * asset.spacing; };
      if (std::any_of(points.begin(), points.end(), went_far)) continue;
      for (const uint32_t p : points) shift[p] = across(p) + (shift[p] - across(p)) * kKept;
    }
  }
}

}  // namespace geocloth
