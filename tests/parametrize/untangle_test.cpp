// SPDX-License-Identifier: GPL-3.0-or-later
// Layers that cut through each other come apart, and nothing else moves. Where they do is asked of CGAL's exact
// predicates.
#include "mesh/untangle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/convert.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kTouching = 4;  // pairs that nobody can say of whether they cut or touch

struct Surface {
  std::vector<Point3> place;
  std::vector<Triangle> triangle;

  /// A sheet or, where `closed`, a tube of columns x rows points.
  template <class Shape>
  void add(uint32_t columns, uint32_t rows, bool closed, const Shape& shape) {
    const auto first = static_cast<uint32_t>(place.size());
    for (uint32_t j = 0; j < rows; ++j)
      for (uint32_t i = 0; i < columns; ++i) place.push_back(shape(i, j));
    for (uint32_t j = 0; j + 1 < rows; ++j) {
      for (uint32_t i = 0; i + (closed ? 0 : 1) < columns; ++i) {
        const uint32_t a = first + j * columns + i, b = first + j * columns + (i + 1) % columns;
        triangle.push_back({a, b, b + columns});
        triangle.push_back({a, b + columns, a + columns});
      }
    }
  }
};

/// A flat sheet, and one above it whose corner dips through it.
Surface dipping_corner() {
  Surface s;
  s.add(16, 16, false, [](uint32_t i, uint32_t j) { return Point3{0.1 * i, 0.1 * j, 0}; });
  s.add(16, 16, false, [](uint32_t i, uint32_t j) {
    return Point3{0.1 * i + 0.73, 0.1 * j + 0.71, 0.04 * (i + 1.07 * j) - 0.19};
  });
  return s;
}

/// A sleeve and its lining, which bulges through it.
Surface bulging_lining(double radius = 0.97) {
  Surface s;
  constexpr uint32_t kAround = 36, kAlong = 20;
  const auto add = [&](double r, double bulge, double turn) {
    s.add(kAround, kAlong, true, [&](uint32_t i, uint32_t j) {
      const double angle = 2 * std::numbers::pi * (i + turn) / kAround, height = 0.18 * j;
      const double away = std::pow((height - 1.7) / 0.4, 2) + std::pow(std::remainder(angle - 2, 6.2831853) / 0.4, 2);
      const double at = r + bulge * std::exp(-away);
      return Point3{at * std::cos(angle), height, at * std::sin(angle)};
    });
  };
  add(1, 0, 0);
  add(radius, 1.08 - radius, 0.37);
  return s;
}

/// Pairs of triangles that meet and share no point.
uint32_t count_meetings(const Surface& s) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  struct Boxed {
    Triangle points;
    Kernel::Triangle_3 triangle;
    CGAL::Bbox_3 box;
  };
  std::vector<Boxed> boxed;
  for (const Triangle& t : s.triangle) {
    const auto point = [&](uint32_t p) { return Kernel::Point_3(s.place[p][0], s.place[p][1], s.place[p][2]); };
    const Kernel::Triangle_3 triangle(point(t[0]), point(t[1]), point(t[2]));
    boxed.push_back({t, triangle, triangle.bbox()});
  }
  std::sort(boxed.begin(), boxed.end(), [](const Boxed& a, const Boxed& b) { return a.box.xmin() < b.box.xmin(); });
  uint32_t count = 0;
  for (auto a = boxed.begin(); a != boxed.end(); ++a) {
    for (auto b = a + 1; b != boxed.end() && b->box.xmin() <= a->box.xmax(); ++b) {
      if (!CGAL::do_overlap(a->box, b->box)) continue;
      const bool share = std::any_of(a->points.begin(), a->points.end(), [&](uint32_t p) {
        return std::find(b->points.begin(), b->points.end(), p) != b->points.end();
      });
      if (!share && CGAL::do_intersect(a->triangle, b->triangle)) ++count;
    }
  }
  return count;
}

