// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// What a triangle weighs, and where.
struct TriangleMiddle {
  Point3 place;  ///< [m]
  double area;   ///< [m^2]
};
[[nodiscard]] std::vector<TriangleMiddle> triangle_middles(std::span<const Point3> position,
                                                           std::span<const Triangle> triangle);

/// Twice as long as the triangle's area.
[[nodiscard]] Point3 normal_of(std::span<const Point3> position, const Triangle& triangle);
[[nodiscard]] Point3 normal_of(const CleanSurface& surface, std::size_t triangle);

/// [m^2]
[[nodiscard]] double total_area(std::span<const TriangleMiddle> middle);

/// Middles of triangles, each for an equal part of the area; fewer than `count` where there is no area.
[[nodiscard]] std::vector<Point3> even_samples(std::span<const TriangleMiddle> middle, std::size_t count);

}  // namespace geocloth
