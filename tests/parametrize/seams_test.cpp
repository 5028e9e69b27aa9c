// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/seams.h"

#include <numeric>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flat_builder.h"
#include "geocloth/asset/grid_mesh.h"

namespace geocloth {
namespace {

using test::FlatBuilder;
using testing::ElementsAre;
using testing::IsEmpty;

ClothAsset image_of(const FlatSurface& flat) {
  return build_image(flat, rasterize(flat), Layout::square);
}

Topology welded(const ClothAsset& asset) {
  const GridMesh mesh = welded_grid_mesh(asset, asset.rest_position);
  return measure_topology(mesh.triangle, static_cast<uint32_t>(mesh.position.size()));
}

/// Triangles that the weld has collapsed would vanish from the surface unnoticed.
void expect_whole(const ClothAsset& asset, uint32_t cells) {
  EXPECT_EQ(pixel_triangles(asset).size(), 2 * cells);
  EXPECT_EQ(welded(asset).faces, 2 * cells);
}

struct Expected {
  const char* name;
  std::function<FlatBuilder(uint32_t)> make;
  uint32_t charts;
  int64_t euler;
  uint32_t loops;
  bool orientable;
};

class WeldedGrid : public testing::TestWithParam<Expected> {};

TEST_P(WeldedGrid, HasTheTopologyOfTheSurface) {
  for (const uint32_t n : {5U, 7U, 9U, 17U, 33U}) {
    const ClothAsset asset = image_of(GetParam().make(n).flat);
    const Topology t = welded(asset);
    SCOPED_TRACE(n);
    expect_whole(asset, GetParam().charts * (n - 1) * (n - 1));
    EXPECT_EQ(t.components, 1U);
    EXPECT_EQ(t.euler_characteristic, GetParam().euler);
    EXPECT_EQ(t.boundary_loops, GetParam().loops);
    EXPECT_EQ(t.orientable, GetParam().orientable);
    EXPECT_EQ(t.non_manifold_edges, 0U);
    EXPECT_EQ(t.bow_tie_vertices, 0U);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Surfaces, WeldedGrid,
    testing::Values(Expected{"sheet", [](uint32_t n) { return test::sheet(n); }, 1, 1, 1, true},
                    Expected{"tube", [](uint32_t n) { return test::tube(n); }, 1, 0, 2, true},
                    Expected{"sphere", [](uint32_t n) { return test::closed_sphere(n); }, 1, 2, 0, true},
                    Expected{"torus", [](uint32_t n) { return test::torus(n); }, 1, 0, 0, true},
                    Expected{"moebius", [](uint32_t n) { return test::moebius(n); }, 1, 0, 1, false},
                    Expected{"two_sheets", [](uint32_t n) { return test::fan(n, 2); }, 2, 1, 1, true}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(Seams, AThirdSheetStaysTiedToItsEdge) {
  const ClothAsset asset = image_of(test::fan(9, 3).flat);
  const Topology t = welded(asset);
  EXPECT_EQ(t.components, 1U);
  EXPECT_EQ(t.euler_characteristic, 1);
  EXPECT_EQ(t.non_manifold_edges, 8U);
}

TEST(Seams, TheTableHoldsEveryCopyOfAPoint) {
  const ClothAsset asset = image_of(test::tube(5).flat);
  EXPECT_THAT(asset.splits.offset, ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(asset.splits.pixel, ElementsAre(0, 4, 5, 9, 10, 14, 15, 19, 20, 24));
  const ClothAsset corner = image_of(test::torus(5).flat);
  EXPECT_EQ(corner.splits.rows(), 1U + 3 + 3);
  EXPECT_EQ(corner.splits.offset[1], 4U);  // the corner pixels are one point
  EXPECT_THAT(image_of(test::sheet(5).flat).splits.offset, IsEmpty());
}

TEST(Seams, CopiesHaveOneRestPosition) {
  for (const FlatBuilder& b : {test::tube(9, 0.3), test::torus(9), test::closed_sphere(9), test::fan(9, 3)}) {
    const ClothAsset asset = image_of(b.flat);
    for (uint32_t r = 0; r < asset.splits.rows(); ++r) {
      for (uint32_t k = asset.splits.offset[r]; k < asset.splits.offset[r + 1]; ++k) {
        EXPECT_EQ(asset.rest_position[asset.splits.pixel[k]],
                  asset.rest_position[asset.splits.pixel[asset.splits.offset[r]]]);
      }
    }
  }
}

uint32_t count(const ClothAsset& asset, SpringBit bit) {
  return static_cast<uint32_t>(
      std::count_if(asset.spring_mask.begin(), asset.spring_mask.end(), [=](uint8_t m) { return (m & bit) != 0; }));
}

TEST(Springs, AWholeSheetHasAllOfThem) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::sheet(n).flat);
  for (const SpringBit bit : {kSpringRight, kSpringDown}) EXPECT_EQ(count(asset, bit), n * (n - 1));
  for (const SpringBit bit : {kSpringDownRight, kSpringDownLeft}) EXPECT_EQ(count(asset, bit), (n - 1) * (n - 1));
  for (const SpringBit bit : {kSpringRight2, kSpringDown2}) EXPECT_EQ(count(asset, bit), n * (n - 2));
}

TEST(Springs, NeverJoinTwoChartsThatLieSideBySide) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::fan(n, 2).flat);
  for (uint32_t y = 0; y < n; ++y) {
    EXPECT_EQ(asset.spring_mask[y * 2 * n + n - 1] & (kSpringRight | kSpringDownRight | kSpringRight2), 0) << y;
    EXPECT_EQ(asset.spring_mask[y * 2 * n + n - 2] & kSpringRight2, 0) << y;
  }
}

TEST(Springs, NeverJoinTwoCopiesAtTheEndOfACut) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::closed_sphere(n).flat);
  // Top row: pixels 3 and 5 are copies, pixel 4 is the end of the cut.
  EXPECT_EQ(asset.spring_mask[3] & kSpringRight2, 0);
  EXPECT_NE(asset.spring_mask[3] & kSpringRight, 0);
  EXPECT_NE(asset.spring_mask[2] & kSpringRight2, 0);
}

