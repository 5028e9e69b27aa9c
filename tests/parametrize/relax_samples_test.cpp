// SPDX-License-Identifier: GPL-3.0-or-later
// Samples that slide along the surface: the grid becomes less askew in space, and nothing else changes.
#include "fit/relax_samples.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "flat_builder.h"
#include "geocloth/parametrize/quality.h"
#include "geocloth/parametrize/seams.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

using test::FlatBuilder;

constexpr uint32_t kSide = 33;

FlatBuilder square(double spacing, const FlatBuilder::Shape& shape) {
  FlatBuilder b;
  b.add_square(kSide, test::apart(), shape);
  b.flat.charts[0].spacing = spacing;
  return b;
}

/// A flat sheet whose map shears by up to 9 degrees around its middle.
FlatBuilder sheared() {
  return square(1, [](double u, double v) {
    const double r = (u - 16) * (u - 16) + (v - 16) * (v - 16);
    return Point3{u, -(v + 0.75 * std::exp(-r / 30)), 0};
  });
}

double skew_p95(const FlatBuilder& b, const Raster& raster) {
  return measure_quality(b.clean, b.flat, raster, build_image(b.flat, raster, Layout::panels)).shear_deg_p95;
}

TEST(RelaxSamples, AGridThatIsAskewInSpaceIsStraightened) {
  const FlatBuilder b = sheared();
  const Raster before = rasterize(b.flat);
  Raster after = before;
  relax_samples(b.flat, after);
  EXPECT_LT(skew_p95(b, after), 0.9 * skew_p95(b, before));
}

TEST(RelaxSamples, BesideAnOutlineThatRunsInWavesLengthsOrAnglesHold) {
  FlatBuilder b = square(1, [](double u, double v) { return Point3{u, -v, 0}; });
  for (const OutlineSample& s : b.flat.charts[0].outline) {
    const bool upright = s.x == 0 || s.x == kSide - 1, corner = upright && (s.y == 0 || s.y == kSide - 1);
    if (corner) continue;
    Point2& uv = b.flat.uv[s.vertex];
    uv[upright ? 0 : 1] += 0.4 * std::sin(upright ? s.y : s.x);
    b.flat.position[s.vertex] = {uv[0], -uv[1], 0};
  }
  const auto holds = [&](const Raster& raster) {
    const ClothAsset asset = build_image(b.flat, raster, Layout::panels);
    const Quality q = measure_quality(b.clean, b.flat, raster, asset);
    return std::pair(q.spring_p99_over_p1 <= 1.5, q.shear_deg_p95 <= 6);
  };
  const Raster before = rasterize(b.flat);
  Raster after = before;
  relax_samples(b.flat, after);
  EXPECT_EQ(holds(before), std::pair(false, false));
  const auto [even, straight] = holds(after);
  EXPECT_TRUE(even || straight);
}

TEST(RelaxSamples, SamplesStayOnTheSurfaceAndOutlinesWhereTheyAre) {
  const FlatBuilder b = sheared();
  const Raster before = rasterize(b.flat);
  Raster after = before;
  relax_samples(b.flat, after);
  bool moved = false;
  for (uint32_t i = 0; i < after.position.size(); ++i) {
    if (after.vertex[i] != kNone) {
      EXPECT_EQ(after.position[i], before.position[i]);
      continue;
    }
    moved = moved || after.position[i] != before.position[i];
    const Triangle& t = b.flat.triangle[after.triangle[i]];
    const Point3 weight =
        weights_in_space({b.flat.position[t[0]], b.flat.position[t[1]], b.flat.position[t[2]]}, after.position[i]);
    Point2 place{0, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_GE(weight[k], -1e-9);
      place = {place[0] + weight[k] * b.flat.uv[t[k]][0], place[1] + weight[k] * b.flat.uv[t[k]][1]};
    }
    EXPECT_NEAR(place[0], after.place[i][0], 1e-9);
    EXPECT_NEAR(place[1], after.place[i][1], 1e-9);
  }
  EXPECT_TRUE(moved);
}

TEST(RelaxSamples, AnIsometricMapStaysAsItIs) {
  const FlatBuilder b = square(1.0 / 3, [](double u, double v) { return Point3{u / 3, -v / 3, 0}; });
  const Raster before = rasterize(b.flat);
  Raster after = before;
  relax_samples(b.flat, after);
  EXPECT_EQ(after.position, before.position);
}

TEST(RelaxSamples, OneThreadGivesTheSameBits) {
  const FlatBuilder b = sheared();
  Raster many = rasterize(b.flat), one = many;
  relax_samples(b.flat, many);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  relax_samples(b.flat, one);
  EXPECT_EQ(one.position, many.position);
  EXPECT_EQ(one.triangle, many.triangle);
}

}  // namespace
}  // namespace geocloth
