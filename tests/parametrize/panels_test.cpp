// SPDX-License-Identifier: GPL-3.0-or-later
// Layout panels: charts like sewing patterns. What users rely on: nothing flips, nothing is lost, seams meet point by
// point, developable cloth comes out undistorted, and the warp runs down the garment.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "develop/develop.h"
#include "develop/symmetric_dirichlet.h"
#include "flatten/panel_layout.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/quality.h"
#include "geocloth/parametrize/seams.h"
#include "image/chain_conflicts.h"
#include "image/lattice_shift.h"
#include "image/limit_springs.h"
#include "image/pixel_chain.h"
#include "image/seam_measure.h"
#include "mesh/point_math.h"
#include "parametrize/clean_surfaces.h"
#include "parametrize/same_topology.h"

namespace geocloth {
namespace {

using test::expect_same_topology;
using test::over_points;

FlatSurface flatten_panels(const CleanSurface& surface, uint32_t resolution) {
  return flatten(surface, cut_to_disks(surface), {.layout = Layout::panels, .resolution = resolution});
}

double area_twice(const Point2& p, const Point2& q, const Point2& r) {
  return (q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]);
}

void expect_no_triangle_flipped(const FlatSurface& flat) {
  for (const auto& [a, b, c] : flat.triangle) {
    EXPECT_LT(area_twice(flat.uv[a], flat.uv[b], flat.uv[c]), 0);  // v runs down
  }
}

// A chain that met a pixel twice or jumped would join or tear cloth there.
void expect_outlines_to_be_closed_simple_chains(const FlatSurface& flat) {
  for (const FlatChart& chart : flat.charts) {
    std::set<std::pair<uint32_t, uint32_t>> seen;
    for (size_t i = 0; i < chart.outline.size(); ++i) {
      const OutlineSample& s = chart.outline[i];
      const OutlineSample& next = chart.outline[(i + 1) % chart.outline.size()];
      EXPECT_LT(s.x, chart.width);
      EXPECT_LT(s.y, chart.height);
      EXPECT_TRUE(seen.insert({s.x, s.y}).second);
      EXPECT_LE(std::max(std::abs(static_cast<int>(s.x) - static_cast<int>(next.x)),
                         std::abs(static_cast<int>(s.y) - static_cast<int>(next.y))),
                1);
      EXPECT_NE(flat.point[s.vertex], flat.point[next.vertex]);
    }
  }
}

// Both sides of a seam, and every sheet on it, hold the same points: the same positions to the bit.
void expect_copies_to_coincide(const FlatSurface& flat) {
  std::map<uint32_t, Point3> place;
  for (const FlatChart& chart : flat.charts) {
    for (const OutlineSample& s : chart.outline) {
      EXPECT_EQ(place.try_emplace(flat.point[s.vertex], flat.position[s.vertex]).first->second,
                flat.position[s.vertex]);
    }
  }
}

void expect_welded_grid_to_be_the_garment(const CleanSurface& clean, const FlatSurface& flat) {
  const Raster raster = rasterize(flat);
  EXPECT_TRUE(raster.overlapping.empty());
  const ClothAsset asset = build_image(flat, raster, Layout::panels);
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  expect_same_topology(measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size())),
                       measure_topology(over_points(clean.triangle, clean.point), clean.point_count));
}

class Panels : public ::testing::TestWithParam<test::NamedSurface> {};

// One test, for the layout takes nearly all of its time.
TEST_P(Panels, AreRightAndTheSameEveryTime) {
  const CleanSurface surface = GetParam().make();
  const FlatSurface flat = flatten_panels(surface, 48);
  expect_no_triangle_flipped(flat);
  expect_outlines_to_be_closed_simple_chains(flat);
  expect_copies_to_coincide(flat);
  expect_welded_grid_to_be_the_garment(surface, flat);
  const FlatSurface again = flatten_panels(surface, 48);
  EXPECT_EQ(again.uv, flat.uv);
  EXPECT_EQ(again.triangle, flat.triangle);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Panels, ::testing::ValuesIn(test::surfaces_of_every_topology()),
                         [](const auto& test) { return test.param.name; });

Quality image_quality(const CleanSurface& surface, const FlatSurface& flat) {
  const Raster raster = rasterize(flat);
  ClothAsset asset = build_image(flat, raster, Layout::panels);
  asset.source.position = {asset.rest_position[0]};
  return measure_quality(surface, flat, raster, asset);
}

