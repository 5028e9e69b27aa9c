// SPDX-License-Identifier: GPL-3.0-or-later
// A garment is the same whatever the unit of its file, the order of its vertices and faces, and the way it is turned.
// So must its image be: an artist who exports again, or from another program, may not get another layout.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "geocloth/parametrize/convert.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

TriangleMesh as_mesh(const CleanSurface& surface) {
  return test::as_mesh(surface.position, surface.triangle);
}

/// A shirt without any symmetry, as bodies and their clothes are.
TriangleMesh worn_shirt() {
  TriangleMesh mesh = as_mesh(test::shirt(8));
  for (Point3& p : mesh.position) {
    const auto [x, y, z] = p;
    p = {x + 0.03 * std::sin(3 * y + 1) + 0.02 * z, 1.1 * y + 0.05 * x * x + 0.03 * x, z + 0.04 * std::sin(2 * x + y)};
  }
  return mesh;
}

TriangleMesh shuffled(const TriangleMesh& mesh, uint32_t seed) {
  std::mt19937 random(seed);
  const auto permutation = [&](size_t n) {
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0U);
    for (size_t i = n; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
    return order;
  };
  TriangleMesh result = mesh;
  const std::vector<uint32_t> place = permutation(mesh.position.size());
  for (size_t v = 0; v < place.size(); ++v) result.position[place[v]] = mesh.position[v];
  const std::vector<uint32_t> triangles = permutation(mesh.triangle.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& k = mesh.triangle[triangles[t]];
    const size_t first = random() % 3;
    result.triangle[t] = {place[k[first]], place[k[(first + 1) % 3]], place[k[(first + 2) % 3]]};
  }
  return result;
}

TriangleMesh moved(const TriangleMesh& mesh, double scale, double turn) {
  TriangleMesh result = mesh;
  for (Point3& p : result.position) {
    p = {scale * (std::cos(turn) * p[0] + std::sin(turn) * p[2]) + 3 * scale * turn, scale * p[1] + scale * turn,
         scale * (std::cos(turn) * p[2] - std::sin(turn) * p[0])};
  }
  return result;
}

/// Turned about x after that: a garment that lies on its side, or stands on its head.
TriangleMesh tipped(const TriangleMesh& mesh, double turn, double tip) {
  TriangleMesh result = moved(mesh, 1, turn);
  for (Point3& p : result.position) {
    p = {p[0], std::cos(tip) * p[1] - std::sin(tip) * p[2], std::sin(tip) * p[1] + std::cos(tip) * p[2]};
  }
  return result;
}

/// The charts and the split pixels of an image that is turned by half a turn.
std::pair<std::vector<uint16_t>, std::vector<uint32_t>> half_turned(const ClothAsset& asset) {
  std::vector<uint32_t> split = asset.splits.pixel;
  for (uint32_t& p : split) p = asset.pixel_count() - 1 - p;
  std::sort(split.begin(), split.end());
  return {{asset.chart.rbegin(), asset.chart.rend()}, split};
}

ConvertResult converted(const TriangleMesh& mesh, Layout layout = Layout::panels) {
  ConvertOptions options;
  options.flatten.layout = layout;
  options.flatten.resolution = 48;
  return convert(mesh, options);
}

void expect_same_measures(const ConvertResult& a, const ConvertResult& b, double scale) {
  EXPECT_EQ(a.asset.width, b.asset.width);
  EXPECT_EQ(a.asset.height, b.asset.height);
  EXPECT_EQ(a.asset.chart_count, b.asset.chart_count);
  EXPECT_NEAR(scale * a.asset.spacing, b.asset.spacing, 1e-6 * b.asset.spacing);
  EXPECT_NEAR(a.report.quality.seam_length, b.report.quality.seam_length, 1e-6);
  EXPECT_NEAR(a.report.quality.symmetric_dirichlet, b.report.quality.symmetric_dirichlet, 1e-6);
  EXPECT_NEAR(a.report.quality.anisotropy_p95, b.report.quality.anisotropy_p95, 1e-4);
  // Pixels are mended in their order, which turns with the image.
  EXPECT_NEAR(a.report.quality.shear_deg_p95, b.report.quality.shear_deg_p95, 0.12 * b.report.quality.shear_deg_p95);
}

void expect_same_image(const ConvertResult& a, const ConvertResult& b, double scale) {
  EXPECT_EQ(a.asset.chart, b.asset.chart);
  EXPECT_EQ(a.asset.splits.pixel, b.asset.splits.pixel);
  expect_same_measures(a, b, scale);
}

/// The same, or that turned by half a turn: of up and down a tipped garment does not tell which is which.
void expect_same_image_but_for_half_a_turn(const ConvertResult& a, const ConvertResult& b) {
  if (a.asset.chart != b.asset.chart) {
    const auto [chart, split] = half_turned(b.asset);
    std::vector<uint32_t> sorted = a.asset.splits.pixel;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(a.asset.chart, chart);
    EXPECT_EQ(sorted, split);
  }
  expect_same_measures(a, b, 1);
}

TEST(Invariance, OrderOfVerticesAndFaces) {
  const TriangleMesh shirt = worn_shirt();
  const ConvertResult as_it_is = converted(shirt);
  for (const uint32_t seed : {1U, 2U, 3U}) expect_same_image(as_it_is, converted(shuffled(shirt, seed)), 1);
}

