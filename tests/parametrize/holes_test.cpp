// SPDX-License-Identifier: GPL-3.0-or-later
// Holes in cloth, as eyelets and cut-outs are, that cost no cut: the cloth around them is laid flat as if they were not
// there, and the image has them all the same.
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "develop/chart_energy.h"
#include "develop/met_holes.h"
#include "geocloth/parametrize/convert.h"
#include "parametrize/clean_surfaces.h"
#include "parametrize/same_topology.h"

namespace geocloth {
namespace {

using test::as_mesh;

ConvertResult convert_at(const TriangleMesh& mesh, uint32_t resolution, Layout layout = Layout::panels) {
  ConvertOptions options;
  options.flatten.layout = layout;
  options.flatten.resolution = resolution;
  options.square_if_panels_fail = false;
  return convert(mesh, options);
}

/// A level sheet of 1.2 m by 0.9 m without the quads, of 40 x 30, that `is_hole` names.
template <class IsHole>
TriangleMesh sheet_without(const IsHole& is_hole) {
  constexpr uint32_t kColumns = 40, kRows = 30;
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  for (uint32_t y = 0; y <= kRows; ++y) {
    for (uint32_t x = 0; x <= kColumns; ++x) position.push_back({0.03 * x, 0, 0.03 * y});
  }
  for (uint32_t y = 0; y < kRows; ++y) {
    for (uint32_t x = 0; x < kColumns; ++x) {
      if (is_hole(x, y)) continue;
      const uint32_t a = y * (kColumns + 1) + x, b = a + 1, c = a + kColumns + 1, d = c + 1;
      triangle.push_back({a, c, d});
      triangle.push_back({a, d, b});
    }
  }
  return as_mesh(std::move(position), std::move(triangle));
}

double mass_of(const ClothAsset& asset) {
  return std::accumulate(asset.area.begin(), asset.area.end(), 0.0);
}

TEST(Holes, OneInAFlatSheetCostsNoCut) {
  const ConvertResult result = convert_at(sheet_without([](uint32_t x, uint32_t y) { return x == 17 && y == 12; }), 64);
  EXPECT_EQ(result.asset.chart_count, 1U);
  EXPECT_EQ(result.report.quality.seam_length, 0);
  EXPECT_EQ(result.asset.splits.rows(), 0U);
  EXPECT_EQ(result.report.welded.boundary_loops, 2U);
  EXPECT_EQ(result.report.welded.euler_characteristic, 0);
  EXPECT_NEAR(result.report.quality.l2_stretch, 1, 1e-6);
  EXPECT_LT(result.report.quality.max_error, 1e-3);
  EXPECT_LT(result.report.quality.spring_p99_over_p1, 1.5);
}

// The filling is no cloth: it has no mass and no pixels.
TEST(Holes, WeighNothing) {
  const auto large = [](uint32_t x, uint32_t y) { return x >= 14 && x < 22 && y >= 10 && y < 18; };
  const ConvertResult result = convert_at(sheet_without(large), 64);
  EXPECT_EQ(result.asset.chart_count, 1U);
  EXPECT_NEAR(mass_of(result.asset), 0.03 * 0.03 * (40 * 30 - 64), 1e-3);
  EXPECT_NEAR(count_valid_pixels(result.asset), 64 * 64, 0.02 * 64 * 64);
  // A pixel of the hole's own inside.
  const Vec3 middle{0.54F, 0, 0.42F};
  for (uint32_t i = 0; i < result.asset.pixel_count(); ++i) {
    if (!result.asset.valid(i)) continue;
    EXPECT_GT(length(result.asset.rest_position[i] - middle), 0.11F);
  }
}

TEST(Holes, ManyKeepTheirTopology) {
  const ConvertResult result =
      convert_at(sheet_without([](uint32_t x, uint32_t y) { return x % 6 == 3 && y % 6 == 3; }), 96);
  EXPECT_EQ(result.asset.chart_count, 1U);
  EXPECT_EQ(result.report.quality.seam_length, 0);
  test::expect_same_topology(result.report.welded, result.report.cleaned);
  EXPECT_LT(result.report.quality.spring_p99_over_p1, 1.5);
  EXPECT_GT(result.report.quality.spring_min, 0.3);
  EXPECT_LT(result.report.quality.spring_max, 2);
}

// A strip of a tenth of a pixel beside a hole has no room for two rows of pixels as they stand: such a hole is cut open
// or finds its pixels further inside, but the image is right in any case.
TEST(Holes, NextToTheBorderOrToEachOtherStillConvert) {
  TriangleMesh mesh =
      sheet_without([](uint32_t x, uint32_t y) { return (x == 1 && y == 14) || (x == 20 && (y == 14 || y == 16)); });
  // The columns left of the first hole and the row between the others become narrow.
  for (Point3& p : mesh.position) {
    if (p[0] == 0.0) p[0] = 0.0285;
    if (p[2] > 0.449 && p[2] < 0.451) p[2] = 0.4785;
  }
  const ConvertResult result = convert_at(mesh, 48);
  test::expect_same_topology(result.report.welded, result.report.cleaned);
  EXPECT_EQ(result.report.welded.boundary_loops, 4U);
}

// A neck, a hem and sleeves are no holes: what would close them stands across the cloth.
TEST(Holes, OfAShirtsFrontCostNoMoreCutsThanItsOpeningsDo) {
  const CleanSurface shirt = test::shirt(8);
  const auto without = [&](uint32_t first) {
    std::vector<Triangle> triangle = shirt.triangle;
    triangle.erase(triangle.begin() + first, triangle.begin() + first + 2);
    return as_mesh(shirt.position, std::move(triangle));
  };
  const ConvertReport whole = convert_at(as_mesh(shirt.position, shirt.triangle), 96).report;
  // One quad of the front, in the middle of its height, where the whole shirt is not cut.
  const ConvertResult holed = convert_at(without(2 * (10 * 16 + 8)), 96);
  EXPECT_EQ(holed.report.welded.boundary_loops, whole.welded.boundary_loops + 1);
  EXPECT_EQ(holed.report.welded.euler_characteristic, whole.welded.euler_characteristic - 1);
  EXPECT_LE(holed.report.quality.seam_length, 1.1 * whole.quality.seam_length);
}

// The ends of a tube are no holes in it.
TEST(Holes, ATubeIsCutAlongItself) {
  const CleanSurface tube = test::cylinder(24, 12);
  const ConvertResult result = convert_at(as_mesh(tube.position, tube.triangle), 48);
  EXPECT_EQ(result.asset.chart_count, 1U);
  EXPECT_GT(result.report.quality.seam_length, 0);
}

/// A ball, or a tube where it is not closed, of 48 x 24 quads without those that `is_hole` names.
template <class IsHole>
TriangleMesh round_without(bool ball, const IsHole& is_hole) {
  constexpr uint32_t kAround = 48, kAlong = 24;
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  for (uint32_t y = 0; y <= kAlong; ++y) {
    const double along = static_cast<double>(y) / kAlong;
    const double slope = std::numbers::pi * (0.05 + 0.9 * along), radius = ball ? 0.3 * std::sin(slope) : 0.2;
    for (uint32_t x = 0; x < kAround; ++x) {
      const double angle = 2 * std::numbers::pi * x / kAround;
      position.push_back(
          {radius * std::cos(angle), ball ? 0.3 * std::cos(slope) : -0.8 * along, radius * std::sin(angle)});
    }
  }
  for (uint32_t y = 0; y < kAlong; ++y) {
    for (uint32_t x = 0; x < kAround; ++x) {
      if (is_hole(x, y)) continue;
      const uint32_t next = (x + 1) % kAround;
      const uint32_t a = y * kAround + x, b = y * kAround + next, c = a + kAround, d = b + kAround;
      triangle.push_back({a, d, c});
      triangle.push_back({a, b, d});
    }
  }
  return as_mesh(std::move(position), std::move(triangle));
}

// A tube needs one seam, from end to end, and eyelets are no reason for more.
TEST(Holes, InATubeCostNoMoreThanTheTubesSeam) {
  const ConvertReport whole = convert_at(round_without(false, [](auto, auto) { return false; }), 96).report;
  const ConvertReport holed =
      convert_at(round_without(false, [](uint32_t x, uint32_t y) { return x % 8 == 3 && y % 6 == 2; }), 96).report;
  EXPECT_EQ(holed.welded.boundary_loops, 2U + 24U);
  EXPECT_LE(holed.quality.seam_length, 1.1 * whole.quality.seam_length);
}

// Where a surface has to be cut anyway, its cuts run into holes: these are opened where they are, and the others stay.
// A layout with all of them cut open would have to join every hole to the next.
TEST(Holes, OfABallThatCutsMeetDoNotCostTheOthersTheirFillings) {
  const auto is_hole = [](uint32_t x, uint32_t y) { return x % 8 == 3 && y % 4 == 2 && y > 2 && y < 22; };
  const ConvertResult holed = convert_at(round_without(true, is_hole), 96);
  const ConvertReport whole = convert_at(round_without(true, [](auto, auto) { return false; }), 96).report;
  test::expect_same_topology(holed.report.welded, holed.report.cleaned);
  EXPECT_LE(holed.report.quality.seam_length, 1.25 * whole.quality.seam_length);
  EXPECT_LT(holed.report.quality.l2_stretch, 1.02);
}

/// A square of two triangles, one of which fills a hole.
Chart half_filled() {
  Chart chart;
  chart.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  chart.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  chart.triangle = {{0, 1, 2}, {0, 2, 3}};
  chart.global_triangle = {0, 1};
  chart.cut_vertex = {0, 1, 2, 3};
  chart.hole = {kNone, 0};
  chart.opposite = {kNone, kNone, 3, 2, kNone, kNone};
  return chart;
}

// Cloth is laid out for its own sake: what fills a hole would pull at the cloth around it, and a stretched filling
// would count as stretched cloth.
TEST(Holes, FillingsCountNextToNothingInTheEnergy) {
  Chart chart = half_filled();
  chart.uv[3] = {-1, 2};
  EXPECT_LT(chart_energy(chart).energy(chart.uv), 4.2);
  EXPECT_NEAR(total_area(chart), 0.5, 1e-12);
  chart.hole.clear();
  EXPECT_GT(chart_energy(chart).energy(chart.uv), 5);
}

// A hole on the outline is part of it; were it still filled, the image would have cloth where there is none.
TEST(Holes, ThatAnOutlineMeetsAreOpened) {
  std::vector<Chart> charts{half_filled()};
  EXPECT_TRUE(open_met_holes(charts));
  ASSERT_EQ(charts.size(), 1U);
  ASSERT_EQ(charts[0].triangle.size(), 1U);
  EXPECT_EQ(charts[0].position.size(), 3U);
  EXPECT_EQ(outline_loop(charts[0]).size(), 3U);
  EXPECT_FALSE(open_met_holes(charts));
}

// The opening of a skirt's waist is no hole in it, however flat it may be closed: a tube that was filled would be a
// bag, stretched where its end is.
TEST(Holes, AWaistIsLeftOpen) {
  const auto without_top = [](double top, double bottom, double height) {
    constexpr uint32_t kAround = 60, kAlong = 20;
    std::vector<Point3> position;
    std::vector<Triangle> triangle;
    for (uint32_t y = 0; y <= kAlong; ++y) {
      const double along = static_cast<double>(y) / kAlong, radius = top + (bottom - top) * along;
      for (uint32_t x = 0; x < kAround; ++x) {
        const double angle = 2 * std::numbers::pi * x / kAround;
        position.push_back({radius * std::cos(angle), -height * along, radius * std::sin(angle)});
      }
    }
    for (uint32_t y = 0; y < kAlong; ++y) {
      for (uint32_t x = 0; x < kAround; ++x) {
        const uint32_t next = (x + 1) % kAround;
        const uint32_t a = y * kAround + x, b = y * kAround + next, c = a + kAround, d = b + kAround;
        triangle.push_back({a, d, c});
        triangle.push_back({a, b, d});
      }
    }
    return as_mesh(std::move(position), std::move(triangle));
  };
  const ConvertReport skirt = convert_at(without_top(0.12, 0.4, 0.5), 64).report;
  EXPECT_GT(skirt.quality.seam_length, 0.3);
  EXPECT_LT(skirt.quality.l2_stretch, 1.01);
  // One that lies flat needs no seam for it.
  const ConvertReport flat = convert_at(without_top(0.05, 0.5, 0), 64).report;
  EXPECT_EQ(flat.quality.seam_length, 0);
  EXPECT_LT(flat.quality.l2_stretch, 1.001);
}

// Holes that touch each other in a vertex, and one on the border: neither may cost the garment its image.
TEST(Holes, ThatTouchEachOtherOrTheBorderStillConvert) {
  const ConvertResult result =
      convert_at(sheet_without([](uint32_t x, uint32_t y) {
                   return (x == 10 && y == 10) || (x == 11 && y == 11) || (x == 0 && y == 20) || (x == 30 && y == 20);
                 }),
                 64);
  test::expect_same_topology(result.report.welded, result.report.cleaned);
}

TEST(Holes, AreTheSameEveryTime) {
  const TriangleMesh mesh =
      round_without(true, [](uint32_t x, uint32_t y) { return x % 8 == 3 && y % 4 == 2 && y > 2 && y < 22; });
  const ClothAsset a = convert_at(mesh, 64).asset, b = convert_at(mesh, 64).asset;
  EXPECT_EQ(a.chart, b.chart);
  ASSERT_EQ(a.pixel_count(), b.pixel_count());
  for (uint32_t i = 0; i < a.pixel_count(); ++i) {
    if (!a.valid(i)) continue;
    EXPECT_EQ(length(a.rest_position[i] - b.rest_position[i]), 0);
  }
}

TEST(Holes, AreTheSameInAnyUnitAndOrder) {
  const TriangleMesh mesh = sheet_without([](uint32_t x, uint32_t y) { return x % 13 == 5 && y % 9 == 4; });
  TriangleMesh other = mesh;
  for (Point3& p : other.position) p = {4 * p[0], 4 * p[1], 4 * p[2]};
  std::mt19937 random(7);
  for (size_t i = other.triangle.size(); i > 1; --i) std::swap(other.triangle[i - 1], other.triangle[random() % i]);
  const ClothAsset a = convert_at(mesh, 64).asset, b = convert_at(other, 64).asset;
  EXPECT_EQ(a.chart, b.chart);
  EXPECT_EQ(a.cell, b.cell);
  EXPECT_EQ(a.spring_mask, b.spring_mask);
  for (uint32_t i = 0; i < a.pixel_count(); ++i) {
    EXPECT_LT(length(a.rest_position[i] * 4 - b.rest_position[i]), 1e-4F);
  }
}

// Vertices on the rim are bound where they are.
TEST(Holes, TheirRimsAreBoundExactly) {
  const ConvertResult result = convert_at(sheet_without([](uint32_t x, uint32_t y) { return x == 17 && y == 12; }), 64);
  EXPECT_LT(result.report.quality.binding_error, 1e-5);
  for (const Binding& b : result.asset.binding) {
    EXPECT_LT(length(b.offset), result.asset.spacing);
  }
}

}  // namespace
}  // namespace geocloth