void expect_drawn_apart(const Surface& tangled, double farthest, double stretch) {
  Surface apart = tangled;
  const Untangled result = untangle(apart.triangle, apart.place);
  EXPECT_NEAR(result.before, count_meetings(tangled), kTouching);
  EXPECT_GT(result.before, 20U);
  EXPECT_EQ(result.after, 0U);
  EXPECT_EQ(count_meetings(apart), 0U);
  EXPECT_GT(result.farthest, 0);
  EXPECT_LT(result.farthest, farthest);
  std::size_t still = 0;
  for (std::size_t p = 0; p < apart.place.size(); ++p) {
    EXPECT_LE(distance(apart.place[p], tangled.place[p]), result.farthest);
    if (apart.place[p] == tangled.place[p]) ++still;
  }
  EXPECT_GT(still, apart.place.size() / 4) << "what is far from the crossings stays bit for bit";
  for (const Triangle& t : apart.triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      const double by = distance(apart.place[a], apart.place[b]) / distance(tangled.place[a], tangled.place[b]);
      EXPECT_LT(std::max(by, 1 / by), stretch) << a << ' ' << b;
    }
  }
}

TEST(Untangle, ACornerComesBackOutOfASheet) {
  expect_drawn_apart(dipping_corner(), 0.2, 1.5);
}

TEST(Untangle, ALiningGoesBackIntoItsSleeve) {
  expect_drawn_apart(bulging_lining(), 0.2, 1.5);
}

TEST(Untangle, TheSameEachTime) {
  Surface one = bulging_lining(), other = bulging_lining();
  untangle(one.triangle, one.place);
  untangle(other.triangle, other.place);
  EXPECT_EQ(one.place, other.place);
}

TEST(Untangle, WhatDoesNotCutThroughItselfStays) {
  Surface s;
  s.add(9, 9, false, [](uint32_t i, uint32_t j) { return Point3{1.0 * i, 1.0 * j, 0}; });
  s.add(9, 9, false, [](uint32_t i, uint32_t j) { return Point3{1.0 * i, 1.0 * j, 1e-3}; });
  s.add(9, 9, false, [](uint32_t i, uint32_t j) { return Point3{i + 0.5, j + 0.5, 0}; });  // in one plane
  s.triangle.push_back({3, 3, 4});
  const std::vector<Point3> before = s.place;
  const Untangled result = untangle(s.triangle, s.place);
  EXPECT_EQ(result.before, 0U);
  EXPECT_EQ(result.farthest, 0);
  EXPECT_EQ(s.place, before);
  std::vector<Point3> none;
  EXPECT_EQ(untangle({}, none).after, 0U);
}

TEST(Untangle, OfAGarmentMeshAndImageComeApart) {
  const Surface tangled = bulging_lining();
  TriangleMesh mesh;
  mesh.position = tangled.place;
  mesh.triangle = tangled.triangle;
  for (uint32_t t = 0; t < mesh.triangle.size(); ++t) mesh.polygon.push_back(t);
  mesh.part = {{"sleeve", 0, 0, static_cast<uint32_t>(mesh.triangle.size())}};
  mesh.material.push_back({});
  ConvertOptions options;
  options.flatten.resolution = 48;
  const auto meetings = [](const ConvertResult& result) {
    const GridMesh grid = welded_grid_mesh(result.asset, result.asset.rest_position);
    Surface s{{}, grid.triangle};
    for (const Vec3& p : grid.position) s.place.push_back({p.x, p.y, p.z});
    return count_meetings(s);
  };
  const ConvertResult as_it_is = convert(mesh, options);
  EXPECT_GT(meetings(as_it_is), 20U);
  EXPECT_FALSE(as_it_is.report.untangled_mesh || as_it_is.report.untangled_image);
  EXPECT_EQ(to_json(as_it_is).find("untangled"), std::string::npos);

  options.untangle = true;
  const ConvertResult apart = convert(mesh, options);
  EXPECT_EQ(meetings(apart), 0U);
  const auto json = nlohmann::json::parse(to_json(apart)).at("untangled");
  EXPECT_NEAR(json.at("mesh").at("before").get<double>(), count_meetings(tangled), kTouching);
  for (const char* of : {"mesh", "image"}) EXPECT_EQ(json.at(of).at("after"), 0) << of;
  // The garment that is drawn is the one that was drawn apart.
  Surface drawn{{}, tangled.triangle};
  drawn.place.resize(mesh.position.size());
  const SourceMesh& source = apart.asset.source;
  for (std::size_t r = 0; r < source.position.size(); ++r) {
    const Vec3& p = source.position[r];
    drawn.place[source.source_vertex[r]] = {p.x, p.y, p.z};
  }
  EXPECT_EQ(count_meetings(drawn), 0U);
  EXPECT_LT(apart.report.quality.binding_error, 1e-5);
}

}  // namespace
}  // namespace geocloth
