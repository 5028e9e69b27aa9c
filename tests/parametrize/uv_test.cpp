// SPDX-License-Identifier: GPL-3.0-or-later
// A garment's own texture coordinates: a sewing pattern must be told from a painter's atlas, and what cannot be laid
// out must be refused for the true reason.
#include "geocloth/parametrize/uv.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/convert.h"
#include "geocloth/parametrize/repair.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

constexpr double kPi = std::numbers::pi;
const std::filesystem::path kGarments =
    std::filesystem::path(GEOCLOTH_SOURCE_DIR) / ".." / "shared" / "meshes" / "garments";

CleanSurface sheet(uint32_t nx, uint32_t ny, double width = 1, double height = 1) {
  CleanSurface surface = test::disk(nx, ny, width, height);
  for (Point3& p : surface.position) p[2] = 0;
  return surface;
}

/// Gives every corner the coordinates of its position, a function of place and of the triangle's middle.
CleanSurface with_uv(CleanSurface surface, const std::function<Point2(const Point3&, const Point3&)>& uv) {
  for (const auto& [a, b, c] : surface.triangle) {
    const Point3 &p = surface.position[a], &q = surface.position[b], &r = surface.position[c];
    Point3 middle{};
    for (size_t k = 0; k < 3; ++k) middle[k] = (p[k] + q[k] + r[k]) / 3;
    surface.uv.push_back({uv(p, middle), uv(q, middle), uv(r, middle)});
  }
  return surface;
}

/// A tube about +y unrolled, cut open where the angle jumps. [m] times `scale`; v runs down.
/// @param seam  angle of the cut, from -x
Point2 unrolled(const Point3& p, const Point3& middle, double radius, double scale, double seam) {
  const auto angle_of = [&](const Point3& q) { return std::remainder(std::atan2(q[2], q[0]) - seam, 2 * kPi); };
  double angle = angle_of(p);
  const double there = angle_of(middle);
  if (angle - there > kPi) angle -= 2 * kPi;
  if (there - angle > kPi) angle += 2 * kPi;
  return {-angle * radius * scale, -p[1] * scale};
}

CleanSurface sleeve(double scale, double seam = 0) {
  return with_uv(test::cylinder(48, 20, 0.1, 0.6),
                 [&](const Point3& p, const Point3& m) { return unrolled(p, m, 0.1, scale, seam); });
}

TEST(Uv, AnUnrolledSleeveIsASewingPattern) {
  const UvPattern pattern = read_uv_pattern(sleeve(0.01));
  EXPECT_EQ(pattern.refusal, "");
  EXPECT_TRUE(pattern.is_sewing_pattern);
  ASSERT_EQ(pattern.island.size(), 1U);
  EXPECT_NEAR(pattern.island[0].energy, 4, 0.01);
  EXPECT_NEAR(pattern.island[0].scale, 100, 0.5);  // back to metres, but for the chords of the tube
  EXPECT_FALSE(pattern.island[0].mirrored);
  EXPECT_EQ(pattern.seam.size(), 19U);  // one edge per row of quads
}

// Programs draw pieces face down as well; the cloth is the same.
TEST(Uv, APatternDrawnFaceDownIsKnown) {
  CleanSurface surface = sleeve(1);
  for (auto& corners : surface.uv) {
    for (Point2& p : corners) p[0] = -p[0];
  }
  const UvPattern pattern = read_uv_pattern(surface);
  EXPECT_TRUE(pattern.is_sewing_pattern);
  ASSERT_EQ(pattern.island.size(), 1U);
  EXPECT_TRUE(pattern.island[0].mirrored);
}

// Left and right half over one piece of texture, as painters like it: two pieces that touch at the fold.
TEST(Uv, HalvesThatShareTheirTextureAreTwoPieces) {
  const CleanSurface surface = with_uv(sheet(21, 21, 1, 1), [](const Point3& p, const Point3&) -> Point2 {
    return {std::abs(p[0] - 0.5), p[1]};
  });
  const UvPattern pattern = read_uv_pattern(surface);
  EXPECT_EQ(pattern.refusal, "");
  ASSERT_EQ(pattern.island.size(), 2U);
  EXPECT_NE(pattern.island[0].mirrored, pattern.island[1].mirrored);
  EXPECT_EQ(pattern.seam.size(), 20U);
}

