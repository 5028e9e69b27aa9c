// SPDX-License-Identifier: GPL-3.0-or-later
// Sewing patterns: what the edges between panels say becomes pairs of pixels along the whole of a seam, each pixel with
// one of its own, whatever the mesh's vertices are like.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/grid_mesh.h"
#include "geocloth/parametrize/convert.h"

namespace geocloth {
namespace {

using Edge = std::array<uint32_t, 2>;

/// Adds a rectangle of quads in a plane of constant z, its lower left corner at (x, 0).
/// @returns its vertices, row by row from below
std::vector<std::vector<uint32_t>> add_panel(TriangleMesh& mesh, uint32_t columns, uint32_t rows, double x, double z,
                                             double width, double height) {
  std::vector<std::vector<uint32_t>> vertex(rows + 1);
  for (uint32_t j = 0; j <= rows; ++j) {
    for (uint32_t i = 0; i <= columns; ++i) {
      vertex[j].push_back(static_cast<uint32_t>(mesh.position.size()));
      mesh.position.push_back({x + width * i / columns, height * j / rows, z});
    }
  }
  for (uint32_t j = 0; j < rows; ++j) {
    for (uint32_t i = 0; i < columns; ++i) {
      const uint32_t a = vertex[j][i], b = vertex[j][i + 1], c = vertex[j + 1][i + 1], d = vertex[j + 1][i];
      const auto polygon = static_cast<uint32_t>(mesh.triangle.size());
      for (const Triangle& t : {Triangle{a, b, c}, Triangle{a, c, d}}) {
        mesh.triangle.push_back(t);
        mesh.polygon.push_back(polygon);
      }
    }
  }
  return vertex;
}

TriangleMesh named(TriangleMesh mesh) {
  mesh.name = "pattern";
  mesh.part = {{"pattern", 0, 0, static_cast<uint32_t>(mesh.triangle.size())}};
  mesh.material = {SourceMaterial{}};
  return mesh;
}

ConvertResult converted(const TriangleMesh& mesh, uint32_t resolution = 24, double refine = 0) {
  ConvertOptions options;
  options.flatten.resolution = resolution;
  options.refine = refine;
  return convert(mesh, options);
}

/// Rest positions of the pairs, the one with the lower z first.
std::vector<std::pair<Vec3, Vec3>> sewn_places(const ClothAsset& asset) {
  std::vector<std::pair<Vec3, Vec3>> places;
  for (const auto& [a, b] : asset.sewing) {
    std::pair<Vec3, Vec3> pair{asset.rest_position[a], asset.rest_position[b]};
    if (pair.first.z > pair.second.z) std::swap(pair.first, pair.second);
    places.push_back(pair);
  }
  return places;
}

/// How many pixels lie at this x.
std::ptrdiff_t pixels_at_x(const ClothAsset& asset, float x, float z) {
  std::ptrdiff_t count = 0;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    const Vec3& at = asset.rest_position[p];
    count += static_cast<std::ptrdiff_t>(asset.valid(p) && std::abs(at.x - x) < 1e-5F && std::abs(at.z - z) < 1e-5F);
  }
  return count;
}

/// Two panels 0.3 m apart in z, sewn along their sides at x = 1, from the hem up to a slit.
struct TwoPanels {
  TriangleMesh mesh;
  std::vector<std::vector<uint32_t>> front, back;
};
TwoPanels two_panels(uint32_t front_rows, uint32_t back_rows) {
  TwoPanels p;
  p.front = add_panel(p.mesh, 6, front_rows, 0, 0.3, 1, 1);
  p.back = add_panel(p.mesh, 6, back_rows, 0, 0, 1, 1);
  p.mesh = named(p.mesh);
  return p;
}

TEST(Sewing, EveryPixelOfASeamHasOneOfItsOwn) {
  TwoPanels p = two_panels(8, 8);
  for (uint32_t j = 0; j <= 8; ++j) {
    const Edge edge{p.front[j].back(), p.back[j].back()};
    p.mesh.loose_edge.push_back(j % 2 == 0 ? edge : Edge{edge[1], edge[0]});  // drawn either way
  }
  std::reverse(p.mesh.loose_edge.begin() + 2, p.mesh.loose_edge.end());
  const ConvertResult result = converted(p.mesh);
  EXPECT_EQ(result.report.sewing_edges, 9U);
  EXPECT_THAT(result.report.warnings, testing::Not(testing::Contains(testing::HasSubstr("sewn"))));
  const auto pixels = pixels_at_x(result.asset, 1, 0.3F);
  EXPECT_EQ(std::ssize(result.asset.sewing), pixels);
  std::set<uint32_t> used;
  for (const auto& pair : result.asset.sewing) used.insert(pair.begin(), pair.end());
  EXPECT_EQ(used.size(), 2 * result.asset.sewing.size());
  for (const auto& [back, front] : sewn_places(result.asset)) {
    EXPECT_NEAR(back.x, 1, 1e-5);
    EXPECT_NEAR(front.x, 1, 1e-5);
    EXPECT_NEAR(back.y, front.y, 0.51F * result.asset.spacing);
    EXPECT_NEAR(front.z - back.z, 0.3, 1e-5);
  }
  EXPECT_NO_THROW(validate(result.asset));
}

TEST(Sewing, EndsWhereItsEdgesEnd) {
  TwoPanels p = two_panels(8, 8);
  for (uint32_t j = 2; j <= 6; ++j) p.mesh.loose_edge.push_back({p.front[j].back(), p.back[j].back()});
  const ConvertResult result = converted(p.mesh);
  float low = 1, high = 0;
  for (const auto& [back, front] : sewn_places(result.asset)) {
    low = std::min({low, back.y, front.y});
    high = std::max({high, back.y, front.y});
  }
  EXPECT_NEAR(low, 0.25F, 0.6F * result.asset.spacing);
  EXPECT_NEAR(high, 0.75F, 0.6F * result.asset.spacing);
  EXPECT_GE(static_cast<double>(result.asset.sewing.size()), 0.5 / static_cast<double>(result.asset.spacing) - 1);
}

TEST(Sewing, TwoSeamsOfTheSamePanelsAreNotJoinedAcrossTheHem) {
  TwoPanels p = two_panels(8, 8);
  for (uint32_t j = 0; j <= 8; ++j) {
    p.mesh.loose_edge.push_back({p.front[j].back(), p.back[j].back()});
    p.mesh.loose_edge.push_back({p.front[j].front(), p.back[j].front()});
  }
  const ClothAsset asset = converted(p.mesh).asset;
  for (const auto& [back, front] : sewn_places(asset)) {
    EXPECT_TRUE(std::abs(back.x) < 1e-5F || std::abs(back.x - 1) < 1e-5F) << back.x;
    EXPECT_NEAR(back.x, front.x, 1e-5);
  }
}

TEST(Sewing, OneEdgeMayBeManyPixelsLong) {
  TwoPanels p = two_panels(1, 1);
  for (const uint32_t j : {0U, 1U}) p.mesh.loose_edge.push_back({p.front[j].back(), p.back[j].back()});
  for (const double refine : {0.0, 2.0}) {
    const ConvertResult result = converted(p.mesh, 24, refine);
    EXPECT_EQ(std::ssize(result.asset.sewing), pixels_at_x(result.asset, 1, 0.3F)) << refine;
  }
}

TEST(Sewing, ALongerSideIsGathered) {
  // 1 m of a skirt to 0.5 m of a waist, vertex to vertex and two to one.
  for (const bool two_to_one : {false, true}) {
    TriangleMesh mesh;
    const auto skirt = add_panel(mesh, 12, 4, -0.25, 0, 1, 0.4);
    const auto waist = add_panel(mesh, two_to_one ? 6 : 12, 3, 0, 0.2, 0.5, 0.3);
    for (uint32_t i = 0; i <= 12; ++i) mesh.loose_edge.push_back({skirt.back()[i], waist[0][two_to_one ? i / 2 : i]});
    const ConvertResult result = converted(named(mesh));
    EXPECT_EQ(result.report.sewing_edges, 13U);
    std::map<uint32_t, uint32_t> partners;
    for (const auto& pair : result.asset.sewing)
      for (const uint32_t pixel : pair) ++partners[pixel];
    for (const auto& [pixel, count] : partners) EXPECT_EQ(count, 1U) << pixel;
    std::vector<std::pair<float, float>> along;
    for (const auto& [below, above] : sewn_places(result.asset)) {
      EXPECT_NEAR(below.y, 0.4, 1e-5);
      EXPECT_NEAR(above.y, 0, 1e-5);
      EXPECT_NEAR((below.x + 0.25F) / 2, above.x, 1.1F * result.asset.spacing);
      along.emplace_back(above.x, below.x);
    }
    std::sort(along.begin(), along.end());
    EXPECT_TRUE(std::is_sorted(along.begin(), along.end(), [](auto& a, auto& b) { return a.second < b.second; }));
    std::ptrdiff_t on_waist = 0;
    for (uint32_t p = 0; p < result.asset.pixel_count(); ++p) {
      const Vec3& at = result.asset.rest_position[p];
      on_waist += static_cast<std::ptrdiff_t>(result.asset.valid(p) && at.z > 0.1F && std::abs(at.y) < 1e-5F);
    }
    EXPECT_EQ(std::ssize(result.asset.sewing), on_waist) << "all of the shorter side";
  }
}

/// A tube about the x axis, open at both ends.
std::vector<std::vector<uint32_t>> add_tube(TriangleMesh& mesh, uint32_t around, double from, double to) {
  constexpr uint32_t kRings = 4;
  std::vector<std::vector<uint32_t>> ring(kRings + 1);
  for (uint32_t k = 0; k <= kRings; ++k) {
    for (uint32_t i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      ring[k].push_back(static_cast<uint32_t>(mesh.position.size()));
      mesh.position.push_back({from + (to - from) * k / kRings, 0.2 * std::cos(angle), 0.2 * std::sin(angle)});
    }
  }
  for (uint32_t k = 0; k < kRings; ++k) {
    for (uint32_t i = 0; i < around; ++i) {
      const uint32_t n = (i + 1) % around;
      const auto polygon = static_cast<uint32_t>(mesh.triangle.size());
      for (const Triangle& t :
           {Triangle{ring[k][i], ring[k + 1][i], ring[k + 1][n]}, Triangle{ring[k][i], ring[k + 1][n], ring[k][n]}}) {
        mesh.triangle.push_back(t);
        mesh.polygon.push_back(polygon);
      }
    }
  }
  return ring;
}

TEST(Sewing, GoesRound) {
  TriangleMesh mesh;
  const auto sleeve = add_tube(mesh, 16, 0, 0.3), cuff = add_tube(mesh, 16, 0.5, 0.7);
  for (uint32_t i = 0; i < 16; ++i) mesh.loose_edge.push_back({sleeve.back()[i], cuff.front()[i]});
  const ConvertResult result = converted(named(mesh));
  EXPECT_EQ(result.report.sewing_edges, 16U);
  const std::vector<uint32_t> first = first_copies(result.asset);
  std::set<uint32_t> rim, sewn;
  for (uint32_t p = 0; p < result.asset.pixel_count(); ++p)
    if (result.asset.valid(p) && std::abs(result.asset.rest_position[p].x - 0.3F) < 1e-5F) rim.insert(first[p]);
  for (const auto& pair : result.asset.sewing) {
    const Vec3 &a = result.asset.rest_position[pair[0]], &b = result.asset.rest_position[pair[1]];
    EXPECT_LT(length(a - b), 0.2F + result.asset.spacing);
    for (const uint32_t p : pair)
      if (rim.contains(first[p])) sewn.insert(first[p]);
  }
  // The cut that lays a tube flat may put a sample more on one rim than on the other.
  EXPECT_GE(sewn.size() + 2, rim.size());
}

TEST(Sewing, AButtonIsOnePair) {
  TwoPanels p = two_panels(8, 8);
  p.mesh.loose_edge = {{p.front[4][3], p.back[4][3]}};
  const ConvertResult result = converted(p.mesh);
  ASSERT_EQ(result.asset.sewing.size(), 1U);
  const auto [back, front] = sewn_places(result.asset)[0];
  for (const Vec3& place : {back, front}) {
    EXPECT_NEAR(place.x, 0.5, 0.8F * result.asset.spacing);
    EXPECT_NEAR(place.y, 0.5, 0.8F * result.asset.spacing);
  }
}

TEST(Sewing, OtherEdgesSewNothing) {
  TwoPanels p = two_panels(4, 4);
  const auto alone = static_cast<uint32_t>(p.mesh.position.size());
  p.mesh.position.push_back({5, 5, 5});
  p.mesh.loose_edge = {{p.front[0][0], p.front[0][1]},  // is one of the mesh as well
                       {p.front[0][0], alone},          // ends where no cloth is
                       {p.front[1][1], p.front[1][1]}};
  const ConvertResult result = converted(p.mesh);
  EXPECT_EQ(result.report.sewing_edges, 0U);
  EXPECT_TRUE(result.asset.sewing.empty());
  EXPECT_EQ(to_json(result).find("\"sewing\""), std::string::npos);
}

TEST(Sewing, VerticesOfTheirOwnAtTheSamePlacesDo) {
  // glTF has lines as primitives of their own, with their own vertices.
  TwoPanels p = two_panels(4, 4);
  for (uint32_t j = 0; j <= 4; ++j) {
    const auto first = static_cast<uint32_t>(p.mesh.position.size());
    for (const uint32_t end : {p.front[j].back(), p.back[j].back()}) p.mesh.position.push_back(p.mesh.position[end]);
    p.mesh.loose_edge.push_back({first, first + 1});
  }
  const ConvertResult result = converted(p.mesh);
  EXPECT_EQ(std::ssize(result.asset.sewing), pixels_at_x(result.asset, 1, 0.3F));
  EXPECT_EQ(result.asset.source.source_vertex_count, p.mesh.position.size());
}

TEST(Sewing, IsFoundFarFromTheOrigin) {
  TwoPanels p = two_panels(4, 4);
  for (uint32_t j = 0; j <= 4; ++j) p.mesh.loose_edge.push_back({p.front[j].back(), p.back[j].back()});
  const size_t pairs = converted(p.mesh).asset.sewing.size();
  for (Point3& at : p.mesh.position) at[0] += 4096;
  EXPECT_EQ(converted(p.mesh).asset.sewing.size(), pairs);
}

}  // namespace
}  // namespace geocloth