/// A sheet with a slit one pixel wide that runs down from the top between columns 3 and 4.
FlatSurface slit_sheet(uint32_t n, uint32_t depth) {
  FlatBuilder b = test::sheet(n, 1, 0);
  FlatSurface flat = b.flat;
  flat.triangle.clear();
  flat.chart.clear();
  for (const Triangle& t : b.flat.triangle) {
    const auto in_slit = [&](uint32_t v) { return flat.uv[v][0] >= 3 && flat.uv[v][0] <= 4 && flat.uv[v][1] <= depth; };
    if (in_slit(t[0]) && in_slit(t[1]) && in_slit(t[2])) continue;
    flat.triangle.push_back(t);
    flat.chart.push_back(0);
  }
  std::vector<OutlineSample>& outline = flat.charts[0].outline;
  std::vector<OutlineSample> slit;
  for (uint32_t y = 1; y <= depth; ++y) slit.push_back({4, y, y * n + 4});
  for (uint32_t y = depth; y > 0; --y) slit.push_back({3, y, y * n + 3});
  const auto at = std::find_if(outline.begin(), outline.end(), [](const auto& s) { return s.y == 0 && s.x == 4; });
  outline.insert(at + 1, slit.begin(), slit.end());
  return flat;
}

TEST(Springs, DoNotCrossASlit) {
  const uint32_t n = 9, depth = 4;
  const ClothAsset asset = image_of(slit_sheet(n, depth));
  for (uint32_t y = 0; y < depth; ++y) {
    EXPECT_EQ(asset.spring_mask[y * n + 3] & (kSpringRight | kSpringDownRight | kSpringRight2), 0) << y;
    EXPECT_EQ(asset.spring_mask[y * n + 4] & kSpringDownLeft, 0) << y;
    EXPECT_EQ(asset.spring_mask[y * n + 2] & kSpringRight2, 0) << y;
    EXPECT_EQ(asset.cell[y * n + 3], 0) << y;
  }
  EXPECT_NE(asset.spring_mask[depth * n + 3] & kSpringRight, 0);
  EXPECT_NE(asset.spring_mask[depth * n + 2] & kSpringRight2, 0);
  EXPECT_EQ(welded(asset).euler_characteristic, 1);
  EXPECT_EQ(welded(asset).boundary_loops, 1U);
}