TEST(Invariance, UnitOfTheFile) {
  const TriangleMesh shirt = worn_shirt();
  const ConvertResult as_it_is = converted(shirt);
  for (const double scale : {1000.0, 100.0, 39.37, 1e-3}) {
    expect_same_image(as_it_is, converted(moved(shirt, scale, 0)), scale);
  }
}

TEST(Invariance, TurnsAboutTheVertical) {
  const TriangleMesh shirt = worn_shirt();
  const ConvertResult as_it_is = converted(shirt);
  for (const double turn : {0.3, 1.6, 4.0}) expect_same_image(as_it_is, converted(moved(shirt, 1, turn)), 1);
}

constexpr std::array<std::array<double, 2>, 4> kTips{{{0, 1.5707963267948966}, {0.4, -1.1}, {2.5, 2.3}, {4.0, 3.1}}};

// Many programs have z up. Their files came out with another grain, and with other panels.
TEST(Invariance, LyingOnItsSide) {
  const TriangleMesh shirt = worn_shirt();
  const ConvertResult as_it_is = converted(shirt);
  EXPECT_GT(as_it_is.report.up[1], 0.97);
  for (const auto& [turn, tip] : kTips) {
    SCOPED_TRACE(tip);
    const ConvertResult turned = converted(tipped(shirt, turn, tip));
    expect_same_image_but_for_half_a_turn(as_it_is, turned);
    EXPECT_GT(turned.report.up[1], std::abs(std::cos(tip)) - 0.2);
  }
}

// A flag that hangs by its side, or a garment whose shape misleads.
TEST(Invariance, UpMayBeTold) {
  const TriangleMesh flag = as_mesh(test::disk(21, 11, 2, 1));
  const auto converted_with = [](const TriangleMesh& mesh, const Point3& up) {
    ConvertOptions options;
    options.flatten.resolution = 48;
    options.up = up;
    ConvertResult result = convert(mesh, options);
    EXPECT_EQ(result.report.up, up);
    return result;
  };
  for (const Point3& up : {Point3{0, 1, 0}, Point3{1, 0, 0}, Point3{-1, 0, 0}, Point3{0, -1, 0}}) {
    const ClothAsset asset = converted_with(flag, up).asset;
    const std::vector<uint32_t> column = [&] {
      std::vector<uint32_t> pixels;
      for (uint32_t y = 0; y < asset.height; ++y) {
        const uint32_t p = y * asset.width + asset.width / 2;
        if (asset.valid(p)) pixels.push_back(p);
      }
      return pixels;
    }();
    const Vec3 way = asset.rest_position[column.front()] - asset.rest_position[column.back()];
    EXPECT_NEAR(double{way.x} * up[0] + double{way.y} * up[1], std::abs(up[0]) * 2 + std::abs(up[1]), 0.01) << up[0];
  }
  const TriangleMesh shirt = worn_shirt();
  expect_same_image(converted_with(shirt, {0, 1, 0}), converted_with(tipped(shirt, 0, kTips[0][1]), {0, 0, 1}), 1);
}

/// Left and right cost the same here: what decides between them must not be rounding.
TEST(Invariance, SymmetricGarments) {
  for (const CleanSurface& surface : {test::shirt(8), test::cylinder(24, 9)}) {
    const TriangleMesh mesh = as_mesh(surface);
    for (const Layout layout : {Layout::panels, Layout::square}) {
      SCOPED_TRACE(std::to_string(mesh.triangle.size()) + (layout == Layout::panels ? " panels" : " square"));
      const ConvertResult as_it_is = converted(mesh, layout);
      expect_same_image(as_it_is, converted(shuffled(moved(mesh, 1, 0.3), 3), layout), 1);
      expect_same_image(as_it_is, converted(moved(mesh, 39.37, 4.0), layout), 39.37);
      expect_same_image_but_for_half_a_turn(as_it_is, converted(tipped(mesh, 0.3, 2.0), layout));
    }
  }
}

void expect_same_layout_when_turned(const std::string& garment, Layout layout) {
  const std::filesystem::path file =
      std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "../shared/meshes/garments" / (garment + ".obj");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no shared meshes here";
  TriangleMesh mesh = import_mesh(file);
  mesh.uv.clear();
  mesh.normal.clear();
  const ConvertResult as_it_is = converted(mesh, layout);
  expect_same_image(as_it_is, converted(shuffled(mesh, 7), layout), 1);
  expect_same_image(as_it_is, converted(moved(mesh, 1000, 0.7), layout), 1000);
  for (const auto& [turn, tip] : kTips) {
    SCOPED_TRACE(tip);
    expect_same_image_but_for_half_a_turn(as_it_is, converted(tipped(mesh, turn, tip), layout));
  }
}

TEST(Invariance, RealGarment) {
  expect_same_layout_when_turned("diffcloth_tshirt", Layout::panels);
}

TEST(Invariance, RealGarmentOfMirroredHalves) {
  expect_same_layout_when_turned("mh_skirt_tube", Layout::panels);
  expect_same_layout_when_turned("mh_tights", Layout::square);
}

}  // namespace
}  // namespace geocloth
