// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth that a modelling program gave a thickness is one cloth, of which one side is simulated and the other rides on
// it: as two cloths its sides fold each by itself and show through each other.
#include "repair/layers.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/convert.h"
#include "mesh/half_edges.h"
#include "mesh/point_math.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

using test::as_mesh;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kThickness = 0.01;  // [m]

std::vector<Point3> vertex_normals(const CleanSurface& s) {
  std::vector<Point3> normal(s.position.size(), Point3{0, 0, 0});
  for (const Triangle& t : s.triangle) {
    const Point3 n = cross(s.position[t[1]] - s.position[t[0]], s.position[t[2]] - s.position[t[0]]);
    for (const uint32_t v : t) normal[v] = normal[v] + n;
  }
  for (Point3& n : normal) n = direction_of(n).value();
  return normal;
}

/// The surface pushed out, then, in reverse, the surface itself: its vertices come second.
/// @param walls  quads along borders join the two
TriangleMesh thickened(const CleanSurface& s, bool walls, double thickness = kThickness) {
  const auto n = static_cast<uint32_t>(s.position.size());
  const std::vector<Point3> normal = vertex_normals(s);
  std::vector<Point3> position;
  for (uint32_t v = 0; v < n; ++v) position.push_back(s.position[v] + normal[v] * thickness);
  position.insert(position.end(), s.position.begin(), s.position.end());
  std::vector<Triangle> triangle = s.triangle;
  for (const Triangle& t : s.triangle) triangle.push_back({t[0] + n, t[2] + n, t[1] + n});
  const std::vector<uint32_t> opposite = opposite_half_edges(s.triangle);
  for (uint32_t h = 0; walls && h < opposite.size(); ++h) {
    if (opposite[h] != kNone) continue;
    const uint32_t a = tail(s.triangle, h), b = head(s.triangle, h);
    triangle.push_back({b, a, a + n});
    triangle.push_back({b, a + n, b + n});
  }
  return as_mesh(std::move(position), std::move(triangle));
}

ConvertResult converted(const TriangleMesh& mesh, bool one_layer) {
  ConvertOptions options;
  options.flatten.resolution = 48;
  options.one_layer = one_layer;
  return convert(mesh, options);
}

void expect_topology(const Topology& t, uint32_t components, uint32_t loops, int64_t euler) {
  EXPECT_EQ(t.components, components);
  EXPECT_EQ(t.boundary_loops, loops);
  EXPECT_EQ(t.euler_characteristic, euler);
}

TEST(Layers, OfAThickTubeTheOuterSideStays) {
  for (const bool walls : {true, false}) {
    SCOPED_TRACE(walls);
    const CleanSurface tube = test::cylinder(32, 24, 0.3, 1);
    const TriangleMesh mesh = thickened(tube, walls);
    const auto layers = find_layers(repair_mesh(mesh).surface);
    ASSERT_TRUE(layers.has_value());
    EXPECT_NEAR(layers->thickness, kThickness, 0.05 * kThickness);
    const ConvertResult both = converted(mesh, false), one = converted(mesh, true);
    expect_topology(both.report.welded, walls ? 1 : 2, walls ? 0 : 4, 0);
    expect_topology(one.report.welded, 1, 2, 0);
    EXPECT_THAT(both.report.warnings, Contains(HasSubstr("--one-layer")));
    EXPECT_THAT(one.report.warnings, Not(Contains(HasSubstr("--one-layer"))));
    ASSERT_EQ(one.report.carried.size(), 1U);
    EXPECT_EQ(one.report.carried[0].faces, mesh.triangle.size() - tube.triangle.size());
    EXPECT_NEAR(one.report.carried[0].area_share, walls ? 0.5 : 0.49, 0.02);
    EXPECT_THAT(one.report.carried[0].why, HasSubstr("0.01 m thick"));
    for (uint32_t p = 0; p < one.asset.pixel_count(); ++p) {
      if (!one.asset.valid(p)) continue;
      const Vec3& at = one.asset.rest_position[p];
      EXPECT_GT(std::hypot(at.x, at.z), 0.3F + 0.8F * static_cast<float>(kThickness));
    }
  }
}

// What is simulated is one side; drawn are both, with what joins them.
TEST(Layers, TheOtherSideRidesAtItsDistance) {
  const CleanSurface tube = test::cylinder(32, 24, 0.3, 1);
  const TriangleMesh mesh = thickened(tube, true);
  const ConvertResult one = converted(mesh, true);
  const ClothAsset& asset = one.asset;
  EXPECT_EQ(asset.source.triangle.size(), mesh.triangle.size());
  std::vector<Vec3> position = asset.rest_position, normal, vertex;
  for (Vec3& p : position) p = {p.x, p.y, p.z + 0.2F * std::sin(4 * p.y)};  // bent
  compute_normals(asset, position, normal);
  evaluate_binding(asset, position, normal, vertex);
  std::vector<Vec3> of_file(mesh.position.size());
  for (size_t v = 0; v < vertex.size(); ++v) of_file[asset.source.source_vertex[v]] = vertex[v];
  const size_t n = tube.position.size();
  for (size_t v = 0; v < n; ++v) EXPECT_NEAR(length(of_file[v] - of_file[v + n]), kThickness, 0.1 * kThickness) << v;
}

