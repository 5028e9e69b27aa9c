// SPDX-License-Identifier: GPL-3.0-or-later
// Which way is up in a garment. The grain of its panels follows from it: a file that lies on its side must not come out
// with the weft along its length.
#include "repair/upright.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "geocloth/parametrize/repair.h"
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

/// What is left of a surface without some of its triangles, by where their middles are.
CleanSurface without(const CleanSurface& surface, const std::function<bool(const Point3&)>& is_out) {
  std::vector<Triangle> kept;
  for (const Triangle& t : surface.triangle) {
    const Point3 middle = (surface.position[t[0]] + surface.position[t[1]] + surface.position[t[2]]) * (1.0 / 3);
    if (!is_out(middle)) kept.push_back(t);
  }
  return repair_mesh(test::as_mesh(surface.position, kept)).surface;
}

CleanSurface flat(uint32_t nx, uint32_t ny, double width, double height) {
  CleanSurface sheet = test::disk(nx, ny, width, height);
  for (Point3& p : sheet.position) p[2] = 0;
  return sheet;
}

// The cuffs of a jacket that is open in front are the only openings that it has, and they face its sides: its grain ran
// from one to the other.
TEST(Upright, AnOpenJacketNotByItsCuffs) {
  CleanSurface shirt = test::shirt(8);
  for (Point3& p : shirt.position) p[2] += 0.05 * p[1] * p[1];
  for (const double gap : {0.04, 0.15}) {
    expect_up_turns_with(without(shirt, [&](const Point3& p) { return std::abs(p[0]) < gap && p[2] > 0.1; }), 10);
  }
}

// The holes of a flag with a star cut out, or of an apron, are no openings: its grain ran across.
TEST(Upright, HolesInASheetAreNoOpenings) {
  const CleanSurface flag =
      without(flat(31, 21, 1.5, 1), [](const Point3& p) { return std::hypot(p[0] - 0.5, p[1] - 0.6) < 0.2; });
  EXPECT_TRUE(find_upright(flag).is_identity());
  // A poncho, or a circle skirt that lies flat, stands on its hole wherever it lies.
  const CleanSurface poncho =
      without(flat(31, 31, 1, 1), [](const Point3& p) { return std::hypot(p[0] - 0.5, p[1] - 0.5) < 0.15; });
  EXPECT_LT(degrees_between_lines(find_upright(poncho).up(), {0, 0, 1}), 1);
}

// Waves made one side of a curtain unlike the other, and its grain ran across them.
TEST(Upright, ACurtainOrAFlagInTheWindAlongItsFolds) {
  CleanSurface curtain = flat(81, 31, 1.5, 2);
  for (Point3& p : curtain.position) p[2] = 0.03 * std::sin(23 * p[0]);
  CleanSurface flag = flat(81, 31, 1.5, 1);  // its folds are slanted
  for (Point3& p : flag.position) p[2] = 0.06 * p[0] * std::sin(9 * p[0] + 1.5 * p[1]);
  for (const CleanSurface* sheet : {&curtain, &flag}) {  // whose ends are alike
    for (const double about_x : {0.0, 0.3, 1.57, 2.4, 5.0})
      EXPECT_LT(degrees_between_lines(find_upright(moved(*sheet, 1.2, about_x)).up(), turned({0, 1, 0}, 1.2, about_x)),
                3);
  }
}

// The open front of a cape made front and back unlike, more than its hem and collar.
TEST(Upright, ACapeThatIsOpenInFrontAlongItsSides) {
  CleanSurface cape = flat(41, 21, 1, 1);
  for (Point3& p : cape.position) {
    const double angle = 3.5 * (p[0] - 0.5), radius = 0.4 - 0.2 * p[1];
    p = {radius * std::sin(angle), p[1], -radius * std::cos(angle)};
  }
  expect_up_turns_with(cape, 5);
}

// It is bent as it lies on the shoulders and hangs down the back, which is no fold.
TEST(Upright, ACapeThatIsBentOverTheBackAsItTapers) {
  CleanSurface cape = flat(21, 31, 1, 1.5);
  for (Point3& p : cape.position) p = {(p[0] - 0.5) * (1.2 - 0.5 * p[1]), p[1], -0.15 * p[1] * p[1]};
  expect_up_turns_with(cape, 20);
}

// A flag that hangs straight has none of these: what is up in the file is.
TEST(Upright, ASheetStaysAsItIs) {
  EXPECT_TRUE(find_upright(flat(11, 21, 2, 1)).is_identity());
  EXPECT_TRUE(find_upright(moved(flat(11, 21, 2, 1), 0.4, 1.1)).is_identity());
  EXPECT_TRUE(find_upright(test::sphere(24, 16)).is_identity());
}

// Bit by bit: no digit of a garment that stands upright is lost.
TEST(Upright, ATubeThatStandsIsLeftAlone) {
  EXPECT_TRUE(find_upright(test::cylinder(24, 9)).is_identity());
}

}  // namespace
}  // namespace geocloth
