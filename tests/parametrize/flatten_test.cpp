// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/flatten.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/seams.h"
#include "parametrize/clean_surfaces.h"
#include "parametrize/same_topology.h"

namespace geocloth {
namespace {

using test::expect_same_topology;
using test::over_points;

FlatSurface flatten_square(const CleanSurface& surface, uint32_t resolution) {
  return flatten(surface, cut_to_disks(surface), {.layout = Layout::square, .resolution = resolution});
}

class Flatten : public ::testing::TestWithParam<test::NamedSurface> {
 protected:
  const CleanSurface surface_ = GetParam().make();
  const FlatSurface flat_ = flatten_square(surface_, 40);
};

// A flipped triangle would put two places of the garment on one pixel.
TEST_P(Flatten, NoTriangleIsFlipped) {
  for (const auto& [a, b, c] : flat_.triangle) {
    const Point2 &p = flat_.uv[a], &q = flat_.uv[b], &r = flat_.uv[c];
    EXPECT_LT((q[0] - p[0]) * (r[1] - p[1]) - (r[0] - p[0]) * (q[1] - p[1]), 0);  // v runs down
  }
}

// The sampled surface is still the garment: nothing lost, nothing moved, nothing torn.
TEST_P(Flatten, SurfaceIsKept) {
  const CleanSurface& clean = surface_;
  expect_same_topology(measure_topology(over_points(flat_.triangle, flat_.point), flat_.point_count),
                       measure_topology(over_points(clean.triangle, clean.point), clean.point_count));
  std::map<uint32_t, Point3> place;
  for (size_t v = 0; v < flat_.position.size(); ++v) {
    EXPECT_EQ(place.try_emplace(flat_.point[v], flat_.position[v]).first->second, flat_.position[v]);
    if (flat_.clean_vertex[v] != kNone) {
      EXPECT_EQ(flat_.position[v], clean.position[flat_.clean_vertex[v]]);
      EXPECT_EQ(flat_.point[v], clean.point[flat_.clean_vertex[v]]);
    }
  }
  ASSERT_EQ(flat_.clean_triangle.size(), flat_.triangle.size());
  for (const uint32_t t : flat_.clean_triangle) EXPECT_LT(t, clean.triangle.size());
}

// Outline pixels are the garment's border and seams: each must be sampled once, in order, exactly.
TEST_P(Flatten, EveryOutlinePixelIsSampled) {
  for (const FlatChart& chart : flat_.charts) {
    ASSERT_GE(std::min(chart.width, chart.height), 4U);
    ASSERT_EQ(chart.outline.size(), 2 * (chart.width + chart.height) - 4);
    std::set<std::pair<uint32_t, uint32_t>> seen;
    for (size_t i = 0; i < chart.outline.size(); ++i) {
      const OutlineSample& s = chart.outline[i];
      const OutlineSample& next = chart.outline[(i + 1) % chart.outline.size()];
      EXPECT_TRUE(s.x == 0 || s.y == 0 || s.x == chart.width - 1 || s.y == chart.height - 1);
      EXPECT_TRUE(seen.insert({s.x, s.y}).second);
      EXPECT_EQ(flat_.uv[s.vertex], (Point2{static_cast<double>(s.x), static_cast<double>(s.y)}));
      EXPECT_EQ(std::abs(static_cast<int>(s.x) - static_cast<int>(next.x)) +
                    std::abs(static_cast<int>(s.y) - static_cast<int>(next.y)),
                1);
      EXPECT_NE(flat_.point[s.vertex], flat_.point[next.vertex]);
      const OutlineSample& before = chart.outline[(i + chart.outline.size() - 1) % chart.outline.size()];
      const bool corner = (s.x == 0 || s.x == chart.width - 1) && (s.y == 0 || s.y == chart.height - 1);
      EXPECT_TRUE(!corner || flat_.point[before.vertex] != flat_.point[next.vertex]) << "cut end on a corner";
    }
  }
}

// Charts must not share pixels, nor touch: a spring would join what lies side by side by chance.
TEST_P(Flatten, ChartsAreApart) {
  for (size_t i = 0; i < flat_.charts.size(); ++i) {
    const FlatChart& a = flat_.charts[i];
    EXPECT_LE(a.x0 + a.width, flat_.width);
    EXPECT_LE(a.y0 + a.height, flat_.height);
    for (size_t k = i + 1; k < flat_.charts.size(); ++k) {
      const FlatChart& b = flat_.charts[k];
      EXPECT_TRUE(a.x0 + a.width < b.x0 || b.x0 + b.width < a.x0 || a.y0 + a.height < b.y0 || b.y0 + b.height < a.y0);
    }
  }
}

// What the solver simulates, the grid with its copies merged, is the garment to a topologist.
TEST_P(Flatten, WeldedGridIsTheGarment) {
  const CleanSurface& clean = surface_;
  const ClothAsset asset = build_image(flat_, rasterize(flat_), Layout::square);
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  expect_same_topology(measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size())),
                       measure_topology(over_points(clean.triangle, clean.point), clean.point_count));
}

TEST_P(Flatten, IsDeterministic) {
  const FlatSurface again = flatten_square(surface_, 40);
  EXPECT_EQ(again.uv, flat_.uv);
  EXPECT_EQ(again.triangle, flat_.triangle);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Flatten, ::testing::ValuesIn(test::surfaces_of_every_topology()),
                         [](const auto& test) { return test.param.name; });

uint64_t pixels(const FlatSurface& flat) {
  uint64_t sum = 0;
  for (const FlatChart& chart : flat.charts) sum += uint64_t{chart.width} * chart.height;
  return sum;
}

// Users choose how many particles they pay for.
TEST(FlattenOptionsTest, ResolutionIsTheNumberOfPixels) {
  for (const uint32_t resolution : {32U, 64U, 100U}) {
    const auto count = static_cast<double>(pixels(flatten_square(test::shirt(6), resolution)));
    EXPECT_NEAR(count / (resolution * resolution), 1, 0.1) << resolution;
  }
}

TEST(FlattenOptionsTest, SpacingIsTheSpringLength) {
  const CleanSurface surface = test::cylinder(40, 30);
  const FlatSurface flat = flatten(surface, cut_to_disks(surface), {.layout = Layout::square, .spacing = 0.05});
  EXPECT_NEAR(flat.charts[0].spacing, 0.05, 0.005);
}

TEST(FlattenOptionsTest, NonsenseIsRefused) {
  const CleanSurface surface = test::disk(4, 4);
  const CutSurface cut = cut_to_disks(surface);
  const auto flatten_with = [&](const FlattenOptions& options) { (void)flatten(surface, cut, options); };
  EXPECT_THROW(flatten_with({.resolution = 7}), Error);
  EXPECT_THROW(flatten_with({.resolution = 4097}), Error);
  EXPECT_THROW(flatten_with({.spacing = -1}), Error);
  EXPECT_THROW(flatten_with({.spacing = std::nan("")}), Error);
  EXPECT_THROW(flatten_with({.layout = Layout::square, .spacing = 1e-9}), Error);
}

// A spacing in the wrong unit was tried for minutes, and the memory of that many pixels with it.
TEST(FlattenOptionsTest, ASpacingThatNoImageHasRoomForIsRefusedWithOneThatHas) {
  const CleanSurface surface = test::disk(9, 9);
  for (const Layout layout : {Layout::panels, Layout::square}) {
    try {
      static_cast<void>(flatten(surface, cut_to_disks(surface), {.layout = layout, .spacing = 1e-5}));
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      EXPECT_NE(std::string(e.what()).find("raise the spacing to 0.000"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace geocloth
