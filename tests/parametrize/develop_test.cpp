// SPDX-License-Identifier: GPL-3.0-or-later
#include "develop/develop.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "cut/edge_wishes.h"
#include "develop/chart.h"
#include "develop/chart_overlap.h"
#include "develop/embed_chart.h"
#include "develop/grain.h"
#include "develop/merge_charts.h"
#include "develop/symmetric_dirichlet.h"
#include "geocloth/parametrize/import.h"
#include "geocloth/parametrize/repair.h"
#include "mesh/half_edges.h"
#include "parametrize/clean_surfaces.h"
#include "repair/canonical_order.h"

namespace geocloth {
namespace {

/// A sheet bent into a cap that leans: its curvature has to go somewhere.
Chart laid_out_cap() {
  CleanSurface sheet = test::disk(24, 24);
  for (Point3& p : sheet.position) {
    const double x = p[0] - 0.5, y = p[1] - 0.5;
    p = {x, y, 0.8 * (x * x + y * y) + 0.3 * x * y + 0.2 * y};
  }
  const CutSurface cut = cut_to_disks(sheet);
  Chart chart = extract_chart(cut, triangles_of_components(cut)[0]);
  embed(chart);
  SymmetricDirichlet(chart.position, chart.triangle, {}).minimise(chart.uv, 60, 1e-9);
  turn_upright(chart);
  return chart;
}

/// Root mean square of the angle by which the plane's x and y miss a right one
/// on the surface [rad].
double mean_shear(const Chart& c) {
  double sum = 0, area = 0;
  for (const Triangle& t : c.triangle) {
    const Point2 &a = c.uv[t[0]], &b = c.uv[t[1]], &d = c.uv[t[2]];
    const double e = b[0] - a[0], f = b[1] - a[1], g = d[0] - a[0], h = d[1] - a[1], twice = e * h - f * g;
    double xy = 0, xx = 0, yy = 0;
    for (size_t k = 0; k < 3; ++k) {
      const double p = c.position[t[1]][k] - c.position[t[0]][k], q = c.position[t[2]][k] - c.position[t[0]][k];
      const double along_x = p * h - q * f, along_y = q * e - p * g;
      xx += along_x * along_x;
      yy += along_y * along_y;
      xy += along_x * along_y;
    }
    const double angle = std::asin(xy / std::sqrt(xx * yy));
    sum += angle * angle * twice;
    area += twice;
  }
  return std::sqrt(sum / area);
}

// Springs along and across a weave that do not meet at right angles make a
// cloth that pulls askew.
TEST(Develop, ThreadsMeetAtRightAnglesWhereTheClothIsCurved) {
  Chart chart = laid_out_cap();
  const SymmetricDirichlet energy(chart.position, chart.triangle, {});
  const double shear = mean_shear(chart), excess = energy.energy(chart.uv) - 4;
  ASSERT_GT(shear, 0.01);
  straighten_threads(chart);
  EXPECT_LT(mean_shear(chart), 0.5 * shear);
  EXPECT_LT(energy.energy(chart.uv) - 4, 1.4 * excess);
  EXPECT_TRUE(flip_free(chart));
  EXPECT_FALSE(crossing_edges(chart, outline_loop(chart)));
  EXPECT_GT(grain_of(chart).axis[1], 0.999);
}

// A plush with many arms, or a quilt, wants many cuts. They were bounded by 40, which finer pixels, that allow shorter
// ones, spent before all of it lay flat: more resolution made the layout worse.
TEST(Develop, WhatWantsManyCutsGetsThem) {
  constexpr double kBumps = 7;
  CleanSurface quilt = test::disk(22, 22);
  for (Point3& p : quilt.position) {
    const auto wave = [](double x) { return std::sin(std::numbers::pi * kBumps * x); };
    p = {p[0], p[1], std::abs(wave(p[0]) * wave(p[1])) / kBumps};
  }
  const DevelopedSurface flat = develop(cut_to_disks(quilt), {.least_cut = 0.078});
  double worst = 0;
  for (const double energy : flat.energy) worst = std::max(worst, energy);
  EXPECT_LT(worst, 4.1);
}

TEST(Develop, TheEnergyIsMinimisedAlikeWithEveryInstructionSet) {
  const Chart start = laid_out_cap();
  const auto minimised = [&] {
    Chart chart = start;
    SymmetricDirichlet energy(chart.position, chart.triangle, {});
    energy.set_shear_price(2);
    (void)energy.minimise(chart.uv, 5, 0);
    return chart.uv;
  };
  const std::vector<Point2> best = minimised();
  EXPECT_NE(best, start.uv);
  for (const int64_t target : {int64_t{HWY_SSE4}, int64_t{HWY_AVX2}, int64_t{HWY_AVX3}, int64_t{HWY_NEON}}) {
    if ((hwy::SupportedTargets() & target) == 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    const std::vector<Point2> here = minimised();
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_EQ(best, here) << hwy::TargetName(target);
  }
}

// Where stretch is near its target, angles must be able to take less of it.
TEST(Develop, ThreadsTakeLessStretchWhereTheyAreWorthLess) {
  Chart all = laid_out_cap(), some = all, none = all;
  const SymmetricDirichlet energy(all.position, all.triangle, {});
  straighten_threads(all);
  straighten_threads(some, 0.25);
  straighten_threads(none, 0);
  EXPECT_LT(energy.energy(some.uv), energy.energy(all.uv));
  EXPECT_LT(energy.energy(none.uv), energy.energy(some.uv));
  EXPECT_LT(mean_shear(some), mean_shear(none));
}

// Of a garment that is a little too much stretched in places those places must be able to share it with others.
TEST(Develop, TrianglesThatCountMoreAreStretchedLess) {
  Chart alike = laid_out_cap();
  straighten_threads(alike);
  std::vector<double> times = anisotropies(alike);
  std::vector<double> sorted = times;
  std::sort(sorted.begin(), sorted.end());
  for (double& a : times) a = a > sorted[sorted.size() * 4 / 5] ? 3 : 1;
  Chart even = alike;
  straighten_threads(even, 1, times);
  EXPECT_LT(measure_threads({even}).anisotropy_p95 - 1, 0.95 * (measure_threads({alike}).anisotropy_p95 - 1));
  EXPECT_TRUE(flip_free(even));
  EXPECT_FALSE(crossing_edges(even, outline_loop(even)));
}

// A cut is least seen where the cloth is folded anyway: it may go a little
// further along a crease.
TEST(Develop, CutsPreferCreases) {
  CleanSurface sheet = test::disk(21, 21);
  for (Point3& p : sheet.position) p = {p[0], p[1], std::abs(p[0] - 0.7)};  // folded at right angles
  const Chart chart = extract_chart(cut_to_disks(sheet), [&] {
    std::vector<uint32_t> all(sheet.triangle.size());
    std::iota(all.begin(), all.end(), 0U);
    return all;
  }());
  const auto at = [&](double x, double y) {
    uint32_t best = 0;
    const auto off = [&](uint32_t v) { return std::hypot(chart.position[v][0] - x, chart.position[v][1] - y); };
    for (uint32_t v = 0; v < chart.position.size(); ++v) best = off(v) < off(best) ? v : best;
    return best;
  };
  // From beside the crease to its foot.
  const auto share_on_crease = [&](double discount) {
    const Distances way = distances(chart, {at(0.7, 0)}, on_outline(chart), {discount});
    const std::vector<uint32_t> path = way.path_from(at(0.6, 0.8));
    const auto on_it = std::count_if(path.begin(), path.end(), [&](uint32_t v) { return chart.position[v][2] < 1e-9; });
    return static_cast<double>(on_it) / static_cast<double>(path.size());
  };
  EXPECT_GT(share_on_crease(kCreaseDiscount), 0.8);
  EXPECT_LE(share_on_crease(0), share_on_crease(kCreaseDiscount));
}

void expect_simple_charts(const DevelopedSurface& developed) {
  for (std::vector<uint32_t>& triangles : triangles_of_components(developed.cut)) {
    Chart chart = extract_chart(developed.cut, std::move(triangles));
    for (const uint32_t v : chart.cut_vertex) chart.uv.push_back(developed.uv[v]);
    EXPECT_TRUE(flip_free(chart));
    EXPECT_FALSE(crossing_edges(chart, outline_loop(chart)));
  }
}

/// What is flat in space, tilted and far from the origin.
CleanSurface tilted(CleanSurface sheet) {
  for (Point3& p : sheet.position) p = {5 + 0.6 * p[0], 3 + 0.8 * p[0], p[1] - 2};
  return sheet;
}

// From a circle a belt does not find its way back: it comes out wavy, and its image is mostly empty.
TEST(Develop, ABeltThatLiesStraightStaysStraight) {
  const DevelopedSurface flat = develop(cut_to_disks(tilted(test::disk(1001, 2, 10, 0.01))));
  ASSERT_EQ(flat.cut.component_count, 1U);
  EXPECT_LT(flat.energy[0], 4 + 1e-9);
  Point2 low = flat.uv[0], high = flat.uv[0];
  for (const Point2& p : flat.uv) {
    for (size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  EXPECT_NEAR(std::max(high[0] - low[0], high[1] - low[1]), 10, 1e-6);
  EXPECT_NEAR(std::min(high[0] - low[0], high[1] - low[1]), 0.01, 1e-5);
}

// Folded up it is flat too, but lies over itself.
TEST(Develop, WhatIsFoldedFlatIsLaidOut) {
  CleanSurface sheet = test::disk(21, 5, 2, 0.5);
  for (Point3& p : sheet.position) p = {std::abs(p[0] - 1), p[1], 0};
  const DevelopedSurface flat = develop(cut_to_disks(sheet));
  EXPECT_EQ(flat.cut.component_count, 1U);
  EXPECT_LT(flat.energy[0], 4.0001);
  // Round a corner four times, without a fold.
  CleanSurface coil = test::disk(161, 4, 1, 1);
  for (Point3& p : coil.position) {
    const double a = 8 * std::acos(-1.0) * p[0], r = 1 + 0.5 * p[1];
    p = {r * std::cos(a), r * std::sin(a), 0};
  }
  EXPECT_GE(develop(cut_to_disks(coil)).cut.component_count, 4U) << "each turn lies over the others";
}

/// A closed prism along y, as the pole of a flag or a sail's yard is modelled: each triangle reaches from end to end.
CleanSurface pole(uint32_t sides, double radius, double length) {
  TriangleMesh mesh;
  for (const double y : {0.0, length}) {
    for (uint32_t k = 0; k < sides; ++k) {
      const double a = 2 * std::acos(-1.0) * k / sides;
      mesh.position.push_back({radius * std::cos(a), y, radius * std::sin(a)});
    }
  }
  for (uint32_t k = 0; k < sides; ++k) {
    const uint32_t next = (k + 1) % sides;
    mesh.triangle.push_back({k, sides + k, sides + next});
    mesh.triangle.push_back({k, sides + next, next});
    if (k == 0 || next == 0) continue;
    mesh.triangle.push_back({0, k, next});
    mesh.triangle.push_back({sides, sides + next, sides + k});
  }
  mesh.part.push_back({"pole", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  mesh.material.emplace_back();
  return repair_mesh(mesh).surface;
}

// A banner comes with its pole. Left uncut at its ends, which are smaller than a cut has to be long, it becomes a kite
// five times as wide as it is, with springs of a fiftieth of the spacing.
TEST(Develop, APoleOfFewTrianglesKeepsItsWidth) {
  for (const uint32_t sides : {4U, 8U}) {
    SCOPED_TRACE(sides);
    const DevelopedSurface flat = develop(cut_to_disks(pole(sides, 0.05, 8)), {.least_cut = 0.125});
    expect_simple_charts(flat);
    for (const double energy : flat.energy) EXPECT_LT(energy, 4.15);
  }
}

// A chart that lies over itself has two places of the garment on one pixel.
TEST(Develop, NoChartLiesOverItself) {
  for (const test::NamedSurface& named : test::surfaces_of_every_topology()) {
    SCOPED_TRACE(named.name);
    expect_simple_charts(develop(cut_to_disks(named.make())));
  }
}

// Strips of hair, nearly flat, whose outlines all but touch themselves.
TEST(Develop, NoStripOfHairLiesOverItself) {
  const std::filesystem::path file =
      std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "../shared/meshes/irregular/mh_hair_bob.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no shared meshes here";
  CleanSurface surface = repair_mesh(import_mesh(file)).surface;
  put_in_canonical_order(surface);
  expect_simple_charts(develop(cut_to_disks(surface), {.least_cut = 0.1}));
}

/// A fan of triangles around the vertex 0 that has its rim in common with other such fans. Seen from -z it lies
/// mirrored.
/// @param slit  it is open along the edge from its middle to the rim's first vertex
Chart round_fan(uint32_t corners, uint32_t middle, bool from_behind, bool slit) {
  Chart c;
  const auto add = [&](double x, double y, uint32_t name) {
    c.position.push_back({x, y, 0});
    c.uv.push_back({from_behind ? -x : x, y});
    c.cut_vertex.push_back(name);
  };
  add(0, 0, middle);
  for (uint32_t i = 0; i < corners + (slit ? 1 : 0); ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    add(std::cos(angle), std::sin(angle), i % corners);
  }
  for (uint32_t i = 0; i < corners; ++i) {
    const uint32_t a = 1 + i, b = slit ? a + 1 : 1 + (i + 1) % corners;
    c.triangle.push_back(from_behind ? Triangle{0, b, a} : Triangle{0, a, b});
    c.global_triangle.push_back(i);
  }
  c.opposite = opposite_half_edges(c.triangle);
  return c;
}

// A thick panel, a closed shell, was cut into its two faces, one of them slit by an edge. Sewn along all of the rim,
// the slit closed as well, and what walked along the outline that was none crashed.
TEST(Develop, ChartsThatSewnTogetherHaveNoOutlineStayApart) {
  constexpr uint32_t kCorners = 9;
  Sheet sheet;
  for (uint32_t v = 0; v < kCorners + 2; ++v) sheet.of_vertex.push_back(v);
  sheet.tied.assign(sheet.of_vertex.size(), 0);
  sheet.pinned.assign(sheet.of_vertex.size(), 0);
  for (const bool slit : {true, false}) {
    for (const bool tied : {false, true}) {
      sheet.tied[0] = tied ? 1 : 0;  // the seam of the whole rim begins and ends there
      std::vector<Chart> charts{round_fan(kCorners, kCorners, false, false),
                                round_fan(kCorners, kCorners + 1, true, slit)};
      merge_charts(charts, sheet, {.most_energy = 1e9, .seam_price = 1e9});
      EXPECT_EQ(charts.size(), 2U) << slit << tied;
    }
  }
}

}  // namespace
}  // namespace geocloth
