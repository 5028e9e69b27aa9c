// SPDX-License-Identifier: GPL-3.0-or-later
// Fringes: strips narrower than a pixel that hang side by side have no room for two columns of pixels each. They become
// charts of their own; the cloth that they hang on stays one piece and keeps its shape.
#include "flatten/narrow_strips.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "develop/develop.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/flatten.h"
#include "geocloth/parametrize/quality.h"
#include "geocloth/parametrize/repair.h"
#include "parametrize/clean_surfaces.h"
#include "parametrize/same_topology.h"

namespace geocloth {
namespace {

constexpr uint32_t kStrips = 20, kAcross = 2 * kStrips + 1, kAlong = 31;
constexpr double kWidth = 1, kLength = 0.3;  // of the shawl and of its strips

/// A square shawl that hangs down from y = 1, with strips at its hem as wide as the gaps between them.
CleanSurface fringed_shawl() {
  CleanSurface sheet = test::disk(kAcross, kAlong, kWidth, 1);
  std::vector<uint32_t> hem;
  for (uint32_t v = 0; v < sheet.position.size(); ++v) {
    if (sheet.position[v][1] == 0) hem.push_back(v);
  }
  std::sort(hem.begin(), hem.end(),
            [&](uint32_t a, uint32_t b) { return sheet.position[a][0] < sheet.position[b][0]; });
  std::vector<Point3> position = sheet.position;
  std::vector<Triangle> triangle = sheet.triangle;
  for (uint32_t k = 0; k < kStrips; ++k) {
    uint32_t left = hem[2 * k], right = hem[2 * k + 1];
    for (uint32_t row = 1; row <= 4; ++row) {
      const auto below = static_cast<uint32_t>(position.size());
      for (const uint32_t v : {hem[2 * k], hem[2 * k + 1]}) {
        position.push_back({position[v][0], position[v][1] - kLength * row / 4, position[v][2]});
      }
      triangle.push_back({left, below, right});
      triangle.push_back({right, below, below + 1});
      left = below;
      right = below + 1;
    }
  }
  return repair_mesh(test::as_mesh(position, triangle), {}, {}).surface;
}

DevelopedSurface as_it_hangs(const CleanSurface& shawl) {
  DevelopedSurface developed{cut_to_disks(shawl), {}, {4}};
  for (const Point3& p : developed.cut.position) developed.uv.push_back({p[0], p[1]});
  return developed;
}

double area_in_plane(const DevelopedSurface& developed) {
  double area = 0;
  for (const auto& [a, b, c] : developed.cut.triangle) {
    area += signed_area(developed.uv[a], developed.uv[b], developed.uv[c]);
  }
  return area;
}

TEST(NarrowStrips, EveryStripOfAFringeIsCutOffAtItsRoot) {
  DevelopedSurface developed = as_it_hangs(fringed_shawl());
  const double area = area_in_plane(developed), spacing = 0.03;
  ASSERT_GT(area, 0);
  const size_t least = kStrips;
  ASSERT_TRUE(cut_off_strips(developed, std::span(&least, 1), spacing));
  EXPECT_EQ(developed.cut.component_count, kStrips + 1);
  EXPECT_NEAR(area_in_plane(developed), area, 1e-9 * area) << "cloth was lost or doubled";
  for (size_t t = 0; t < developed.cut.triangle.size(); ++t) {
    const bool hangs = std::any_of(developed.cut.triangle[t].begin(), developed.cut.triangle[t].end(),
                                   [&](uint32_t v) { return developed.cut.position[v][1] < -1e-9; });
    EXPECT_EQ(developed.cut.component[t] != 0, hangs);
  }
}

TEST(NarrowStrips, FewerThanAskedForAndWiderOnesStay) {
  const DevelopedSurface whole = as_it_hangs(fringed_shawl());
  DevelopedSurface developed = whole;
  const size_t more = kStrips + 1, any = 1;
  EXPECT_FALSE(cut_off_strips(developed, std::span(&more, 1), 0.03));
  EXPECT_FALSE(cut_off_strips(developed, std::span(&kNoStrips, 1), 0.03));
  EXPECT_FALSE(cut_off_strips(developed, std::span(&any, 1), 0.01)) << "strips are two and a half pixels wide";
  EXPECT_EQ(developed.uv, whole.uv);
}

TEST(NarrowStrips, AFringedShawlTakesAboutThePixelsAskedForAndKeepsItsShape) {
  const CleanSurface shawl = fringed_shawl();
  constexpr uint32_t kResolution = 32;  // a strip is two thirds of a pixel wide
  const FlatSurface flat =
      flatten(shawl, cut_to_disks(shawl), {.layout = Layout::panels, .resolution = kResolution}, {});
  EXPECT_EQ(flat.charts.size(), kStrips + size_t{1});
  EXPECT_TRUE(std::none_of(flat.charts.begin(), flat.charts.end(), [](const FlatChart& c) { return c.is_disk; }));
  const Raster raster = rasterize(flat);
  EXPECT_TRUE(raster.overlapping.empty());
  const ClothAsset asset = build_image(flat, raster, Layout::panels);
  EXPECT_LT(count_valid_pixels(asset), 1.5 * kResolution * kResolution);
  const Quality quality = measure_quality(shawl, flat, raster, asset, {});
  EXPECT_LT(quality.l2_stretch, 1.01);
  EXPECT_EQ(quality.flipped, 0U);
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  test::expect_same_topology(measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size())),
                             measure_topology(test::over_points(shawl.triangle, shawl.point), shawl.point_count));
}

}  // namespace
}  // namespace geocloth
