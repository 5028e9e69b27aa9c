// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/rasterize.h"

#include <gtest/gtest.h>

#include "flat_builder.h"
#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

using test::FlatBuilder;

double distance(const Point3& a, const Point3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(Rasterize, SamplesAFlatSheetAtItsPixels) {
  for (const double jitter : {0.0, 0.2}) {  // without jitter every pixel is a vertex of six triangles
    const FlatBuilder b = test::sheet(17, 2, jitter);
    const Raster raster = rasterize(b.flat);
    EXPECT_TRUE(raster.overlapping.empty());
    for (uint32_t y = 0; y < 17; ++y) {
      for (uint32_t x = 0; x < 17; ++x) {
        const uint32_t i = y * 17 + x;
        ASSERT_EQ(raster.chart[i], 0);
        ASSERT_NE(raster.triangle[i], kNone);
        EXPECT_LT(distance(raster.position[i], {x * 2.0 / 16, -(y * 2.0 / 16), 0}), 1e-14) << x << ' ' << y;
      }
    }
  }
}

TEST(Rasterize, OutlinePixelsAreTheirVertexBitForBit) {
  FlatBuilder b = test::tube(9);
  for (Point3& p : b.flat.position) p[0] += 1.0 / 3;
  const Raster raster = rasterize(b.flat);
  for (const OutlineSample& s : b.flat.charts[0].outline) {
    const uint32_t i = s.y * 9 + s.x;
    EXPECT_EQ(raster.position[i], b.flat.position[s.vertex]);
    EXPECT_EQ(raster.point[i], b.flat.point[s.vertex]);
    EXPECT_EQ(raster.vertex[i], s.vertex);
  }
  EXPECT_EQ(raster.point[4 * 9 + 4], kNone);
}

TEST(Rasterize, ASliverThatRunsThroughPixelsLeavesNoGapAndNoOverlap) {
  // Two triangles over a whole square: the diagonal passes exactly through the pixels (k, k).
  FlatBuilder b = test::sheet(9);
  b.flat.triangle = {{0, 72, 80}, {0, 80, 8}};
  b.flat.chart = {0, 0};
  const Raster raster = rasterize(b.flat);
  EXPECT_TRUE(raster.overlapping.empty());
  for (const uint16_t c : raster.chart) EXPECT_EQ(c, 0);
}

TEST(Rasterize, CountsPixelsThatAChartCoversTwice) {
  FlatBuilder b = test::sheet(9);
  b.flat.triangle.push_back({0, 72, 80});
  b.flat.chart.push_back(0);
  EXPECT_GT(rasterize(b.flat).overlapping.size(), 10U);
}

TEST(Rasterize, CountsPixelsOfTwoCharts) {
  FlatBuilder b = test::fan(9, 2);
  b.flat.charts[1].x0 = 8;  // one column in common
  EXPECT_EQ(rasterize(b.flat).overlapping.size(), 9U);
}

TEST(Rasterize, RefusesAChartOutsideTheAtlas) {
  FlatBuilder b = test::sheet(9);
  b.flat.charts[0].x0 = 1;
  EXPECT_THROW(static_cast<void>(rasterize(b.flat)), Error);
}

TEST(Rasterize, ReportsProgressAndCanBeCancelled) {
  const FlatBuilder b = test::sheet(9);
  EXPECT_THROW(static_cast<void>(
                   rasterize(b.flat, [](std::string_view, double) { throw Error(ErrorCode::cancelled, "stopped"); })),
               Error);
}

}  // namespace
}  // namespace geocloth