/// An upright rectangle turned in its plane.
CleanSurface slanted_sheet(double degrees) {
  CleanSurface sheet = test::disk(21, 21);
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  for (Point3& p : sheet.position) {
    const double x = p[0], y = p[1] + p[2];
    p = {x * c - y * s, x * s + y * c, 0};
  }
  return sheet;
}

// Cloth is stiff along its threads and soft askew to them: beside an outline that runs at any angle to the pixels the
// two must still meet at right angles, at an even distance.
TEST(PanelGrid, ThreadsStayStraightBesideASlantedOutline) {
  for (const double degrees : {0.0, 3.0, 12.0, 26.0, 38.0, 45.0}) {
    const CleanSurface sheet = slanted_sheet(degrees);
    const Quality q = image_quality(sheet, flatten_panels(sheet, 48));
    EXPECT_LT(q.shear_deg_p95, 6) << degrees;
    EXPECT_GT(q.spring_min, 0.5) << degrees;
    EXPECT_LT(q.spring_max, 1.6) << degrees;
    EXPECT_LT(q.spring_p99_over_p1, 1.55) << degrees;
  }
}

// The same along seams whose sides lie at different angles.
TEST(PanelGrid, ThreadsStayStraightBesideTheSeamsOfAShirt) {
  const CleanSurface shirt = test::shirt(8);
  const Quality q = image_quality(shirt, flatten_panels(shirt, 96));
  EXPECT_LT(q.shear_deg_p95, 6);
  EXPECT_GT(q.spring_min, 0.3);
  EXPECT_LT(q.spring_max, 2);
}

// A hem ends where the cloth ends: its corners are not cut off, at any angle to the pixels.
TEST(PanelGrid, CornersOfAFreeBorderAreSamples) {
  for (const double degrees : {0.0, 10.0, 31.0}) {
    const CleanSurface sheet = slanted_sheet(degrees);
    const FlatSurface flat = flatten_panels(sheet, 32);
    const auto sampled = [&](const Point3& corner) {
      return std::any_of(flat.charts[0].outline.begin(), flat.charts[0].outline.end(),
                         [&](const OutlineSample& s) { return distance(flat.position[s.vertex], corner) < 1e-9; });
    };
    for (const uint32_t corner : {0U, 20U, 420U, 440U}) EXPECT_TRUE(sampled(sheet.position[corner])) << degrees;
  }
}

// A sleeve is developable: as a panel it must have no distortion at all, in one piece.
TEST(Develop, ACylinderBecomesARectangle) {
  const CleanSurface sleeve = test::cylinder(48, 40, 0.1, 0.6);
  const DevelopedSurface developed = develop(cut_to_disks(sleeve));
  ASSERT_EQ(developed.energy.size(), 1U);
  EXPECT_GE(developed.energy[0], 4 - 1e-9);
  EXPECT_LT(developed.energy[0], 4 + 1e-4);
}

// A sphere is as far from developable as cloth can be: it must be cut until it is nearly flat, within bounds.
TEST(Develop, ASphereIsCutUntilItLiesFlat) {
  const DevelopedSurface developed = develop(cut_to_disks(test::sphere(32, 24)));
  double worst = 0;
  for (const double e : developed.energy) worst = std::max(worst, e);
  EXPECT_LT(worst, 4.6);
  EXPECT_LT(developed.energy.size(), 12U);
}

// Grain: the garment's upward direction is up in its panel, so that warp and weft are where a tailor has them.
TEST(Develop, UpIsUp) {
  const DevelopedSurface developed = develop(cut_to_disks(test::cylinder(32, 24, 0.2, 1)));
  double low_y = 1e9, high_y = -1e9, low_v = 1e9, high_v = -1e9, v_of_low = 0, v_of_high = 0;
  for (size_t i = 0; i < developed.uv.size(); ++i) {
    const double y = developed.cut.position[i][1], v = developed.uv[i][1];
    if (y < low_y) v_of_low = v;
    if (y > high_y) v_of_high = v;
    low_y = std::min(low_y, y);
    high_y = std::max(high_y, y);
    low_v = std::min(low_v, v);
    high_v = std::max(high_v, v);
  }
  EXPECT_NEAR(v_of_high - v_of_low, high_y - low_y, 0.02 * (high_y - low_y));
  EXPECT_NEAR(high_v - low_v, high_y - low_y, 0.02 * (high_y - low_y));
}

