// SPDX-License-Identifier: GPL-3.0-or-later
// Coarse meshes that are divided before they are converted: the same surface with more to draw.

#include "geocloth/parametrize/refine.h"

#include <cmath>
#include <map>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/convert.h"

namespace geocloth {
namespace {

using ::testing::_;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// A square of two triangles and a long one beside it, which has its own corners where it touches the square.
TriangleMesh square_and_flag() {
  TriangleMesh mesh;
  mesh.name = "square";
  mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {3, 0.5, 0}, {1, 1, 0}};
  mesh.triangle = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
  mesh.polygon = {0, 0, 1};
  for (const Triangle& t : mesh.triangle) {
    mesh.uv.emplace_back();
    mesh.normal.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
      mesh.uv.back()[k] = {2 * mesh.position[t[k]][0], 3 - mesh.position[t[k]][1]};
      mesh.normal.back()[k] = {0, 0, 1};
    }
  }
  mesh.part = {{"square", 0, 0, 2}, {"flag", 0, 2, 1}};
  mesh.material = {SourceMaterial{}};
  mesh.vertex_groups = {{"left", {0, 3}}, {"all", {0, 1, 2, 3}}};
  for (const Point3& p : mesh.position) mesh.paint.push_back({static_cast<uint8_t>(80 * p[0]), 0, 9, 255});
  return mesh;
}

double edge_length(const TriangleMesh& mesh, uint32_t a, uint32_t b) {
  const Point3 &p = mesh.position[a], &q = mesh.position[b];
  return std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
}

TEST(Refine, LeavesNoLongEdgeAndTheSameSurface) {
  const TriangleMesh coarse = square_and_flag();
  const TriangleMesh mesh = refine_mesh(coarse, 0.13);
  ASSERT_EQ(coarse.position.size() + mesh.middle.size(), mesh.position.size());
  for (size_t i = 0; i < mesh.middle.size(); ++i) {
    const auto [a, b] = mesh.middle[i];
    ASSERT_LT(std::max(a, b), coarse.position.size() + i);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(mesh.position[coarse.position.size() + i][k], (mesh.position[a][k] + mesh.position[b][k]) / 2, 1e-12);
    }
  }
  std::vector<double> area(2);
  for (size_t p = 0; p < mesh.part.size(); ++p) {
    EXPECT_EQ(mesh.part[p].name, coarse.part[p].name);
    for (uint32_t t = mesh.part[p].first_triangle; t < mesh.part[p].first_triangle + mesh.part[p].triangle_count; ++t) {
      const Triangle& v = mesh.triangle[t];
      for (size_t k = 0; k < 3; ++k) EXPECT_LE(edge_length(mesh, v[k], v[(k + 1) % 3]), 0.13);
      const Point3 &a = mesh.position[v[0]], &b = mesh.position[v[1]], &c = mesh.position[v[2]];
      const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
      EXPECT_GT(twice, 0) << "turned over";
      area[p] += 0.5 * twice;
      EXPECT_EQ(mesh.polygon[t], p);
      for (size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(mesh.uv[t][k][0], 2 * mesh.position[v[k]][0], 1e-12);
        EXPECT_NEAR(mesh.uv[t][k][1], 3 - mesh.position[v[k]][1], 1e-12);
        EXPECT_EQ(mesh.normal[t][k], (Point3{0, 0, 1}));
      }
    }
  }
  EXPECT_NEAR(area[0], 1, 1e-12);
  EXPECT_NEAR(area[1], 1, 1e-12);
}

// A vertex that only one of two triangles has on the edge between them is a crack, and a hole in the cloth.
TEST(Refine, DividesAnEdgeForAllOfItsTriangles) {
  const TriangleMesh mesh = refine_mesh(square_and_flag(), 0.13);
  std::map<std::pair<Point3, Point3>, int> sides;
  for (const Triangle& t : mesh.triangle) {
    for (size_t k = 0; k < 3; ++k) {
      const Point3 &a = mesh.position[t[k]], &b = mesh.position[t[(k + 1) % 3]];
      sides[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  double border = 0;
  for (const auto& [edge, left] : sides) {
    if (left != 0) border += std::hypot(edge.first[0] - edge.second[0], edge.first[1] - edge.second[1]);
  }
  EXPECT_NEAR(border, 3 + 2 * std::hypot(2, 0.5), 1e-9);  // also where the flag only touches the square
}

TEST(Refine, KeepsTheFilesVerticesFirstAndGroupsWhole) {
  const TriangleMesh coarse = square_and_flag(), mesh = refine_mesh(coarse, 0.13);
  for (size_t v = 0; v < coarse.position.size(); ++v) EXPECT_EQ(mesh.position[v], coarse.position[v]);
  EXPECT_EQ(mesh.vertex_groups[0].source_vertex.size(), 9U);  // eight edges of an eighth
  for (const uint32_t v : mesh.vertex_groups[0].source_vertex) EXPECT_EQ(mesh.position[v][0], 0);
  ASSERT_EQ(mesh.paint.size(), mesh.position.size());
  for (size_t v = 0; v < mesh.paint.size(); ++v) {
    EXPECT_NEAR(mesh.paint[v][0], 80 * mesh.position[v][0], 2);  // rounded at every halving
    EXPECT_THAT(mesh.paint[v], ElementsAre(_, 0, 9, 255));
  }
  EXPECT_EQ(refine_mesh(coarse, 5).triangle, coarse.triangle);
}

TEST(Refine, StopsWhereThatWouldBeTooMuch) {
  EXPECT_THROW(static_cast<void>(refine_mesh(square_and_flag(), 1e-5)), Error);
}

// The knight's cape of 84 triangles was drawn with these, and the knight showed through.
TEST(Refine, IsAskedForInPixelsAndAdvisedWhereItIsMissed) {
  TriangleMesh square = square_and_flag();
  square.position.resize(4);
  square.paint.resize(4);
  square.triangle.resize(2);
  square.polygon.resize(2);
  square.uv.resize(2);
  square.normal.resize(2);
  square.part.resize(1);
  ConvertOptions options;
  options.flatten.resolution = 24;
  const ConvertResult coarse = convert(square, options);
  EXPECT_THAT(coarse.report.warnings, Contains(HasSubstr("--refine 2")));
  EXPECT_NEAR(drawn_triangle_size(coarse.asset), 23, 1);
  options.refine = 2;
  const ConvertResult fine = convert(square, options);
  EXPECT_THAT(fine.report.warnings, Not(Contains(HasSubstr("--refine"))));
  EXPECT_LE(drawn_triangle_size(fine.asset), 2);
  EXPECT_EQ(fine.report.source_vertices, 4U);
  EXPECT_EQ(fine.report.refined_vertices + 4, fine.asset.source.source_vertex_count);
  EXPECT_EQ(fine.asset.source.file_vertex_count(), 4U);
  EXPECT_EQ(fine.report.source_faces, 1U);
  EXPECT_EQ(fine.asset.rest_position.size(), coarse.asset.rest_position.size());
}

}  // namespace
}  // namespace geocloth
