// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rest/rest_shape.h"

namespace geocloth {

/// A point of a sheet at rest as seen from the middle of a bend [m].
struct SeenPoint {
  double x = 0, y = 0, out = 0;  ///< within the sheet and out of it
  double square = 0;             ///< of its distance
};

/// Numbers of a bend with a fourth point, see lib/bend.h.
struct TurnedBend {
  double chord = 0, weight = 0;  ///< f and g
  double seen = 0;               ///< [m^2] u
  double rest = 0;               ///< [m]
};

/// Of the bend a - middle - b whose turn within the sheet c takes up; nothing where it would see less than half of the
/// curvature, or nearly all of it by one end.
[[nodiscard]] inline std::optional<TurnedBend> turned_bend(const SeenPoint& a, const SeenPoint& b, const SeenPoint& c) {
  constexpr double kLeastSeen = 0.5, kLeastChord = 0.1;
  const double determinant = c.x * (b.y - a.y) - c.y * (b.x - a.x);
  if (determinant == 0) return std::nullopt;
  const double f = (a.x * c.y - c.x * a.y) / determinant, g = (a.x * b.y - b.x * a.y) / determinant;
  const double seen = 0.5 * ((1 - f) * a.square + f * b.square - g * c.square);
  if (!(seen >= 0.5 * kLeastSeen * std::sqrt(a.square * b.square))) return std::nullopt;
  if (!(f >= kLeastChord && f <= 1 - kLeastChord)) return std::nullopt;
  return TurnedBend{f, g, seen, std::abs((1 - f) * a.out + f * b.out - g * c.out)};
}

/// [m/N] Of a bend that sees the curvature of an area [m^2] with a rigidity [N m] by so much [m^2]; above 0.
[[nodiscard]] inline float bend_compliance(double seen, double rigidity, double area) {
  return static_cast<float>(std::clamp(seen * seen / (rigidity * area),
                                       static_cast<double>(std::numeric_limits<float>::min()), kLargestCompliance));
}

}  // namespace geocloth
