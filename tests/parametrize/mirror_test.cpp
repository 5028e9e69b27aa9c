// SPDX-License-Identifier: GPL-3.0-or-later
// Where cuts would rather run. A tailor cuts a left and a right sleeve at the same place, and along folds.
#include "geocloth/parametrize/mirror.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <gtest/gtest.h>

#include "geocloth/parametrize/cut.h"
#include "mesh/point_math.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

std::optional<MirrorPlane> mirror_of(const CleanSurface& s) {
  return find_mirror_plane(s.position, s.triangle);
}

/// Turned about all three axes, and elsewhere.
Point3 moved(const Point3& p) {
  const double c = std::cos(0.7), s = std::sin(0.7), d = std::cos(1.9), e = std::sin(1.9);
  const Point3 q{c * p[0] + s * p[2], p[1], c * p[2] - s * p[0]};
  return {q[0] + 5, d * q[1] - e * q[2] - 2, e * q[1] + d * q[2] + 9};
}

// The file of a garment says nothing about left and right, nor has it to stand upright in the middle.
TEST(Mirror, FindsTheMiddleOfAGarmentWhereverItIs) {
  CleanSurface shirt = test::shirt(8);
  const Point3 origin = moved({0, 0, 0}), left = moved({1, 0, 0});
  for (Point3& p : shirt.position) p = moved({p[0], p[1], p[2] + 0.1 * p[1] * p[1]});
  const std::optional<MirrorPlane> mirror = mirror_of(shirt);
  ASSERT_TRUE(mirror);
  EXPECT_GT(std::abs(dot(mirror->normal, left - origin)), 0.9999);
  EXPECT_NEAR(mirror->height(origin), 0, 0.005);
  EXPECT_EQ(mirror->share, 1);
}

// Meshes are seldom as symmetric as what they show.
TEST(Mirror, LooksAtTheSurfaceNotAtItsEdges) {
  CleanSurface sheet = test::disk(41, 31);
  for (Point3& p : sheet.position) {
    const double x = p[0] - 0.1 * std::sin(2 * std::numbers::pi * p[0]) - 0.5,
                 y = p[1] + 0.1 * p[0] * p[1] * (1 - p[1]);
    p = {x, y, 0.5 * x * x + 0.3 * y * y * y};
  }
  const std::optional<MirrorPlane> mirror = mirror_of(sheet);
  ASSERT_TRUE(mirror);
  EXPECT_GT(std::abs(mirror->normal[0]), 0.999);
  EXPECT_NEAR(mirror->height({0, 0.5, 0.1}), 0, 0.01);
}

// A scarf wound around a neck has no left and right; nothing is to be forced on it.
TEST(Mirror, AHelixHasNone) {
  CleanSurface scarf = test::disk(80, 8);
  for (Point3& p : scarf.position) {
    const double turn = 9 * p[0], radius = 1 + 0.5 * p[1];
    p = {radius * std::cos(turn), 1.5 * p[0] + 0.3 * p[1], radius * std::sin(turn)};
  }
  EXPECT_FALSE(mirror_of(scarf));
}

// Of a round skirt any plane would do, and a turned one would be cut elsewhere.
TEST(Mirror, ARoundSkirtHasNone) {
  CleanSurface skirt = test::cylinder(64, 12, 1, 1);
  for (Point3& p : skirt.position) p = {p[0] * (1.5 - 0.8 * p[1]), p[1], p[2] * (1.5 - 0.8 * p[1])};
  EXPECT_FALSE(mirror_of(skirt));
}

/// Middles and lengths of the edges along which a surface was cut.
std::vector<std::pair<Point3, double>> cut_edges(const CutSurface& cut) {
  std::map<std::array<uint32_t, 2>, int> sides;
  std::map<std::array<uint32_t, 2>, std::array<uint32_t, 2>> of_points;
  std::map<std::array<uint32_t, 2>, int> copies;
  for (const Triangle& t : cut.triangle) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      const std::array<uint32_t, 2> edge{std::min(a, b), std::max(a, b)};
      const uint32_t p = cut.point[a], q = cut.point[b];
      if (sides[edge]++ == 0) ++copies[{std::min(p, q), std::max(p, q)}];
      of_points[{std::min(p, q), std::max(p, q)}] = edge;
    }
  }
  std::vector<std::pair<Point3, double>> result;
  for (const auto& [points, count] : copies) {
    if (count < 2) continue;
    const Point3 &a = cut.position[of_points[points][0]], &b = cut.position[of_points[points][1]];
    result.emplace_back((a + b) * 0.5, distance(a, b));
  }
  return result;
}

/// Share of the cuts, by length, that have a counterpart on the other side.
double matched_share(const std::vector<std::pair<Point3, double>>& edges, const MirrorPlane& mirror, double within) {
  double matched = 0, all = 0;
  for (const auto& [middle, length] : edges) {
    const Point3 image = mirror.image(middle);
    all += length;
    const bool found =
        std::any_of(edges.begin(), edges.end(), [&](const auto& e) { return distance(e.first, image) < within; });
    if (found) matched += length;
  }
  return matched / all;
}

/// A shirt with a little of everything that makes left and right differ by chance.
CleanSurface nearly_symmetric_shirt(double phase) {
  CleanSurface shirt = test::shirt(8);
  for (Point3& p : shirt.position) {
    const auto [x, y, z] = p;
    p = {x + 0.006 * std::sin(9 * y + phase), y + 0.006 * std::sin(7 * x + 2 * phase),
         z + 0.006 * std::sin(11 * x + 5 * y + 3 * phase)};
  }
  return shirt;
}

TEST(Mirror, LeftAndRightAreCutAlike) {
  for (const double phase : {0.3, 1.7, 3.1, 4.4}) {
    const CleanSurface shirt = nearly_symmetric_shirt(phase);
    const std::optional<MirrorPlane> mirror = mirror_of(shirt);
    ASSERT_TRUE(mirror);
    CutOptions options;
    options.prefer.mirror = mirror;
    const double with = matched_share(cut_edges(cut_to_disks(shirt, options)), *mirror, 0.1);
    const double without = matched_share(cut_edges(cut_to_disks(shirt)), *mirror, 0.1);
    EXPECT_GT(with, 0.95) << phase;
    EXPECT_LT(without, with) << phase;
  }
}

// A crease shows a seam least, and lets the curvature out: a cut that follows one stays on it though it winds.
TEST(CutPreferences, CutsFollowACreaseAndAreNotStraightenedOffIt) {
  CleanSurface tube = test::cylinder(48, 30, 1, 3);
  const double column = 2 * std::numbers::pi / 48;
  for (Point3& p : tube.position) {
    const double around = std::atan2(p[2], p[0]);
    const double radius = std::abs(around) < 0.5 * column ? 1.15 : 1.0;
    const double at = around + 0.25 * std::sin(2 * p[1]);
    p = {radius * std::cos(at), p[1], radius * std::sin(at)};
  }
  const auto share_on_ridge = [&](bool creases) {
    CutOptions options;
    options.prefer.creases = creases;
    double on_it = 0, all = 0;
    for (const auto& [middle, length] : cut_edges(cut_to_disks(tube, options))) {
      all += length;
      if (std::hypot(middle[0], middle[2]) > 1.12) on_it += length;
    }
    return on_it / all;
  };
  EXPECT_GT(share_on_ridge(true), 0.99);
  EXPECT_LT(share_on_ridge(false), 0.6);
}

}  // namespace
}  // namespace geocloth