TEST(Uv, APaintersAtlasIsNoSewingPattern) {
  // Two halves at different scales: each without distortion, but not drawn to one scale.
  const CleanSurface surface = with_uv(sheet(21, 21, 1, 1), [](const Point3& p, const Point3& middle) -> Point2 {
    const double scale = middle[0] < 0.5 ? 1 : 2;
    return {scale * p[0], -scale * p[1]};
  });
  const UvPattern pattern = read_uv_pattern(surface);
  EXPECT_EQ(pattern.refusal, "");
  EXPECT_EQ(pattern.island.size(), 2U);
  EXPECT_FALSE(pattern.is_sewing_pattern);
}

TEST(Uv, SaysThatThereAreNone) {
  EXPECT_NE(read_uv_pattern(sheet(4, 4)).refusal.find("no texture coordinates"), std::string::npos);
}

TEST(Uv, SaysThatTheyDistort) {
  const CleanSurface surface = with_uv(sheet(11, 11), [](const Point3& p, const Point3&) -> Point2 {
    return {3 * p[0], -p[1]};
  });
  EXPECT_NE(read_uv_pattern(surface).refusal.find("distort"), std::string::npos);
}

TEST(Uv, SaysThatTheyAreInFragments) {
  const CleanSurface surface = with_uv(sheet(11, 11), [](const Point3& p, const Point3& middle) -> Point2 {
    return {p[0] + 10 * middle[0], -p[1] + 10 * middle[1]};
  });
  EXPECT_NE(read_uv_pattern(surface).refusal.find("200 fragments"), std::string::npos);
}

TEST(Uv, SaysThatTrianglesAreFlipped) {
  // Vertices here and there pushed across the triangles beside them.
  const CleanSurface surface = with_uv(sheet(41, 41, 1, 1), [](const Point3& p, const Point3&) -> Point2 {
    const bool pushed = std::lround(40 * p[0]) % 4 == 0 && std::lround(40 * p[1]) % 4 == 0;
    return {p[0] + (pushed ? 1.5 / 40 : 0), -p[1]};
  });
  EXPECT_NE(read_uv_pattern(surface).refusal.find("flipped"), std::string::npos);
}

// Of thousands of triangles a few are flipped: where to look for them has to be said.
TEST(Uv, SaysWhereATriangleIsFlipped) {
  CleanSurface surface = with_uv(sheet(41, 41, 1, 1), [](const Point3& p, const Point3&) -> Point2 {
    const bool pushed = p[0] > 0.7 && std::lround(40 * p[0]) % 4 == 0 && std::lround(40 * p[1]) % 4 == 0;
    return {p[0] + (pushed ? 1.5 / 40 : 0), -p[1]};
  });
  const std::string refusal = read_uv_pattern(surface).refusal;
  const size_t place = refusal.find("one of them at (0.");
  ASSERT_NE(place, std::string::npos) << refusal;
  EXPECT_GT(std::stod(refusal.substr(place + 16)), 0.65);
}

// The corners that repair turns round, splits or inserts keep their place in the texture.
TEST(Uv, CountsTrianglesWithoutAreaOnce) {
  const CleanSurface surface = with_uv(sheet(6, 5), [](const Point3&, const Point3&) { return Point2{0.5, 0.5}; });
  const std::string count = std::to_string(surface.triangle.size());
  EXPECT_TRUE(read_uv_pattern(surface).refusal.starts_with(count + " triangles are"))
      << read_uv_pattern(surface).refusal;
}

