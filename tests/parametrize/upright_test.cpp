// SPDX-License-Identifier: GPL-3.0-or-later
// Which way is up in a garment. The grain of its panels follows from it: a file that lies on its side must not come out
// with the weft along its length.
#include "repair/upright.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "mesh/point_math.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double degrees_between_lines(const Point3& a, const Point3& b) {
  return std::acos(std::min(1.0, std::abs(dot(a, b)))) / kDegree;
}

/// About y, then about x, and elsewhere.
Point3 turned(const Point3& p, double about_y, double about_x) {
  const double c = std::cos(about_y), s = std::sin(about_y), d = std::cos(about_x), e = std::sin(about_x);
  const Point3 q{c * p[0] + s * p[2], p[1], c * p[2] - s * p[0]};
  return {q[0], d * q[1] - e * q[2], e * q[1] + d * q[2]};
}

CleanSurface moved(CleanSurface surface, double about_y, double about_x) {
  for (Point3& p : surface.position) p = turned(p, about_y, about_x) + Point3{3, -7, 2};
  return surface;
}

void expect_up_turns_with(const CleanSurface& surface, double most_off) {
  const Point3 up = find_upright(surface).up();
  EXPECT_LT(degrees_between_lines(up, {0, 1, 0}), most_off);
  for (const double about_y : {0.0, 1.2, 4.0}) {
    for (const double about_x : {0.3, 1.57, 2.4, 3.14, 5.0}) {
      // The same end of the line as well.
      const Point3 turned_up = find_upright(moved(surface, about_y, about_x)).up();
      EXPECT_LT(distance(turned_up, turned(up, about_y, about_x)), 1e-3) << about_y << ' ' << about_x;
    }
  }
}

TEST(Upright, TurnsUpToYAndBack) {
  for (const Point3& direction : {Point3{0, 1, 0}, Point3{0, -1, 0}, Point3{0, 0, 1}, Point3{1, 0, 0},
                                  Point3{0.6, 0, -0.8}, Point3{1e-9, -1, 1e-8}, Point3{0.48, -0.6, 0.64}}) {
    const Upright upright(direction);
    EXPECT_LT(distance(upright.apply(direction), {0, 1, 0}), 1e-12);
    for (const Point3& p : {Point3{1, 0, 0}, Point3{0.3, -2, 5}}) {
      EXPECT_LT(distance(upright.undo(upright.apply(p)), p), 1e-12);
      EXPECT_NEAR(length(upright.apply(p)), length(p), 1e-12);
    }
    const Point3 x = upright.apply({1, 0, 0}), y = upright.apply({0, 1, 0}), z = upright.apply({0, 0, 1});
    EXPECT_NEAR(dot(cross(x, y), z), 1, 1e-12);  // not mirrored
  }
  EXPECT_TRUE(Upright({0, 1, 0}).is_identity());
  EXPECT_EQ(Upright({0, 1, 0}).apply({1.1, 2.2, 3.3}), (Point3{1.1, 2.2, 3.3}));
}

// Neck and hem of a shirt are larger than its cuffs.
TEST(Upright, AShirtByItsOpenings) {
  CleanSurface shirt = test::shirt(8);
  EXPECT_TRUE(find_upright(shirt).higher_end() == (Point3{0, 1, 0}));
  for (Point3& p : shirt.position) p[2] += 0.05 * p[1] * p[1];
  expect_up_turns_with(shirt, 8);
}

// A closed body has no openings, nor has a thickened garment: one end of it is larger.
TEST(Upright, AClosedBodyByItsEnds) {
  CleanSurface egg = test::sphere(32, 24);
  for (Point3& p : egg.position) p = {p[0] * (1 - 0.4 * p[1]), 2 * p[1], 0.8 * p[2] * (1 - 0.4 * p[1])};
  expect_up_turns_with(egg, 1);
}

// The edge of a cape is no opening, and that it is hollow does not make its back the top.
TEST(Upright, ACapeByItsLength) {
  CleanSurface cape = test::disk(21, 31);
  for (Point3& p : cape.position) {
    const double x = p[0] - 0.5, y = 1.5 * p[1];
    p = {x * (1.2 - 0.5 * y), y, 0.4 * x * x};
  }
  expect_up_turns_with(cape, 5);
}

// A flag has neither: what is up in the file is.
TEST(Upright, ASheetStaysAsItIs) {
  EXPECT_TRUE(find_upright(test::disk(11, 21, 2, 1)).is_identity());
  EXPECT_TRUE(find_upright(moved(test::disk(11, 21, 2, 1), 0.4, 1.1)).is_identity());
  EXPECT_TRUE(find_upright(test::sphere(24, 16)).is_identity());
}

// Bit by bit: no digit of a garment that stands upright is lost.
TEST(Upright, ATubeThatStandsIsLeftAlone) {
  EXPECT_TRUE(find_upright(test::cylinder(24, 9)).is_identity());
}

}  // namespace
}  // namespace geocloth
