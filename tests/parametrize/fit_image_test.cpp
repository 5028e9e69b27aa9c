// SPDX-License-Identifier: GPL-3.0-or-later
// What a fitted image promises: nearer to the surface by what theory says, diagonals along folds, flat cloth as it was.
#include "fit/fit_image.h"

#include <gtest/gtest.h>

#include "fit/mend_far.h"
#include "flat_builder.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/quality.h"
#include "image/limit_springs.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

using test::FlatBuilder;

/// A square of n x n pixels whose mesh has `finer` edges per pixel: a surface that is curved between the pixels.
FlatBuilder fine_square(uint32_t n, uint32_t finer, const FlatBuilder::Shape& shape) {
  FlatBuilder b;
  const uint32_t side = (n - 1) * finer + 1;
  b.add_square(
      side, test::apart(), [&](double u, double v) { return shape(u / finer, v / finer); }, 0);
  for (Point2& uv : b.flat.uv) uv = {uv[0] / finer, uv[1] / finer};
  FlatChart& chart = b.flat.charts[0];
  chart.width = chart.height = b.flat.width = b.flat.height = n;
  std::vector<OutlineSample> outline;
  for (const OutlineSample& s : chart.outline) {
    if (s.x % finer == 0 && s.y % finer == 0) outline.push_back({s.x / finer, s.y / finer, s.vertex});
  }
  chart.outline = outline;
  return b;
}

struct Images {
  Raster raster;
  ClothAsset sampled, fitted;
};
/// In panels pixels slide.
Images images_of(const FlatBuilder& b, Layout layout = Layout::square) {
  Images images;
  images.raster = rasterize(b.flat);
  images.sampled = build_image(b.flat, images.raster, layout);
  images.fitted = images.sampled;
  fit_image(b.flat, images.raster, images.fitted);
  return images;
}

TEST(FitImage, ErrorOfACurvedSheetFallsAsTheorySays) {
  constexpr uint32_t kPixels = 33;
  constexpr double kCurvature = 0.02;  // f'' h^2, in pixels
  const FlatBuilder b = fine_square(kPixels, 8, [](double u, double v) {
    return Point3{u, -v, kCurvature / 2 * (u - 16) * (u - 16)};
  });
  const Images images = images_of(b);
  const double diagonal = bounding_diagonal(b.clean.position);
  const double before = measure_quality(b.clean, b.flat, images.raster, images.sampled).rms_error * diagonal;
  const double after = measure_quality(b.clean, b.flat, images.raster, images.fitted).rms_error * diagonal;
  EXPECT_NEAR(before / kCurvature, 0.0913, 0.005);
  EXPECT_NEAR(after / kCurvature, 0.0373, 0.003);
}

TEST(FitImage, DiagonalsLieAlongFolds) {
  for (const bool left : {false, true}) {
    const FlatBuilder b = fine_square(17, 4, [=](double u, double v) {
      const double across = left ? u + v - 16 : u - v;
      return Point3{u, -v, 0.02 * across * across};
    });
    const ClothAsset asset = images_of(b).fitted;
    for (uint32_t y = 1; y + 2 < 17; ++y) {
      for (uint32_t x = 1; x + 2 < 17; ++x) {
        EXPECT_EQ((asset.cell[y * 17 + x] & kCellDiagonalLeft) != 0, left) << x << ' ' << y;
      }
    }
  }
}

TEST(FitImage, FlatClothStaysAsItWas) {
  const Images images = images_of(fine_square(17, 3, [](double u, double v) { return Point3{u / 4, -v / 4, 0}; }));
  EXPECT_EQ(images.fitted.cell, images.sampled.cell);
  for (uint32_t i = 0; i < images.fitted.pixel_count(); ++i) {
    EXPECT_LT(length(images.fitted.rest_position[i] - images.sampled.rest_position[i]), 1e-6F);
  }
}

TEST(FitImage, CopiesStayTheSameBitsAndNothingElseChanges) {
  const Images images = images_of(test::tube(17));
  const ClothAsset &before = images.sampled, &after = images.fitted;
  ASSERT_GT(after.splits.rows(), 0U);
  bool moved = false;
  for (uint32_t row = 0; row < after.splits.rows(); ++row) {
    const uint32_t a = after.splits.pixel[after.splits.offset[row]],
                   b = after.splits.pixel[after.splits.offset[row] + 1];
    EXPECT_EQ(after.rest_position[a].x, after.rest_position[b].x);
    EXPECT_EQ(after.rest_position[a].y, after.rest_position[b].y);
    EXPECT_EQ(after.rest_position[a].z, after.rest_position[b].z);
    moved = moved || after.rest_position[a].x != before.rest_position[a].x;
  }
  EXPECT_TRUE(moved);
  EXPECT_EQ(after.spring_mask, before.spring_mask);
  EXPECT_EQ(after.chart, before.chart);
  EXPECT_EQ(after.splits.pixel, before.splits.pixel);
  for (const SeamBend& bend : after.seam_bends) {
    EXPECT_EQ(bend.rest_length, length(after.rest_position[bend.b] - after.rest_position[bend.a]));
  }
}