using Bend = std::set<uint32_t>;
std::multiset<Bend> bends_of(const ClothAsset& asset) {
  const std::vector<uint32_t> first = first_copies(asset);
  std::multiset<Bend> bends;
  for (const SeamBend& b : asset.seam_bends) bends.insert({first[b.a], first[b.middle], first[b.b]});
  return bends;
}

TEST(SeamBends, ContinueASheetAcrossItsSeam) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::fan(n, 2).flat);
  std::multiset<Bend> expected;
  for (uint32_t y = 0; y < n; ++y) {
    const uint32_t row = y * 2 * n;
    expected.insert({row + n - 2, row + n - 1, row + n + 1});
  }
  EXPECT_EQ(bends_of(asset), expected);
  for (const SeamBend& b : asset.seam_bends) EXPECT_NEAR(b.rest_length, 2.0F / (n - 1), 2e-2);
}

TEST(SeamBends, LeaveASewnOnSheetHinged) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::fan(n, 3).flat);
  EXPECT_EQ(asset.seam_bends.size(), n);
  for (const SeamBend& b : asset.seam_bends) {
    EXPECT_NE(asset.chart[b.a], 2);
    EXPECT_NE(asset.chart[b.b], 2);
  }
}

TEST(SeamBends, CloseATube) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::tube(n).flat);
  EXPECT_EQ(asset.seam_bends.size(), n);
  for (const SeamBend& b : asset.seam_bends) EXPECT_GT(b.rest_length, 0.5F);
}

TEST(SeamBends, RunOverTheEndOfACut) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::closed_sphere(n).flat);
  // The cut ends at pixel 4 of the top row: from its copies at 3 and 5 the cloth goes on to the row below.
  EXPECT_EQ(bends_of(asset).count({3, 4, n + 4}), 1U);
}

TEST(SeamBends, EachOnceAtACornerOfFourCharts) {
  const ClothAsset asset = image_of(test::torus(9).flat);
  const auto bends = bends_of(asset);
  for (const Bend& b : bends) {
    EXPECT_EQ(b.size(), 3U);
    EXPECT_EQ(bends.count(b), 1U);
  }
  EXPECT_EQ(bends.size(), 7U + 7U + 2U);  // one at each of the 7 + 7 inner points of the seams, two at the corner
}

TEST(Areas, AddUpAndArePositive) {
  const uint32_t n = 9;
  const ClothAsset asset = image_of(test::fan(n, 2).flat);
  EXPECT_NEAR(std::accumulate(asset.area.begin(), asset.area.end(), 0.0), 2, 1e-6);
  for (const float a : asset.area) EXPECT_GT(a, 0);
  // A seam pixel carries only the cloth of its own side.
  EXPECT_NEAR(asset.area[4 * 2 * n + n - 1], 0.5 / 64, 0.2 / 64);
}

TEST(Areas, OfACollapsedSheetArePositiveToo) {
  FlatBuilder b = test::sheet(9);
  for (Point3& p : b.flat.position) p[0] = std::max(p[0], 0.5);
  for (const float a : image_of(b.flat).area) EXPECT_GT(a, 0);
}

TEST(Image, KnowsItsSpacing) {
  EXPECT_NEAR(image_of(test::sheet(11, 5).flat).spacing, 0.5, 1e-6);
}

// ------------------------------------------------------------------------------------------------ bind_source

