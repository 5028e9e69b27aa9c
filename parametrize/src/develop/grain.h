// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "develop/chart.h"

namespace geocloth {

/// The line in a chart's plane that is up in space.
struct Grain {
  Point2 axis{0, 1};    ///< unit length; the end that is higher in space
  double strength = 0;  ///< 0: the chart lies level or turns all ways, 1: it hangs straight
};
[[nodiscard]] Grain grain_of(const Chart& chart);

/// What triangles add to the upward direction of what they make up. All but the area are times the area.
struct GrainSum {
  double area = 0;         ///< in the plane
  Point2 doubled{0, 0};    ///< the upward direction, its angle doubled, times slope
  Point2 mean{0, 0};       ///< the same as it is
  Point2 moment{0, 0};     ///< place
  Point3 square{0, 0, 0};  ///< xx, xy and yy of the place

  void add(const GrainSum& other, double times = 1);
};
/// Of a triangle in space and in the plane.
[[nodiscard]] GrainSum grain_of_triangle(const std::array<Point3, 3>& position, const std::array<Point2, 3>& uv);

/// The direction that turn_upright() turns up.
/// @param outline  points in the plane that span what the sum is of
[[nodiscard]] Point2 upward(const GrainSum& sum, std::span<const Point2> outline);

/// Turns the chart so that the surface's upward direction (+y in space) is up in the plane. Parts that hang head down
/// are right as well: the thread has no head. Of a level chart the long side of the smallest box around it is up, as a
/// tailor lays a cloth straight, and a slender one (ribbons and trims, whose thread runs along them) lies along itself.
void turn_upright(Chart& chart);

/// Does a chart lie otherwise than turn_upright() would have it, by more than the eye sees?
[[nodiscard]] bool is_askew(const Chart& chart);

/// Lets an upright chart's threads, the plane's x and y, meet on the surface at angles nearer to right ones. That costs
/// the map a little stretch and nothing else: the outline stays simple and no triangle flips.
/// @param share  of what angles are worth usually
/// @param times  per triangle: how many times its area it counts; empty: once
void straighten_threads(Chart& chart, double share = 1, std::span<const double> times = {});

/// How the threads of upright charts lie on the surface.
struct ThreadMeasure {
  double angle_p50 = 0, angle_p95 = 0;  ///< [degrees] off a right one; for 50 and 95 % of the area it is less
  double anisotropy_p95 = 1;            ///< stretch one way over that the other way
};
[[nodiscard]] ThreadMeasure measure_threads(const std::vector<Chart>& charts);

/// Stretch one way over that the other way, per triangle; 1 for those of no area.
[[nodiscard]] std::vector<double> anisotropies(const Chart& chart);

}  // namespace geocloth