TEST(Uv, RepairCarriesThemAlong) {
  TriangleMesh mesh;
  // Two squares side by side; the right one has a vertex more on the common edge, and is wound the wrong way.
  mesh.position = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}, {1, 0.5, 0}};
  mesh.triangle = {{0, 1, 2}, {0, 2, 3}, {4, 1, 6}, {4, 6, 5}, {5, 6, 2}};
  for (const Triangle& t : mesh.triangle) {
    mesh.polygon.push_back(static_cast<uint32_t>(mesh.polygon.size()));
    std::array<Point2, 3> uv{};
    for (size_t k = 0; k < 3; ++k) uv[k] = {mesh.position[t[k]][0] / 4, 1 - mesh.position[t[k]][1] / 4};
    mesh.uv.push_back(uv);
  }
  mesh.part = {{"", 0, 0, 5}};
  const CleanSurface surface = repair_mesh(mesh).surface;
  ASSERT_EQ(surface.uv.size(), surface.triangle.size());
  ASSERT_EQ(surface.triangle.size(), 6U);
  for (size_t t = 0; t < surface.uv.size(); ++t) {
    for (size_t k = 0; k < 3; ++k) {
      const Point3& p = surface.position[surface.triangle[t][k]];
      EXPECT_NEAR(surface.uv[t][k][0], p[0] / 4, 1e-12);
      EXPECT_NEAR(surface.uv[t][k][1], 1 - p[1] / 4, 1e-12);
    }
  }
  const UvPattern pattern = read_uv_pattern(surface);
  EXPECT_EQ(pattern.island.size(), 1U);
  EXPECT_NEAR(pattern.energy, 4, 1e-9);
}

FlatSurface flatten_uv(const CleanSurface& surface) {
  const CutSurface cut = cut_to_disks(surface, {.extra_edges = read_uv_pattern(surface).seam});
  return flatten(surface, cut, {.layout = Layout::uv, .resolution = 64});
}

std::string refusal_of(const CleanSurface& surface) {
  try {
    (void)flatten_uv(surface);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::unsupported);
    return e.what();
  }
  return "";
}

/// Every edge of the charts is as long as on the cloth, within a share; triangles lie face up.
void expect_isometric(const FlatSurface& flat, double tolerance) {
  for (size_t t = 0; t < flat.triangle.size(); ++t) {
    const Triangle& k = flat.triangle[t];
    const double spacing = flat.charts[flat.chart[t]].spacing;
    const Point2 &a = flat.uv[k[0]], &b = flat.uv[k[1]], &c = flat.uv[k[2]];
    EXPECT_LT((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]), 0);  // v runs down
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t v = k[i], w = k[(i + 1) % 3];
      const Point3 &p = flat.position[v], &q = flat.position[w];
      const double in_space = std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
      const double in_plane = spacing * std::hypot(flat.uv[v][0] - flat.uv[w][0], flat.uv[v][1] - flat.uv[w][1]);
      EXPECT_NEAR(in_plane, in_space, tolerance * in_space);
    }
  }
}

TEST(UvLayout, ASleeveLiesAsInItsPattern) {
  const FlatSurface flat = flatten_uv(sleeve(0.01));
  ASSERT_EQ(flat.charts.size(), 1U);
  expect_isometric(flat, 0.01);
  for (size_t v = 1; v < flat.uv.size(); ++v) {  // the pattern's up is the image's up
    EXPECT_NEAR((flat.uv[v][1] - flat.uv[0][1]) * flat.charts[0].spacing, flat.position[0][1] - flat.position[v][1],
                0.01 * 0.6);
  }
}

// Pieces at different scales, one of them face down: the cloth has one.
TEST(UvLayout, PiecesAreScaledToMetresAndTurnedFaceUp) {
  const CleanSurface surface = with_uv(sheet(21, 21, 1, 1), [](const Point3& p, const Point3& middle) -> Point2 {
    const double scale = middle[0] < 0.5 ? -0.02 : 7;
    return {scale * p[0], -std::abs(scale) * p[1]};
  });
  const FlatSurface flat = flatten_uv(surface);
  ASSERT_EQ(flat.charts.size(), 2U);
  expect_isometric(flat, 0.01);
}

TEST(UvLayout, RefusesWithReasonAndRemedy) {
  EXPECT_NE(refusal_of(sheet(4, 4)).find("no texture coordinates"), std::string::npos);
  EXPECT_NE(refusal_of(sheet(4, 4)).find("--layout panels"), std::string::npos);
  // A belt wound round one and a quarter times.
  const CleanSurface belt = with_uv(sheet(161, 3, 1.25 * 2 * kPi, 0.05), [](const Point3& p, const Point3&) {
    const double r = 1 - p[1];
    return Point2{r * std::cos(p[0]), r * std::sin(p[0])};
  });
  EXPECT_NE(refusal_of(belt).find("overlap"), std::string::npos);
}