/// The clean surface as if it were a file: every vertex a vertex, and one more that no face uses.
TriangleMesh as_source(FlatBuilder& b) {
  TriangleMesh mesh;
  mesh.name = "source";
  mesh.position = b.clean.position;
  mesh.triangle = b.clean.triangle;
  mesh.position.push_back({0.1, 0.2, 0.3});
  b.clean.source_point = b.clean.point;
  b.clean.source_point.push_back(kNone);
  mesh.polygon.resize(mesh.triangle.size());
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  mesh.material.emplace_back();
  mesh.part.push_back({"part", 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  return mesh;
}

std::vector<Vec3> bound_at(const ClothAsset& asset, const std::vector<Vec3>& position) {
  std::vector<Vec3> normal, out;
  compute_normals(asset, position, normal);
  evaluate_binding(asset, position, normal, out);
  return out;
}

TEST(Binding, IsExactAtRestAndTheAssetIsSound) {
  for (FlatBuilder b :
       {test::sheet(9), test::tube(9), test::closed_sphere(9), test::torus(17), test::moebius(9), test::fan(9, 3)}) {
    const TriangleMesh mesh = as_source(b);
    ClothAsset asset = image_of(b.flat);
    bind_source(mesh, b.clean, b.flat, rasterize(b.flat), asset);
    EXPECT_NO_THROW(validate(asset));
    const std::vector<Vec3> bound = bound_at(asset, asset.rest_position);
    ASSERT_EQ(bound.size(), mesh.position.size());
    for (std::size_t i = 0; i < bound.size(); ++i) {
      EXPECT_EQ(asset.source.source_vertex[i], i);
      EXPECT_LE(length(bound[i] - asset.source.position[i]), 1e-6F) << i;
      for (const float w : asset.binding[i].weight) {
        EXPECT_GE(w, 0);
        EXPECT_LE(w, 1);
      }
    }
  }
}

TEST(Binding, FollowsARigidMotion) {
  FlatBuilder b = test::tube(9);
  const TriangleMesh mesh = as_source(b);
  ClothAsset asset = image_of(b.flat);
  bind_source(mesh, b.clean, b.flat, rasterize(b.flat), asset);
  const auto move = [](const Vec3& p) { return Vec3{-p.y + 3, p.x, p.z - 1}; };  // a quarter turn about z and a step
  std::vector<Vec3> position;
  for (const Vec3& p : asset.rest_position) position.push_back(move(p));
  const std::vector<Vec3> bound = bound_at(asset, position);
  for (std::size_t i = 0; i < bound.size(); ++i) {
    EXPECT_LE(length(bound[i] - move(asset.source.position[i])), 2e-6F) << i;
  }
}

TEST(Binding, SplitsVerticesByTextureAndNormalButKeepsTheirPlace) {
  FlatBuilder b = test::sheet(9);
  TriangleMesh mesh = as_source(b);
  for (std::size_t t = 0; t < mesh.triangle.size(); ++t) {
    const double island = t < mesh.triangle.size() / 2 ? 0 : 0.5;
    mesh.uv.push_back({Point2{island, 0}, Point2{island, 0}, Point2{island, 0}});
    mesh.normal.push_back({Point3{0, 0, 1}, Point3{0, 0, 2}, Point3{0, 0, 0}});  // none is a broken file's normal
  }
  ClothAsset asset = image_of(b.flat);
  bind_source(mesh, b.clean, b.flat, rasterize(b.flat), asset);
  EXPECT_NO_THROW(validate(asset));
  EXPECT_EQ(asset.source.position.size(), mesh.position.size() + 9);
  EXPECT_EQ(asset.source.uv.size(), asset.source.position.size());
  EXPECT_EQ(asset.source.source_vertex_count, mesh.position.size());
  for (std::size_t i = 1; i < asset.binding.size(); ++i) {
    if (asset.source.source_vertex[i] != asset.source.source_vertex[i - 1]) continue;
    EXPECT_EQ(asset.binding[i].pixel, asset.binding[i - 1].pixel);
    EXPECT_EQ(asset.binding[i].weight, asset.binding[i - 1].weight);
  }
}

TEST(Binding, ComputesMissingNormals) {
  FlatBuilder b = test::sheet(9);
  const TriangleMesh mesh = as_source(b);
  ClothAsset asset = image_of(b.flat);
  bind_source(mesh, b.clean, b.flat, rasterize(b.flat), asset);
  for (std::size_t i = 0; i + 1 < asset.source.normal.size(); ++i) EXPECT_NEAR(asset.source.normal[i].z, 1, 1e-5);
}

}  // namespace
}  // namespace geocloth
