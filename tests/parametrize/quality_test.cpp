// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/quality.h"

#include <gtest/gtest.h>

#include "flat_builder.h"

namespace geocloth {
namespace {

using test::FlatBuilder;

Quality quality_of(const FlatBuilder& b) {
  const Raster raster = rasterize(b.flat);
  return measure_quality(b.clean, b.flat, raster, build_image(b.flat, raster, Layout::square));
}

TEST(Quality, OfAFlatSheetIsPerfect) {
  const Quality q = quality_of(test::sheet(17, 3));
  EXPECT_EQ(q.flipped, 0U);
  EXPECT_EQ(q.mirrored, 0U);
  EXPECT_EQ(q.overlapping_pixels, 0U);
  EXPECT_EQ(q.crossing_springs, 0U);
  EXPECT_EQ(q.copy_gap, 0);
  EXPECT_NEAR(q.l2_stretch, 1, 1e-9);
  EXPECT_NEAR(q.symmetric_dirichlet, 4, 1e-9);
  EXPECT_NEAR(q.anisotropy_p95, 1, 1e-6);
  EXPECT_NEAR(q.spring_min, 1, 1e-5);
  EXPECT_NEAR(q.spring_max, 1, 1e-5);
  EXPECT_NEAR(q.spring_p99_over_p1, 1, 1e-5);
  EXPECT_NEAR(q.shear_deg_p95, 0, 1e-3);
  EXPECT_NEAR(q.quad_area_p5, 1, 1e-5);
  EXPECT_NEAR(q.quad_area_p95, 1, 1e-5);
  EXPECT_LT(q.max_error, 1e-7);
  EXPECT_GT(q.psnr_db, 120);
  EXPECT_EQ(q.seam_length, 0);
}

TEST(Quality, OfAStretchedSheetFollowsTheDefinitions) {
  FlatBuilder b = test::sheet(17);
  for (auto* positions : {&b.flat.position, &b.clean.position}) {
    for (Point3& p : *positions) p[0] *= 4;  // singular values 2 and 1/2 once areas agree
  }
  const Quality q = quality_of(b);
  EXPECT_NEAR(q.l2_stretch, std::sqrt((4 + 0.25) / 2), 1e-9);
  EXPECT_NEAR(q.symmetric_dirichlet, 2 * (4 + 0.25), 1e-9);
  EXPECT_NEAR(q.anisotropy_p95, 4, 1e-6);
  EXPECT_NEAR(q.spring_min, 0.5, 1e-5);
  EXPECT_NEAR(q.spring_max, 2, 1e-5);
  EXPECT_NEAR(q.quad_area_p5, 1, 1e-5);
}

TEST(Quality, OfAShearedSheetNamesTheAngle) {
  FlatBuilder b = test::sheet(17);
  for (auto* positions : {&b.flat.position, &b.clean.position}) {
    for (Point3& p : *positions) p[0] += p[1];  // warp at 45 degrees
  }
  EXPECT_NEAR(quality_of(b).shear_deg_p50, 45, 1e-3);
}

TEST(Quality, SeesFlippedTrianglesAndMirroredCharts) {
  FlatBuilder b = test::sheet(9);
  std::swap(b.flat.uv[4 * 9 + 4], b.flat.uv[4 * 9 + 6]);
  EXPECT_GT(quality_of(b).flipped, 0U);
  EXPECT_GT(quality_of(b).overlapping_pixels, 0U);
  FlatBuilder mirrored = test::sheet(9);
  for (Point2& uv : mirrored.flat.uv) uv[0] = 8 - uv[0];
  const Quality q = quality_of(mirrored);
  EXPECT_EQ(q.mirrored, 1U);
  EXPECT_EQ(q.flipped, mirrored.flat.triangle.size());
}

TEST(Quality, SeesSpringsThatLeaveTheirChart) {
  const FlatBuilder b = test::fan(9, 2);
  const Raster raster = rasterize(b.flat);
  ClothAsset asset = build_image(b.flat, raster, Layout::square);
  asset.spring_mask[8] = static_cast<uint8_t>(asset.spring_mask[8] | kSpringRight);  // into the chart beside
  EXPECT_EQ(measure_quality(b.clean, b.flat, raster, asset).crossing_springs, 1U);
}

TEST(Quality, SeesCopiesThatDoNotCoincide) {
  const FlatBuilder b = test::tube(9);
  const Raster raster = rasterize(b.flat);
  ClothAsset asset = build_image(b.flat, raster, Layout::square);
  asset.rest_position[9].y += 0.25F;
  EXPECT_NEAR(measure_quality(b.clean, b.flat, raster, asset).copy_gap, 0.25, 1e-6);
}

TEST(Quality, MeasuresTheDistanceFromTheSurface) {
  const FlatBuilder b = test::sheet(17);
  const Raster raster = rasterize(b.flat);
  ClothAsset asset = build_image(b.flat, raster, Layout::square);
  for (Vec3& p : asset.rest_position) p.z += 0.01F;
  const Quality q = measure_quality(b.clean, b.flat, raster, asset);
  EXPECT_NEAR(q.rms_error, 0.01 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(q.max_error, 0.01 / std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(q.psnr_db, 40 + 20 * std::log10(std::sqrt(2.0)), 1e-2);
}

TEST(Quality, CountsASeamOnce) {
  EXPECT_NEAR(quality_of(test::fan(9, 2)).seam_length, 1 / std::sqrt(2.0), 1e-6);  // length 1, area 2
}

TEST(Quality, IsTheSameEveryTime) {
  const FlatBuilder b = test::torus(17);
  const Quality first = quality_of(b), second = quality_of(b);
  EXPECT_EQ(first.rms_error, second.rms_error);
  EXPECT_EQ(first.max_error, second.max_error);
}

}  // namespace
}  // namespace geocloth