TEST(UvLayout, WantsItsSeamsCut) {
  const CleanSurface halves = with_uv(sheet(21, 21, 1, 1), [](const Point3& p, const Point3&) -> Point2 {
    return {std::abs(p[0] - 0.5), p[1]};
  });
  try {
    (void)flatten(halves, cut_to_disks(halves), {.layout = Layout::uv, .resolution = 32});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
  }
}

// What a file holds, as counted by another program (INDEX.tsv).
struct Expected {
  const char* file;
  size_t islands;  // 0: refused
  bool sewing_pattern;
};
class SharedUv : public ::testing::TestWithParam<Expected> {};

TEST_P(SharedUv, IsJudged) {
  const std::filesystem::path path = kGarments / GetParam().file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const UvPattern pattern = read_uv_pattern(repair_mesh(import_mesh(path)).surface);
  EXPECT_EQ(pattern.refusal.empty(), GetParam().islands > 0) << pattern.refusal;
  if (GetParam().islands > 0) {
    EXPECT_EQ(pattern.island.size(), GetParam().islands);
  }
  EXPECT_EQ(pattern.is_sewing_pattern, GetParam().sewing_pattern);
}

// Panels are cut where the garment's tailor did, not somewhere else along the sleeve.
TEST(UvLayout, PanelsAreCutAlongASewingPattern) {
  for (const double seam : {0.0, 2.0}) {
    const CleanSurface surface = sleeve(0.01, seam);
    TriangleMesh mesh;
    mesh.name = "sleeve";
    mesh.position = surface.position;
    mesh.triangle = surface.triangle;
    mesh.uv = surface.uv;
    for (uint32_t t = 0; t < mesh.triangle.size(); ++t) mesh.polygon.push_back(t);
    mesh.material.emplace_back();
    mesh.part = {{"sleeve", 0, 0, static_cast<uint32_t>(mesh.triangle.size())}};
    ConvertOptions options;
    options.flatten.resolution = 64;
    const ConvertResult result = convert(mesh, options);
    EXPECT_EQ(result.asset.layout, Layout::panels);
    const SplitVertexTable& splits = result.asset.splits;
    ASSERT_GT(splits.rows(), 10U);
    for (size_t row = 0; row < splits.rows(); ++row) {
      const Vec3& p = result.asset.rest_position[splits.pixel[splits.offset[row]]];
      EXPECT_NEAR(std::abs(std::remainder(std::atan2(p.z, p.x) - seam, 2 * kPi)), kPi, 0.2);
    }
  }
}

/// Converts with the file's own pieces; what convert() checks (topology, flips, overlap) must hold.
TEST(UvLayout, SharedGarmentsConvert) {
  for (const auto& [file, pieces] : {std::pair{"sf_man_shorts.glb", 16U}, {"mh_tee_shorts.obj", 9U}}) {
    const std::filesystem::path path = kGarments / file;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
    ConvertOptions options;
    options.flatten.layout = Layout::uv;
    options.flatten.resolution = 64;
    const ConvertResult result = convert(path, options);
    EXPECT_EQ(result.asset.layout, Layout::uv);
    EXPECT_EQ(result.asset.chart_count, pieces);
    EXPECT_LT(result.report.quality.symmetric_dirichlet, 4.2);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Garments, SharedUv,
    ::testing::Values(Expected{"codimipc_dress_panels.obj", 14, true}, Expected{"sf_man_shorts.glb", 16, true},
                      Expected{"mh_skirt_tube.obj", 1, true}, Expected{"mh_jacket_trousers.obj", 21, true},
                      Expected{"mh_suit_elegant.obj", 23, false}, Expected{"sf_sweater.glb", 5, false},
                      Expected{"diffcloth_tshirt.obj", 0, false}, Expected{"kaykit_mage_hat.gltf", 0, false}),
    [](const auto& test) {
      std::string name = test.param.file;
      std::replace(name.begin(), name.end(), '.', '_');
      return name;
    });

}  // namespace
}  // namespace geocloth
