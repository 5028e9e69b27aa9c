// SPDX-License-Identifier: GPL-3.0-or-later
#include "view/cut_line.h"

#include <algorithm>
#include <cmath>

namespace geocloth::view {

std::optional<std::array<Vec3, 3>> cut_triangle(const ScreenMap& screen, const Vec2& from, const Vec2& to,
                                                const Bounds& cut) {
  constexpr float kShortest = 4;  // [pixels]
  if (!(std::hypot(to.x - from.x, to.y - from.y) >= kShortest) || cut.empty()) return std::nullopt;
  float farthest = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{(corner & 1) != 0 ? cut.high.x : cut.low.x, (corner & 2) != 0 ? cut.high.y : cut.low.y,
                 (corner & 4) != 0 ? cut.high.z : cut.low.z};
    farthest = std::max(farthest, screen.depth(p));
  }
  if (!(farthest > 0)) return std::nullopt;
  const float depth = 1.01F * farthest;
  const Ray a = screen.ray(from), b = screen.ray(to);
  return std::array{a.origin, a.origin + depth * a.direction, b.origin + depth * b.direction};
}

}  // namespace geocloth::view
