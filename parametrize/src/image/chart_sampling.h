// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// A place in a chart's plane as a triangle and weights that are not negative and sum to 1.
struct PlanePlace {
  uint32_t triangle = kNone;
  Point3 weight{};
};

/// Finds the triangle of one chart that holds a place in its plane, or the nearest one.
class PlaneLocator {
 public:
  /// @param triangles  the chart's triangles, at least one
  PlaneLocator(const FlatSurface& flat, const FlatChart& chart, const std::vector<uint32_t>& triangles);

  [[nodiscard]] PlanePlace locate(const Point2& place) const;

 private:
  [[nodiscard]] const std::vector<uint32_t>& bin(int32_t x, int32_t y) const;

  const FlatSurface& flat_;
  int32_t width_, height_;  ///< [bins] one per pixel, with a margin
  std::vector<std::vector<uint32_t>> bin_;
};

/// The point of the surface that lies at a place of a chart's plane; nothing where the chart ends farther than `beside`
/// [pixels] before it.
/// @param found  what the chart's locator says of the place
[[nodiscard]] std::optional<Point3> surface_point(const FlatSurface& flat, const PlanePlace& found, const Point2& place,
                                                  double beside);

/// Where the pixels of a chart sample its plane: outline pixels at their vertex, pixels deep inside at themselves, and
/// those between so that the grid is as even as it can be there.
/// @returns one place per pixel of the chart's rectangle, row by row; meaningful on the outline and inside
[[nodiscard]] std::vector<Point2> sampling_places(const FlatSurface& flat, const FlatChart& chart);

}  // namespace geocloth