TEST(FitImage, AFoldNarrowerThanAPixelDoesNotPullSpringsApart) {
  const FlatBuilder b = fine_square(17, 8, [](double u, double v) {
    return Point3{u, -v, 3 * std::exp(-16 * (u - 8.3) * (u - 8.3))};
  });
  const Images images = images_of(b);
  for (uint32_t i = 0; i < images.fitted.pixel_count(); ++i) {
    if ((images.fitted.spring_mask[i] & kSpringRight) == 0) continue;
    const auto spring = [&](const ClothAsset& asset) {
      return length(asset.rest_position[i + 1] - asset.rest_position[i]);
    };
    EXPECT_GE(spring(images.fitted), 0.599F * spring(images.sampled));
    EXPECT_LE(spring(images.fitted), 1.501F * spring(images.sampled));
  }
}

/// A roof whose ridge runs between two columns of pixels.
FlatBuilder roof() {
  return fine_square(33, 10, [](double u, double v) {
    constexpr double kCosine = 0.8, kSine = 0.6;
    return Point3{kCosine * u, -v, -kSine * std::abs(u - 16.15)};
  });
}

TEST(FitImage, PixelsOfPanelsSlideToFolds) {
  const FlatBuilder b = roof();
  const Images panels = images_of(b, Layout::panels);
  const auto rms = [&](const ClothAsset& asset) {
    return measure_quality(b.clean, b.flat, panels.raster, asset).rms_error;
  };
  EXPECT_LT(rms(panels.fitted), 0.3 * rms(panels.sampled));
}

TEST(FitImage, SpringsOfPanelsThatSlideStayEvenAndAtRightAngles) {
  const FlatBuilder b = roof();
  const Images panels = images_of(b, Layout::panels);
  const Quality q = measure_quality(b.clean, b.flat, panels.raster, panels.fitted);
  EXPECT_LE(q.spring_p99_over_p1, 1.5);
  EXPECT_LE(q.shear_deg_p95, 6);
}

TEST(FitImage, FreeBordersOfPanelsStayWhereTheyAre) {
  const FlatBuilder b = roof();
  const Images panels = images_of(b, Layout::panels);
  for (const OutlineSample& s : b.flat.charts[0].outline) {
    const uint32_t i = s.y * panels.fitted.width + s.x;
    const Vec3 way = panels.fitted.rest_position[i] - panels.sampled.rest_position[i];
    const bool upright = s.x == 0 || s.x + 1 == panels.fitted.width;
    EXPECT_LT(std::abs(upright ? way.x : way.y), 0.01F) << s.x << ' ' << s.y;
  }
}

TEST(FitImage, UnevenAndAskewSpringsOfPanelsAreMended) {
  FlatBuilder b;
  constexpr uint32_t kSide = 49;
  const auto bent = [](double x) { return x + 0.2 * std::sin(x * 1.3); };
  b.add_square(kSide, test::apart(), [&](double u, double v) {
    return Point3{bent(u) + 0.107 * bent(v), -bent(v), 0};
  });
  const Images panels = images_of(b, Layout::panels);
  const auto quality = [&](const ClothAsset& asset) { return measure_quality(b.clean, b.flat, panels.raster, asset); };
  const Quality before = quality(panels.sampled), after = quality(panels.fitted);
  EXPECT_GT(before.spring_p99_over_p1, 1.6);
  EXPECT_GT(before.shear_deg_p95, 6.2);
  EXPECT_LE(after.spring_p99_over_p1, 1.5);
  EXPECT_LE(after.shear_deg_p95, 6);
}

/// A flat sheet that is squeezed along two columns of cells.
FlatBuilder squeezed() {
  return fine_square(49, 4, [](double u, double v) {
    const auto in = [&](double column) { return std::clamp(u - column, 0.0, 1.0); };
    return Point3{u - 0.4 * (in(12) + in(35)), -v, 0};
  });
}