TEST(Layers, AShirtOfFourOpeningsIsThatAgain) {
  const CleanSurface shirt = test::shirt(16);
  const ConvertResult plain = converted(as_mesh(shirt.position, shirt.triangle), false);
  const ConvertResult one = converted(thickened(shirt, true, 0.004), true);
  expect_topology(one.report.welded, plain.report.welded.components, plain.report.welded.boundary_loops,
                  plain.report.welded.euler_characteristic);
  EXPECT_THAT(plain.report.warnings, Not(Contains(HasSubstr("--one-layer"))));
}

/// A sheet two of whose edges are rounded: half a circle of facets joins its sides.
TriangleMesh quilt(uint32_t facets) {
  constexpr double kLong = 1;
  std::vector<std::array<double, 2>> outline;  // across: along the sheet, and its height
  for (uint32_t k = 0; k <= 20; ++k) outline.push_back({kLong * k / 20, kThickness / 2});
  const auto add_edge = [&](double at, double from) {
    for (uint32_t k = 1; k < facets; ++k) {
      const double angle = from - std::numbers::pi * k / facets;
      outline.push_back({at + kThickness / 2 * std::cos(angle), kThickness / 2 * std::sin(angle)});
    }
  };
  add_edge(kLong, std::numbers::pi / 2);
  for (uint32_t k = 0; k <= 20; ++k) outline.push_back({kLong - kLong * k / 20, -kThickness / 2});
  add_edge(0, -std::numbers::pi / 2);
  const auto around = static_cast<uint32_t>(outline.size());
  constexpr uint32_t kRows = 21;
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  for (uint32_t j = 0; j < kRows; ++j)
    for (const auto& [x, y] : outline) position.push_back({x, y, kLong * j / (kRows - 1)});
  for (uint32_t j = 0; j + 1 < kRows; ++j) {
    for (uint32_t i = 0; i < around; ++i) {
      const uint32_t a = j * around + i, b = j * around + (i + 1) % around;
      triangle.push_back({a, a + around, b});
      triangle.push_back({b, a + around, b + around});
    }
  }
  for (const uint32_t row : {0U, kRows - 1}) {
    const auto middle = static_cast<uint32_t>(position.size());
    position.push_back({kLong / 2, 0, kLong * row / (kRows - 1)});
    for (uint32_t i = 0; i < around; ++i) {
      const uint32_t a = row * around + i, b = row * around + (i + 1) % around;
      triangle.push_back(row == 0 ? Triangle{a, b, middle} : Triangle{b, a, middle});
    }
  }
  return as_mesh(std::move(position), std::move(triangle));
}

// With fine facets the two sides go on into each other smoothly.
TEST(Layers, RoundedEdgesDoNotJoinTheSides) {
  for (const uint32_t facets : {2U, 5U, 12U}) {
    SCOPED_TRACE(facets);
    const ConvertResult one = converted(quilt(facets), true);
    expect_topology(one.report.welded, 1, 1, 1);
    EXPECT_NEAR(one.report.carried[0].area_share, 0.5, 0.02);
  }
}

TEST(Layers, OfSidesThatAreTurnedInsideOutOneStays) {
  TriangleMesh tube = thickened(test::cylinder(32, 24, 0.3, 1), false);
  for (Triangle& t : tube.triangle) std::swap(t[1], t[2]);
  expect_topology(converted(tube, true).report.welded, 1, 2, 0);
}

// Its front and its back are as near to each other as the sides of thick cloth.
TEST(Layers, AGarmentThatLiesFlatIsNotThick) {
  CleanSurface bag = test::cylinder(64, 24, 0.3, 1);
  for (Point3& p : bag.position) p[2] *= 0.02;
  EXPECT_FALSE(find_thickness(bag).has_value());
  EXPECT_FALSE(find_layers(bag).has_value());
}

TEST(Layers, ClothThatHasNoneIsRefusedAndToldApart) {
  const CleanSurface shirt = test::shirt(8), ball = test::sphere(24, 12);
  for (const CleanSurface* s : {&shirt, &ball}) {
    EXPECT_FALSE(find_layers(*s).has_value());
    EXPECT_FALSE(find_thickness(*s).has_value());
    try {
      (void)converted(as_mesh(s->position, s->triangle), true);
      FAIL();
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr("without --one-layer"));
    }
  }
}

// Thin parts of a file keep what they are.
TEST(Layers, OnlyWhatIsThickLosesASide) {
  TriangleMesh mesh = thickened(test::cylinder(32, 24, 0.3, 1), true);
  const auto first = static_cast<uint32_t>(mesh.position.size());
  const CleanSurface flag = test::disk(9, 9);
  for (const Point3& p : flag.position) mesh.position.push_back({p[0] + 2, p[1], p[2]});
  for (const Triangle& t : flag.triangle) mesh.triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
  mesh.part.push_back({"flag", 0, mesh.part[0].triangle_count, static_cast<uint32_t>(flag.triangle.size())});
  mesh.polygon.resize(mesh.triangle.size());
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  const ConvertResult one = converted(mesh, true);
  expect_topology(one.report.welded, 2, 3, 1);
  ASSERT_EQ(one.report.carried.size(), 1U);
  EXPECT_EQ(one.report.carried[0].part, 0U);
}

}  // namespace
}  // namespace geocloth