/// Width and height of what holds the points.
Point2 extent_of(const std::vector<Point2>& points) {
  Point2 low{1e9, 1e9}, high{-1e9, -1e9};
  for (const Point2& p : points) {
    for (size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  return high - low;
}

// The threads of a cape that goes most of the way around hang along lines that fan out by more than half a turn: their
// mean as lines without a head is what runs across.
TEST(Develop, OfAWideCapeTheMiddleHangsDown) {
  constexpr double kHalf = 110 * std::numbers::pi / 180, kSlope = 0.5;
  CleanSurface cape = test::disk(61, 21);
  for (Point3& p : cape.position) {
    const double around = kHalf * (2 * p[0] - 1) / kSlope, down = 1 - 0.9 * p[1];
    p = {kSlope * down * std::sin(around), -std::sqrt(1 - kSlope * kSlope) * down, kSlope * down * std::cos(around)};
  }
  const DevelopedSurface developed = develop(cut_to_disks(cape));
  const Point2 extent = extent_of(developed.uv);
  EXPECT_NEAR(extent[0], 2, 0.05);
  EXPECT_NEAR(extent[1], 1 - std::cos(kHalf), 0.05);
}

// A tablecloth as modelling programs make it knows no up, and a square has no long side but rounding's: it lay askew,
// cut in two in an image that was a third empty, and its threads ended at all four hems. Where a corner is gone the
// diagonal is long, and just as wrong.
TEST(Develop, LevelClothLiesStraight) {
  for (const double degrees : {0.0, 20.0, 45.0}) {
    for (const double corner_at : {2.0, 1.6}) {  // of x + y
      CleanSurface sheet = test::disk(21, 21);
      const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
      for (Point3& p : sheet.position) {
        const double beyond = std::max(0.0, p[0] + p[1] - corner_at) * 0.45;
        p = {p[0] - beyond, p[1] - beyond, 0};
        p = {p[0] * c - p[1] * s, 0, -p[0] * s - p[1] * c};
      }
      const DevelopedSurface developed = develop(cut_to_disks(sheet));
      const Point2 size = extent_of(developed.uv);
      EXPECT_NEAR(size[0], 1, 1e-3) << degrees << ' ' << corner_at;
      EXPECT_NEAR(size[1], 1, 1e-3) << degrees << ' ' << corner_at;
    }
  }
}

// The middles of two triangles lie across the diagonal of their rectangle, which counted as the long way of a ribbon: a
// blanket of one face lay askew in an image twice its size, with teeth along all hems.
TEST(Develop, ARectangleOfTwoTrianglesLiesStraight) {
  for (const bool level : {true, false}) {
    for (const double length : {1.0, 1.4, 30.0}) {
      CleanSurface sheet = test::disk(2, 2);
      for (Point3& p : sheet.position) {
        p = level ? Point3{length * p[0], 0, -p[1]} : Point3{length * p[0], p[1], 0};
      }
      const DevelopedSurface developed = develop(cut_to_disks(sheet));
      const Point2 size = extent_of(developed.uv);
      EXPECT_NEAR(size[0] * size[1], length, 1e-3 * length) << level << ' ' << length;
    }
  }
}

// The optimiser reaches the closed form: a flat sheet, distorted, comes back isometric.
TEST(SymmetricDirichletTest, AFlatSheetComesBackIsometric) {
  const CleanSurface sheet = test::disk(15, 11);
  std::vector<Point2> uv;
  for (const Point3& p : sheet.position) {
    const double x = p[0] != 0 || p[1] != 0 ? p[0] : 0, y = p[1] + p[2];
    uv.push_back({2 * x + 0.3 * y * y, 0.4 * y + 0.1 * x});
  }
  if (area_twice(uv[sheet.triangle[0][0]], uv[sheet.triangle[0][1]], uv[sheet.triangle[0][2]]) < 0) {
    for (Point2& p : uv) p[0] = -p[0];
  }
  SymmetricDirichlet energy(sheet.position, sheet.triangle, {});
  const double start = energy.energy(uv);
  ASSERT_TRUE(std::isfinite(start));
  EXPECT_GT(start, 4.5);
  EXPECT_NEAR(energy.minimise(uv, 60, 1e-12), 4, 1e-9);
}

/// Places along a closed polygon, `steps` per side.
std::vector<Point2> along_polygon(const std::vector<Point2>& corner, uint32_t steps) {
  std::vector<Point2> target;
  for (size_t k = 0; k < corner.size(); ++k) {
    const Point2 &a = corner[k], &b = corner[(k + 1) % corner.size()];
    for (uint32_t i = 0; i < steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      target.push_back({a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t});
    }
  }
  return target;
}

void expect_closed_and_simple(const std::vector<Pixel>& pixel) {
  std::set<Pixel> seen;
  std::map<Pixel, size_t> diagonals;  // per cell
  for (size_t i = 0; i < pixel.size(); ++i) {
    const Pixel &a = pixel[i], &b = pixel[(i + 1) % pixel.size()];
    EXPECT_TRUE(seen.insert(a).second);
    EXPECT_EQ(std::max(std::abs(b[0] - a[0]), std::abs(b[1] - a[1])), 1);
    if (a[0] != b[0] && a[1] != b[1]) ++diagonals[{std::min(a[0], b[0]), std::min(a[1], b[1])}];
  }
  for (const auto& [cell, count] : diagonals) EXPECT_EQ(count, 1U);
}

// A seam has one number of steps for all its sides, so each side must find a way of exactly that many.
TEST(PixelChainTest, FindsAWayOfExactlyTheStepsOfTheSeam) {
  for (const uint32_t steps : {10U, 11U, 13U}) {
    const PixelChain chain = place_chain(along_polygon({{0.3, 9.6}, {10.3, 9.6}, {10.3, -0.4}, {0.3, -0.4}}, steps));
    ASSERT_EQ(chain.result, PixelChain::Result::found) << steps;
    ASSERT_EQ(chain.pixel.size(), 4 * steps);
    expect_closed_and_simple(chain.pixel);
  }
}

TEST(PixelChainTest, SaysThatThereAreTooFewSteps) {
  const PixelChain chain = place_chain(along_polygon({{0, 60}, {60, 60}, {60, 0}, {0, 0}}, 40));
  EXPECT_EQ(chain.result, PixelChain::Result::too_short);
}

// The two sides of a cut that did not open lie at one place in the plane: their pixels have to part.
TEST(PixelChainTest, TheTwoSidesOfAClosedSlitPart) {
  const PixelChain chain =
      place_chain(along_polygon({{0, 30}, {15, 30}, {15, 10}, {15, 30}, {30, 30}, {30, 0}, {0, 0}}, 30));
  ASSERT_EQ(chain.result, PixelChain::Result::found);
  expect_closed_and_simple(chain.pixel);
}

// A scrap of half a pixel with thirty samples around it takes the room that they need.
TEST(PixelChainTest, AScrapSmallerThanAPixelFindsRoom) {
  const PixelChain chain = place_chain(along_polygon({{0, 0.7}, {0.7, 0.7}, {0.7, 0}}, 10));
  ASSERT_EQ(chain.result, PixelChain::Result::found);
  ASSERT_EQ(chain.pixel.size(), 30U);
  expect_closed_and_simple(chain.pixel);
}

// The outline of a net whose threads are far narrower than a pixel: it is given up before minutes are spent on it.
TEST(PixelChainTest, TriesNothingWhereThereAreFewerPixelsThanSamples) {
  const PixelChain chain = place_chain(along_polygon({{0, 4}, {4, 4}, {4, 0}, {0, 0}}, 500));
  EXPECT_EQ(chain.result, PixelChain::Result::crowded);
  EXPECT_TRUE(chain.pixel.empty());
}

TEST(PixelChainTest, KeepsSamplesApart) {
  const std::vector<Point2> target = along_polygon({{0, 1}, {20, 1}, {20, 0}, {0, 0}}, 20);  // one cell high
  const PixelChain chain = place_chain(target, std::vector<ApartSamples>{{10, 50, 2}});
  ASSERT_EQ(chain.result, PixelChain::Result::found);
  expect_closed_and_simple(chain.pixel);
  EXPECT_GE(std::abs(chain.pixel[10][0] - chain.pixel[50][0]) + std::abs(chain.pixel[10][1] - chain.pixel[50][1]), 2);
}

// Both ends of a seam and its corners are samples, and no step is lost or gained for that.
TEST(SeamMeasureTest, StepsEndOnTheMarks) {
  const SeamMeasure seam{{0, 3.3, 10}, {3.3}};
  for (const uint32_t steps : {2U, 7U, 10U, 13U}) {
    const std::vector<double> at = spread_steps(seam, steps);
    ASSERT_EQ(at.size(), steps + 1);
    EXPECT_EQ(at.front(), 0);
    EXPECT_EQ(at.back(), 10);
    EXPECT_TRUE(std::is_sorted(at.begin(), at.end()));
    EXPECT_NE(std::find(at.begin(), at.end(), 3.3), at.end()) << steps;
  }
  EXPECT_EQ(spread_steps(seam, 1), (std::vector<double>{0, 10}));
}

TEST(SeamMeasureTest, ASquareTurnsAtItsCornersAndARoundNeckNowhere) {
  EXPECT_EQ(sharp_turns(std::vector<Point2>{{0, 0}, {4, 0}, {8, 0}, {8, 8}, {4, 8}}), (std::vector<uint32_t>{2, 3}));
  std::vector<Point2> round;
  for (int i = 0; i <= 60; ++i) round.push_back({10 * std::cos(i * 0.05), 10 * std::sin(i * 0.05)});
  EXPECT_TRUE(sharp_turns(round).empty());
}

/// A polygon of so many corners about a circle.
std::vector<Point2> round_outline(const Point2& middle, double radius, int corners) {
  std::vector<Point2> outline;
  for (int i = 0; i < corners; ++i) {
    const double a = 2 * std::acos(-1.0) * i / corners;
    outline.push_back({middle[0] + radius * std::cos(a), middle[1] + radius * std::sin(a)});
  }
  return outline;
}

uint32_t columns_met(std::span<const Point2> outline, double shift) {
  long low = 1000, high = -1000;
  for (const Point2& p : outline) {
    low = std::min(low, std::lround(p[0] + shift));
    high = std::max(high, std::lround(p[0] + shift));
  }
  return static_cast<uint32_t>(high - low + 1);
}

// A row and a column more are more than one per cent of a usual image, all of it empty for a round skirt.
TEST(LatticeShift, ARoundChartTakesUpNoMoreColumnsThanItNeeds) {
  for (const double at : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    const std::vector<Point2> outline = round_outline({100 + at, 100}, 70.3, 400);  // 140.6 wide
    EXPECT_EQ(columns_met(outline, shift_to_lattice(outline)[0]), 141U) << at;
  }
}

// Pixels beside a straight side make it a staircase, or the cloth wider than it is.
TEST(LatticeShift, StraightSidesComeToLieOnPixels) {
  std::vector<Point2> outline;
  for (int i = 0; i < 40; ++i) outline.push_back({i + 0.25, 0.3125});
  for (int i = 0; i < 20; ++i) outline.push_back({40.25, i + 0.3125});
  for (int i = 40; i > 0; --i) outline.push_back({i + 0.25, 20.3125});
  for (int i = 20; i > 0; --i) outline.push_back({0.25, i + 0.3125});
  const Point2 shift = shift_to_lattice(outline);
  EXPECT_DOUBLE_EQ(shift[0], 0.75);
  EXPECT_DOUBLE_EQ(shift[1], 0.6875);
}

/// A flat sheet, as wide at its top as the share of its foot says.
CleanSurface trapezoid(double top) {
  CleanSurface s = test::disk(9, 9);
  for (Point3& p : s.position) p = {p[0] * (1 - (1 - top) * p[1]), p[1], 0};
  return s;
}

double utilisation_of(const FlatSurface& flat) {
  const ClothAsset asset = build_image(flat, rasterize(flat), Layout::panels);
  return count_valid_pixels(asset) / (1.0 * flat.width * flat.height);
}

// Whether an image's last row holds a whole side or a single pixel is the spacing's doing, and nobody asked for that
// one to a tenth of a per cent: of images that lack a hair of being well filled some used to be left so.
TEST(Panels, ImagesThatLackLittleOfBeingWellFilledAreFilledBetter) {
  constexpr double kEnough = 0.75;
  int mended = 0;
  for (double top = 0.44; top < 0.5; top += 0.01) {
    const DevelopedSurface developed = develop(cut_to_disks(trapezoid(top)));
    const double area = (1 + top) / 2, border = 2 + top + std::hypot(1, 1 - top);
    constexpr double kWanted = 64 * 64;
    const double spacing = 2 * area / (-border / 2 + std::sqrt(border * border / 4 + 4 * area * kWanted));
    const FlatSurface asked = lay_out_developed(developed, {.spacing = spacing}, {});
    const FlatSurface found = lay_out_developed(developed, {.resolution = 64}, {});
    const double before = utilisation_of(asked), after = utilisation_of(found);
    EXPECT_NEAR(found.charts[0].spacing, spacing, 0.012 * spacing) << top;
    if (before >= kEnough || after < kEnough) {
      EXPECT_EQ(after, before) << top;
    } else {
      ++mended;
    }
  }
  EXPECT_GT(mended, 0);
}

// Cut nodes closer together than a pixel leave springs of no length: they are given some, copies stay one point.
// Samples along both sides of a belt of two triangles made slivers of its length: time and memory grew with the square
// of it, and a mesh with one vertex far away took all there was.
TEST(Panels, ALongStripOfFewTrianglesIsDivided) {
  CleanSurface strip;
  strip.position = {{0, 0, 0}, {400, 0, 0}, {400, 1, 0}, {0, 1, 0}};
  strip.triangle = {{0, 1, 2}, {0, 2, 3}};
  strip.point = {0, 1, 2, 3};
  strip.point_count = 4;
  strip.component = {0, 0};
  strip.component_count = 1;
  strip.source_triangle = {0, 1};
  const FlatSurface flat = flatten_panels(strip, 64);
  ASSERT_EQ(flat.charts.size(), 1U);
  EXPECT_GT(std::max(flat.charts[0].width, flat.charts[0].height), 1000U);
  double longest = 0;
  for (const Triangle& t : flat.triangle) {
    for (size_t i = 0; i < 3; ++i) {
      const Point2 &a = flat.uv[t[i]], &b = flat.uv[t[(i + 1) % 3]];
      longest = std::max(longest, std::hypot(b[0] - a[0], b[1] - a[1]));
    }
  }
  EXPECT_LE(longest, 410);
}

TEST(LimitSprings, SpringsKeepALengthAndCopiesStayTogether) {
  ClothAsset asset;
  asset.width = 4;
  asset.height = 2;
  asset.spacing = 1;
  asset.chart_count = 1;
  asset.chart.assign(8, 0);
  asset.rest_position = {{0, 0, 0}, {1, 0, 0}, {1.01F, 0, 0}, {2, 0, 0},
                         {0, 1, 0}, {1, 1, 0}, {1.01F, 0, 0}, {2, 1, 0}};
  asset.spring_mask.assign(8, 0);
  for (const uint32_t i : {0U, 1U, 2U}) asset.spring_mask[i] = kSpringRight;
  asset.splits.offset = {0, 2};
  asset.splits.pixel = {2, 6};
  limit_springs(asset);
  EXPECT_GT(asset.rest_position[2].x - asset.rest_position[1].x, 0.3F);
  EXPECT_EQ(asset.rest_position[2], asset.rest_position[6]);
  EXPECT_EQ(asset.rest_position[4], (Vec3{0, 1, 0}));
}

// A strip one cell wide whose sides are two sides of one seam: its rungs would join copies of one point.
TEST(ChainConflicts, ASeamSewnToItselfAcrossOneCellIsFound) {
  PointChain strip;
  for (int32_t x = 0; x <= 4; ++x) strip.pixel.push_back({x, 1});
  for (int32_t x = 4; x >= 0; --x) strip.pixel.push_back({x, 0});
  strip.point = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  EXPECT_TRUE(chain_conflicts(std::vector<PointChain>{strip}).empty());
  strip.point = {0, 1, 2, 3, 4, 5, 3, 2, 1, 6};
  const std::vector<ChainConflict> conflicts = chain_conflicts(std::vector<PointChain>{strip});
  ASSERT_FALSE(conflicts.empty());
  EXPECT_EQ(conflicts[0].chart, 0U);
}

// A single cell both of whose diagonals exist elsewhere could only be filled by half.
TEST(ChainConflicts, ACellWithoutADiagonalIsFound) {
  const PointChain cell{{{0, 1}, {1, 1}, {1, 0}, {0, 0}}, {0, 1, 2, 3}};
  const PointChain other{{{0, 2}, {1, 2}, {2, 1}, {2, 0}, {1, 0}, {0, 1}}, {0, 2, 10, 1, 3, 11}};
  EXPECT_TRUE(chain_conflicts(std::vector<PointChain>{cell}).empty());
  bool found = false;
  for (const ChainConflict& c : chain_conflicts(std::vector<PointChain>{cell, other})) found = found || c.chart == 0;
  EXPECT_TRUE(found);
}

}  // namespace
}  // namespace geocloth