// The springs there become longer; it was all others that were shortened as well.
TEST(FitImage, AFewShortSpringsDoNotShortenTheOthers) {
  const FlatBuilder b = squeezed();
  const Images panels = images_of(b, Layout::panels);
  const auto quality = [&](const ClothAsset& asset) { return measure_quality(b.clean, b.flat, panels.raster, asset); };
  const Quality before = quality(panels.sampled), after = quality(panels.fitted);
  EXPECT_GT(before.spring_p99_over_p1, 1.6);
  EXPECT_LE(after.spring_p99_over_p1, 1.5);
  const auto mean = [&](const ClothAsset& asset) {
    float sum = 0;
    for (uint32_t y = 0; y < 49; ++y)
      sum += length(asset.rest_position[y * 49 + 30] - asset.rest_position[y * 49 + 18]);
    return sum / (49 * 12);
  };
  EXPECT_NEAR(mean(panels.fitted), mean(panels.sampled), 0.005F);
}

TEST(LimitSprings, SpringsAcrossAFoldThatLiesFlatGetALength) {
  const FlatBuilder b = fine_square(17, 1, [](double u, double v) { return Point3{u, -v, 0}; });
  ClothAsset asset = images_of(b, Layout::panels).sampled;
  for (Vec3& p : asset.rest_position) p.x = std::abs(p.x - 8.5F);
  limit_springs(asset);
  for (uint32_t y = 0; y < 17; ++y) {
    EXPECT_GE(length(asset.rest_position[y * 17 + 9] - asset.rest_position[y * 17 + 8]), 0.3F);
  }
}

/// A flat sheet with a cone whose tip lies in the middle of a cell, or of an edge of the sheet.
FlatBuilder cone(double tip_v = 16.5) {
  return fine_square(33, 4, [=](double u, double v) {
    return Point3{u, -v, std::max(0.0, 0.8 - 0.5 * std::hypot(u - 16.5, v - tip_v))};
  });
}

void expect_tip_is_reached(const FlatBuilder& b, double off_before) {
  const ClothAsset sampled = images_of(b, Layout::panels).sampled;
  const Raster raster = rasterize(b.flat);
  ClothAsset mended = sampled;
  mend_far_places(b.flat, raster, {}, mended);
  const Quality before = measure_quality(b.clean, b.flat, raster, sampled);
  const Quality after = measure_quality(b.clean, b.flat, raster, mended);
  EXPECT_GT(before.max_error, off_before);
  EXPECT_LE(after.max_error, 2e-3);
  EXPECT_GE(after.spring_min, 0.3);
  EXPECT_LE(after.spring_max, 2);
}

TEST(MendFar, ATipBetweenPixelsIsReachedWithinTheLimitsOfSprings) {
  expect_tip_is_reached(cone(), 5e-3);
}

TEST(MendFar, ATipOfAHemIsReachedToo) {
  expect_tip_is_reached(cone(0), 4e-3);
}

// The cloth is near the image everywhere, and yet the image is not near the cloth.
TEST(MendFar, APixelBeyondTheHemIsTakenBack) {
  const FlatBuilder b = cone();
  ClothAsset mended = images_of(b, Layout::panels).sampled;
  mended.rest_position[8].y += 0.45F;
  const Raster raster = rasterize(b.flat);
  EXPECT_GT(measure_quality(b.clean, b.flat, raster, mended).max_error, 5e-3);
  mend_far_places(b.flat, raster, {}, mended);
  EXPECT_LT(mended.rest_position[8].y, 0.12F);
  EXPECT_LE(measure_quality(b.clean, b.flat, raster, mended).max_error, 2e-3);
}

TEST(MendFar, OnlyPixelsBesideThePlaceMove) {
  const FlatBuilder b = cone();
  const ClothAsset sampled = images_of(b, Layout::panels).sampled;
  ClothAsset mended = sampled;
  mend_far_places(b.flat, rasterize(b.flat), {}, mended);
  bool moved = false;
  for (uint32_t y = 0; y < 33; ++y) {
    for (uint32_t x = 0; x < 33; ++x) {
      const Vec3 &before = sampled.rest_position[y * 33 + x], &after = mended.rest_position[y * 33 + x];
      const bool same = before.x == after.x && before.y == after.y && before.z == after.z;
      moved = moved || !same;
      const bool is_beside = std::hypot(x - 16.5, y - 16.5) < 6;
      EXPECT_TRUE(same || is_beside) << x << ' ' << y;
    }
  }
  EXPECT_TRUE(moved);
}

}  // namespace
}  // namespace geocloth
