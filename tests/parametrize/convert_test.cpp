// SPDX-License-Identifier: GPL-3.0-or-later
#include "geocloth/parametrize/convert.h"

#include <array>
#include <fstream>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "report/verify.h"
#include "report/warnings.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

using testing::HasSubstr;

/// A mesh from positions and polygons, as an importer would hand it over.
TriangleMesh make_mesh(const std::string& name, std::vector<Point3> position, std::vector<Triangle> triangle) {
  TriangleMesh mesh;
  mesh.name = name;
  mesh.position = std::move(position);
  mesh.triangle = std::move(triangle);
  mesh.polygon.resize(mesh.triangle.size());
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  mesh.material.emplace_back();
  mesh.part.push_back({name, 0, 0, static_cast<uint32_t>(mesh.triangle.size())});
  return mesh;
}

/// A grid of columns x rows cells over a rectangle, bent by `shape` (u, v in 0..1); the sides may be closed.
TriangleMesh patch(const std::string& name, uint32_t columns, uint32_t rows,
                   const std::function<Point3(double u, double v)>& shape, bool close_u = false, bool close_v = false) {
  const uint32_t across = close_u ? columns : columns + 1, down = close_v ? rows : rows + 1;
  std::vector<Point3> position;
  for (uint32_t y = 0; y < down; ++y) {
    for (uint32_t x = 0; x < across; ++x) {
      position.push_back(shape(static_cast<double>(x) / columns, static_cast<double>(y) / rows));
    }
  }
  std::vector<Triangle> triangle;
  for (uint32_t y = 0; y < rows; ++y) {
    for (uint32_t x = 0; x < columns; ++x) {
      const auto at = [&](uint32_t i, uint32_t j) { return (j % down) * across + i % across; };
      const uint32_t a = at(x, y), b = at(x + 1, y), c = at(x, y + 1), d = at(x + 1, y + 1);
      triangle.push_back({a, c, d});
      triangle.push_back({a, d, b});
    }
  }
  return make_mesh(name, std::move(position), std::move(triangle));
}

TriangleMesh sheet(const Point3& origin = {0, 0, 0}, const Point3& across = {1, 0, 0},
                   const Point3& down = {0, -1, 0}) {
  return patch("sheet", 8, 8, [=](double u, double v) {
    return Point3{origin[0] + u * across[0] + v * down[0], origin[1] + u * across[1] + v * down[1],
                  origin[2] + u * across[2] + v * down[2]};
  });
}
Triangle sorted_corners(Triangle t) {
  std::ranges::sort(t);
  return t;
}
TriangleMesh tube() {
  return patch(
      "tube", 24, 10,
      [](double u, double v) {
        return Point3{0.3 * std::cos(2 * std::numbers::pi * u), -v, -0.3 * std::sin(2 * std::numbers::pi * u)};
      },
      true);
}
TriangleMesh torus() {
  return patch(
      "torus", 32, 16,
      [](double u, double v) {
        const double p = 2 * std::numbers::pi * u, q = 2 * std::numbers::pi * v, r = 1 + 0.4 * std::cos(q);
        return Point3{r * std::cos(p), 0.4 * std::sin(q), r * std::sin(p)};
      },
      true, true);
}
/// An octahedron, each face divided into 64.
TriangleMesh sphere() {
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
  const uint32_t n = 8;
  for (const double sx : {1.0, -1.0}) {
    for (const double sy : {1.0, -1.0}) {
      for (const double sz : {1.0, -1.0}) {
        const auto first = static_cast<uint32_t>(position.size());
        const auto at = [&](uint32_t i, uint32_t j) { return first + i * (2 * n + 3 - i) / 2 + j; };
        for (uint32_t i = 0; i <= n; ++i) {
          for (uint32_t j = 0; i + j <= n; ++j) {
            const double x = sx * i, y = sy * j, z = sz * (n - i - j), l = std::sqrt(x * x + y * y + z * z);
            position.push_back({x / l, y / l, z / l});
          }
        }
        for (uint32_t i = 0; i < n; ++i) {
          for (uint32_t j = 0; i + j < n; ++j) {
            triangle.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i + j + 1 < n) triangle.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
          }
        }
      }
    }
  }
  return make_mesh("sphere", std::move(position), std::move(triangle));
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh = a;
  const auto offset = static_cast<uint32_t>(a.position.size());
  mesh.position.insert(mesh.position.end(), b.position.begin(), b.position.end());
  for (const Triangle& t : b.triangle) mesh.triangle.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  return make_mesh(a.name + "_" + b.name, mesh.position, mesh.triangle);
}

ConvertOptions small(Layout layout = Layout::square) {
  ConvertOptions options;
  options.flatten.layout = layout;
  options.flatten.resolution = 40;
  return options;
}

struct Shape {
  const char* name;
  std::function<TriangleMesh()> make;
  uint32_t components, loops;
  int64_t euler;
};

class Convert : public testing::TestWithParam<std::tuple<Shape, Layout>> {};

TEST_P(Convert, KeepsTheTopologyAndBindsExactly) {
  const auto& [shape, layout] = GetParam();
  const TriangleMesh mesh = shape.make();
  const ConvertResult result = convert(mesh, small(layout));
  const ConvertReport& report = result.report;
  EXPECT_EQ(report.welded.components, shape.components);
  EXPECT_EQ(report.welded.boundary_loops, shape.loops);
  EXPECT_EQ(report.welded.euler_characteristic, shape.euler);
  EXPECT_EQ(report.quality.flipped, 0U);
  EXPECT_EQ(report.quality.copy_gap, 0);
  EXPECT_LE(report.quality.binding_error, 1e-6);
  EXPECT_GT(report.quality.psnr_db, 40);
  EXPECT_NO_THROW(validate(result.asset));
  EXPECT_NO_THROW(static_cast<void>(encode_asset(result.asset)));
  const double area = std::accumulate(result.asset.area.begin(), result.asset.area.end(), 0.0);
  double source_area = 0;
  for (const Triangle& t : mesh.triangle) {
    const Point3 &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
    const Point3 u{b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    source_area += std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2;
  }
  EXPECT_NEAR(area, source_area, 0.03 * source_area);  // the mass of the cloth
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, Convert,
    testing::Combine(
        testing::Values(Shape{"sheet", [] { return sheet(); }, 1, 1, 1}, Shape{"tube", tube, 1, 2, 0},
                        Shape{"sphere", sphere, 1, 0, 2}, Shape{"torus", torus, 1, 0, 0},
                        Shape{"two_parts",
                              [] {
                                return joined(sheet(), sheet({3, 0, 0}));
                              },
                              2, 2, 2},
                        // A pocket sewn on by its upper edge, which lies on an inner edge row of the shirt.
                        Shape{"pocket",
                              [] {
                                return joined(sheet(), sheet({0, -0.5, 0}, {1, 0, 0}, {0, -0.5, 0.5}));
                              },
                              1, 1, 1},
                        // Two sheets that touch in one point are one component of the tied surface.
                        Shape{"bow_tie",
                              [] {
                                return joined(sheet(), sheet({1, -1, 0}));
                              },
                              1, 1, 1}),
        testing::Values(Layout::square, Layout::panels)),
    [](const auto& instance) {
      return std::string(std::get<0>(instance.param).name) + "_" + to_string(std::get<1>(instance.param));
    });

TEST(ConvertReport, HasEveryKey) {
  const auto json = nlohmann::json::parse(to_json(convert(tube(), small())));
  const std::map<std::string, std::vector<std::string>> keys{
      {"source",
       {"vertices", "faces", "components", "boundary_loops", "euler_characteristic", "non_manifold_edges",
        "bow_tie_vertices", "bbox_diagonal"}},
      {"cleaned", {"vertices", "faces", "components", "boundary_loops", "euler_characteristic", "bbox_diagonal"}},
      {"represented",
       {"vertices", "faces", "components", "boundary_loops", "euler_characteristic", "orientable", "bbox_diagonal"}},
      {"image",
       {"layout", "width", "height", "valid_pixels", "charts", "spacing", "split_points", "copies_max", "utilisation",
        "border_share", "free_border_share"}},
      {"welded", {"components", "boundary_loops", "euler_characteristic", "orientable"}},
      {"quality",
       {"flipped",
        "mirrored",
        "overlapping_pixels",
        "crossing_springs",
        "copy_gap",
        "l2_stretch",
        "spring_min",
        "symmetric_dirichlet",
        "anisotropy_p95",
        "spring_max",
        "shear_deg_p50",
        "shear_deg_p95",
        "spring_p99_over_p1",
        "quad_area_p5",
        "quad_area_p95",
        "rms_error",
        "max_error",
        "psnr_db",
        "seam_length",
        "binding_error"}},
      {"seconds", {"repair", "cut", "flatten", "total"}}};
  for (const auto& [group, names] : keys) {
    ASSERT_TRUE(json.contains(group)) << group;
    for (const std::string& name : names) EXPECT_TRUE(json[group].contains(name)) << group << '.' << name;
  }
  EXPECT_TRUE(json["repairs"].is_array());
  EXPECT_TRUE(json["carried"].is_array());
  EXPECT_GT(json["peak_memory_bytes"].get<uint64_t>(), 1U << 20U);
  EXPECT_EQ(json["image"]["layout"], "square");
  EXPECT_EQ(json["welded"]["boundary_loops"], 2);
  // A tube in a square: two sides of the outline are hems, two the seam.
  EXPECT_GT(json["image"]["free_border_share"], 0.3 * json["image"]["border_share"].get<double>());
  EXPECT_LT(json["image"]["free_border_share"], 0.7 * json["image"]["border_share"].get<double>());
  EXPECT_EQ(json["source"]["faces"], 480);
}

// Of closed garments the report told of hems: pixels beside seams were taken for the garment's own edges.
TEST(ConvertReport, CountsTheGarmentsOwnEdgesAsFreeBorderAndNoSeams) {
  for (const Layout layout : {Layout::square, Layout::panels}) {
    for (const TriangleMesh& closed : {torus(), sphere()}) {
      const ImageSummary image = summarize_image(convert(closed, small(layout)).asset);
      EXPECT_GT(image.border_share, 0.05);
      EXPECT_EQ(image.free_border_share, 0);
    }
    const ImageSummary image = summarize_image(convert(sheet(), small(layout)).asset);
    EXPECT_GT(image.border_share, 0.05);
    EXPECT_EQ(image.free_border_share, image.border_share);
  }
}

// Of a mesh whose faces are wound at random an engine that culls backs would draw half, and shade the rest wrongly.
TEST(Convert, DrawsFacesTheWayRoundThatTheClothHasThem) {
  const TriangleMesh even = sheet();
  for (const bool has_normals : {false, true}) {
    TriangleMesh mesh = even;
    for (size_t t = 0; t < mesh.triangle.size(); t += 3) std::swap(mesh.triangle[t][1], mesh.triangle[t][2]);
    for (size_t t = 0; has_normals && t < mesh.triangle.size(); ++t) {
      const Point3 n{0, 0, t % 3 == 0 ? -1.0 : 1.0};
      mesh.normal.push_back({n, n, n});
    }
    const ConvertResult result = convert(mesh, small());
    ASSERT_EQ(result.asset.source.triangle.size(), even.triangle.size());
    for (size_t t = 0; t < even.triangle.size(); ++t) {
      const Triangle& drawn = result.asset.source.triangle[t];
      EXPECT_EQ(
          sorted_corners({result.asset.source.source_vertex[drawn[0]], result.asset.source.source_vertex[drawn[1]],
                          result.asset.source.source_vertex[drawn[2]]}),
          sorted_corners(even.triangle[t]));
      const auto at = [&](size_t k) { return result.asset.source.position[drawn[k]]; };
      EXPECT_GT(cross(at(1) - at(0), at(2) - at(0)).z, 0);
      for (const uint32_t v : drawn) EXPECT_EQ(result.asset.source.normal[v], (Vec3{0, 0, 1}));
    }
    EXPECT_EQ(result.asset.source.position.size(), even.position.size());
  }
}

// A garment placed in a city's coordinates: single precision is too coarse for its springs there.
TEST(Convert, BringsAMeshFromFarAwayToTheOrigin) {
  TriangleMesh mesh = tube();
  const ConvertResult near = convert(mesh, small());
  EXPECT_EQ(near.report.moved, (Point3{0, 0, 0}));
  for (Point3& p : mesh.position) p = {p[0] + 3e6, p[1], p[2] - 2e6};
  const ConvertResult far = convert(mesh, small());
  EXPECT_LE(far.report.quality.binding_error, 1e-6);
  EXPECT_NEAR(far.report.quality.spring_min, near.report.quality.spring_min, 1e-3);
  EXPECT_NEAR(far.report.moved[0], -3e6, 10);
  EXPECT_NEAR(far.report.moved[2], 2e6, 10);
  ASSERT_FALSE(far.report.warnings.empty());
  EXPECT_THAT(far.report.warnings[0], ::testing::HasSubstr("from the origin"));
  for (size_t v = 0; v < mesh.position.size(); ++v) {
    const Vec3& p = far.asset.source.position[v];
    const Point3& was = mesh.position[far.asset.source.source_vertex[v]];
    EXPECT_NEAR(double{p.x}, was[0] + far.report.moved[0], 1e-5);
    EXPECT_NEAR(double{p.z}, was[2] + far.report.moved[2], 1e-5);
  }
}

// A wrong unit twice over, or a vertex lost far away: it was laid out first and then refused by the number of a pixel.
TEST(Convert, ASizeThatNoClothHasIsRefusedWithTheRemedy) {
  for (const double scale : {1e12, 1e-25}) {
    TriangleMesh mesh = tube();
    for (Point3& p : mesh.position) p = {p[0] * scale, p[1] * scale, p[2] * scale};
    try {
      static_cast<void>(convert(mesh, small()));
      ADD_FAILURE() << scale;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::limit);
      EXPECT_THAT(e.what(), HasSubstr("--unit")) << scale;
    }
  }
}

TEST(ConvertReport, CountsTheTimeOfBothLayoutsWhereSquaresTakeOver) {
  // Panels have no pixels for the seams of a closed surface at this resolution.
  ConvertOptions options = small(Layout::panels);
  options.flatten.resolution = 8;
  const ConvertResult result = convert(torus(), options);
  std::set<std::string> stages;
  for (const auto& [stage, seconds] : result.report.seconds) {
    EXPECT_TRUE(stages.insert(stage).second) << stage << " stands twice";
    EXPECT_LE(seconds, result.report.seconds.back().second);
  }
}

TEST(ConvertReport, WarnsOfAnImplausibleSize) {
  TriangleMesh mesh = sheet({0, 0, 0}, {100, 0, 0}, {0, -100, 0});
  const auto large = convert(mesh, small()).report.warnings;
  ASSERT_FALSE(large.empty());
  EXPECT_THAT(large[0], HasSubstr("--unit"));
  EXPECT_TRUE(convert(sheet(), small()).report.warnings.empty());
}

// The asset was four pixels by five, of a spike to nowhere, and nothing said so.
TEST(ConvertReport, NamesAVertexThatIsLostFarAway) {
  TriangleMesh mesh = patch("lost", 20, 20, [](double u, double v) { return Point3{u, -v, 0.1 * std::sin(3 * u)}; });
  mesh.position[100] = {1e6, 0, 0};
  const auto warnings = convert(mesh, small(Layout::panels)).report.warnings;
  EXPECT_THAT(warnings, testing::Contains(HasSubstr("vertex 101 of the file")));
  mesh.position[100] = {3, 0, 0};
  EXPECT_THAT(convert(mesh, small(Layout::panels)).report.warnings, testing::Each(testing::Not(HasSubstr("vertex"))));
  // Of a sheet that is a few pixels across it was said that it is not developable.
  mesh.position[100] = {300, 0, 0};
  EXPECT_THAT(
      convert(mesh, small(Layout::panels)).report.warnings,
      testing::Contains(testing::AllOf(HasSubstr("vertex 101 of the file"), HasSubstr("all the rest is within"))));
}

// Half of a garment that lies flat was gone, and only a count among the repairs said so.
TEST(ConvertReport, WarnsOfLayersOfAFoldedGarmentThatAreLeftOut) {
  TriangleMesh folded = patch("folded", 8, 8, [](double u, double v) { return Point3{u, -std::abs(v - 0.5), 0}; });
  EXPECT_THAT(convert(folded, small(Layout::panels)).report.warnings,
              testing::ElementsAre(testing::AllOf(HasSubstr("64 triangles"), HasSubstr("folded flat"))));
  // As far apart as is advised, both layers are there.
  for (uint32_t i = 0; i < folded.position.size(); ++i) folded.position[i][2] = i / 9 > 4 ? 1e-4 : 0;
  const ConvertResult apart = convert(folded, small(Layout::panels));
  EXPECT_THAT(apart.report.warnings, testing::Each(testing::Not(HasSubstr("folded flat"))));
  EXPECT_NEAR(std::accumulate(apart.asset.area.begin(), apart.asset.area.end(), 0.0), 1, 0.03);
  // The two sides of cloth are no layers.
  TriangleMesh back = sheet();
  for (Triangle& t : back.triangle) std::swap(t[1], t[2]);
  EXPECT_THAT(convert(joined(sheet(), back), small(Layout::panels)).report.warnings, testing::IsEmpty());
}

TEST(ConvertReport, WarnsOfFarMorePixelsThanWereAskedFor) {
  TriangleMesh crumbs = sheet();
  for (int i = 0; i < 100; ++i) {
    const double x = 2 + 0.1 * i;
    crumbs = joined(std::move(crumbs), sheet({x, 0, 0}, {0.01, 0, 0}, {0, -0.01, 0}));
  }
  ConvertOptions options = small(Layout::square);
  options.flatten.resolution = 12;
  const auto warnings = convert(crumbs, options).report.warnings;
  EXPECT_THAT(warnings, testing::Contains(HasSubstr("where about 144 were asked for")));
  EXPECT_THAT(convert(sheet(), options).report.warnings, testing::IsEmpty());
}

// Every sequin got 5 x 5 pixels, and the dress they are on no more when they used up those that were asked for.
TEST(Convert, CrumbsLeaveTheClothItsPixelsInSquares) {
  TriangleMesh mesh = sheet();
  for (int i = 0; i < 100; ++i) {
    const double x = 0.09 * (i % 10), y = -0.09 * (i / 10);
    mesh = joined(mesh, patch("crumb", 1, 1, [=](double u, double v) {
                    return Point3{x + 0.01 * u, y - 0.01 * v, 0.1};
                  }));
  }
  ConvertOptions options = small(Layout::square);
  options.flatten.resolution = 32;
  const ClothAsset asset = convert(mesh, options).asset;
  std::vector<uint32_t> pixels(asset.chart_count, 0);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.valid(i)) ++pixels[asset.chart[i]];
  }
  EXPECT_EQ(pixels.size(), 101U);
  EXPECT_GE(*std::max_element(pixels.begin(), pixels.end()), 32U * 32 / 2);
}

// Lace or fringe at too few pixels moved badly, and only the numbers said so.
TEST(ConvertReport, WarnsOfSpringsThatStripsOfAPixelsWidthMakeUneven) {
  ConvertResult result = convert(sheet(), small(Layout::panels));
  const auto warnings = [&] { return plain_warnings(result.report, result.asset, 0); };
  EXPECT_THAT(warnings(), testing::IsEmpty());
  result.report.quality.shear_deg_p95 = 30;
  EXPECT_THAT(warnings(), testing::ElementsAre(HasSubstr("30 degrees")));
  result.report.quality.shear_deg_p95 = 3;
  result.report.quality.spring_p99_over_p1 = 2.5;
  EXPECT_THAT(warnings(), testing::ElementsAre(testing::AllOf(HasSubstr("2.5 times the shortest"),
                                                              HasSubstr("strips, holes or layers"))));
  result.report.quality.spring_p99_over_p1 = 1.4;
  result.report.quality.max_error = 0.02;
  EXPECT_THAT(warnings(), testing::ElementsAre(HasSubstr("--resolution")));
}

// "Not orientable" told no one what to do about it.
TEST(ConvertReport, SaysWhatToDoAboutAPartOfOneSide) {
  ConvertResult result = convert(sheet(), small(Layout::panels));
  result.report.represented.orientable = false;
  EXPECT_THAT(plain_warnings(result.report, result.asset, 0),
              testing::ElementsAre(testing::AllOf(HasSubstr("only one side"), HasSubstr("have to be parted"))));
}

// A ribbon that winds through its image cost five times the memory of its cloth, and nothing said so.
TEST(ConvertReport, WarnsOfAnImageThatIsMostlyEmpty) {
  ConvertResult result = convert(sheet(), small(Layout::panels));
  result.asset.height *= 4;
  result.asset.chart.resize(result.asset.pixel_count(), kNoChart);
  EXPECT_THAT(plain_warnings(result.report, result.asset, 0), testing::ElementsAre(HasSubstr("--layout uv")));
}

/// A picture of an image, for warnings that look at nothing else. @param is_cloth  of a pixel
ConvertResult image_of(bool (*is_cloth)(uint32_t x, uint32_t y)) {
  ConvertResult result = convert(sheet(), small(Layout::panels));
  ClothAsset& asset = result.asset;
  asset.width = asset.height = 60;
  asset.chart.assign(asset.pixel_count(), kNoChart);
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (is_cloth(i % asset.width, i / asset.width)) asset.chart[i] = 0;
  }
  return result;
}

// A star, a net and a straight belt that lay askew were all told that a long piece winds through their image.
TEST(ConvertReport, SaysWhyAnImageIsMostlyEmpty) {
  const auto warnings = [](bool (*is_cloth)(uint32_t x, uint32_t y), uint32_t loops) {
    ConvertResult result = image_of(is_cloth);
    result.report.represented.boundary_loops = loops;
    return plain_warnings(result.report, result.asset, 0);
  };
  const auto band = [](uint32_t x, uint32_t y) { return x < y + 6 && y < x + 6; };
  EXPECT_THAT(warnings(band, 1), testing::ElementsAre(HasSubstr("boxes around them")));
  EXPECT_THAT(warnings(band, 400), testing::ElementsAre(HasSubstr("a net")));
  EXPECT_THAT(warnings([](uint32_t x, uint32_t y) { return y % 10 < 3 || x == (y / 10 % 2 == 0 ? 59U : 0U); }, 1),
              testing::ElementsAre(HasSubstr("winds through it")));
}

// Pleats were told that they are strips or holes, and a garment of loose sequins to take more pixels, where more of
// them would have come loose.
TEST(ConvertReport, SaysWhatMakesSpringsUneven) {
  ConvertOptions options = small(Layout::panels);
  options.flatten.resolution = 48;
  constexpr uint32_t kFolds = 40;
  const TriangleMesh curtain = patch("curtain", 2 * kFolds, 40, [](double u, double v) {
    return Point3{u, -v, std::lround(u * 2 * kFolds) % 2 == 1 ? 0.02 : 0.0};
  });
  EXPECT_THAT(convert(curtain, options).report.warnings,
              testing::Contains(testing::AllOf(HasSubstr("folds or bends"), testing::Not(HasSubstr("--parts")))));

  TriangleMesh sequins = sheet();
  for (int i = 0; i < 10; ++i) {
    sequins = joined(sequins, sheet({0.1 * i, -0.5, 0.2}, {0.045, 0, 0}, {0, -0.045, 0}));
  }
  options.flatten.resolution = 32;
  ConvertResult result = convert(sequins, options);
  result.report.quality.spring_p99_over_p1 = 2.5;
  EXPECT_THAT(
      plain_warnings(result.report, result.asset, 0),
      testing::ElementsAre(testing::AllOf(HasSubstr("hardly larger"), testing::Not(HasSubstr("--resolution")))));
}

// A folded tie was called not developable: it is, away from its corners, and the layout is at fault.
TEST(ConvertReport, TellsCornersWithoutACutFromClothThatIsRound) {
  FlatSurface flat;
  flat.position = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  flat.triangle = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
  EXPECT_EQ(count_uncut_corners(flat), 1U);
  EXPECT_EQ(count_uncut_corners(convert(sphere(), small()).flat), 0U);
  ConvertResult result = convert(sheet(), small(Layout::panels));
  result.report.quality.anisotropy_p95 = 1.5;
  EXPECT_THAT(plain_warnings(result.report, result.asset, 0), testing::ElementsAre(HasSubstr("not developable")));
  result.report.uncut_corners = 4;
  EXPECT_THAT(plain_warnings(result.report, result.asset, 0),
              testing::ElementsAre(
                  testing::AllOf(HasSubstr("4 are left without"), testing::Not(HasSubstr("not developable")))));
}

// A flat shirt with stretched texture coordinates was told that it needs darts, and to take more pixels, which leave
// its springs as uneven as they are.
TEST(ConvertReport, SaysThatTextureCoordinatesAreStretchedRatherThanTheCloth) {
  TriangleMesh mesh = sheet();
  for (const Triangle& t : mesh.triangle) {
    std::array<Point2, 3>& uv = mesh.uv.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
      const double x = mesh.position[t[k]][0];
      uv[k] = {0.5 * x + 0.5 * x * x, -mesh.position[t[k]][1]};
    }
  }
  ConvertResult result = convert(mesh, small(Layout::uv));
  ASSERT_EQ(result.asset.layout, Layout::uv);
  ASSERT_GT(result.report.quality.spring_p99_over_p1, 2);
  result.report.quality.psnr_db = 65;  // as of folds
  const std::vector<std::string> warnings = plain_warnings(result.report, result.asset, 0);
  EXPECT_THAT(warnings,
              testing::Contains(testing::AllOf(HasSubstr("texture coordinates are stretched"),
                                               HasSubstr("--layout panels"), testing::Not(HasSubstr("developable")))));
  EXPECT_THAT(warnings, testing::Not(testing::Contains(HasSubstr("springs are uneven"))));
}

TEST(ConvertReport, WarnsOfASpacingThatTheClothHasNoRoomFor) {
  ConvertOptions options = small(Layout::panels);
  options.flatten.spacing = 10;
  EXPECT_THAT(convert(sheet(), options).report.warnings, testing::Contains(HasSubstr("instead of 10 m")));
}

// Two panels with a gap that no one sees fell apart in the simulation, and nothing had said so. The advice must work.
TEST(ConvertReport, WarnsOfCracksAndSaysWhatMendsThem) {
  const TriangleMesh panels = joined(sheet(), sheet({1.00234, 0, 0}));
  const ConvertResult apart = convert(panels, small(Layout::panels));
  EXPECT_EQ(apart.report.welded.components, 2U);
  ASSERT_EQ(apart.report.warnings.size(), 1U);
  const std::string& warning = apart.report.warnings[0];
  const size_t advice = warning.find("--weld ");
  ASSERT_NE(advice, std::string::npos) << warning;

  ConvertOptions options = small(Layout::panels);
  options.repair.weld_distance = std::stod(warning.substr(advice + 7));
  const ConvertResult mended = convert(panels, options);
  EXPECT_EQ(mended.report.welded.components, 1U);
  EXPECT_EQ(mended.report.welded.boundary_loops, 1U);
  EXPECT_THAT(mended.report.warnings, testing::IsEmpty());
}

// A fringe whose strips were too narrow for panels became a square, stretched eightfold, later a net of many times the
// pixels asked for.
TEST(ConvertReport, NarrowStripsAreCutOffRatherThanGivenMorePixelsOrASquare) {
  TriangleMesh fringe = patch("fringe", 80, 30, [](double u, double v) {
    return Point3{u, -0.6 * v, 0.02 * std::sin(6 * u)};
  });
  std::erase_if(fringe.triangle, [&](const Triangle& t) {
    double x = 0, y = 0;
    for (const uint32_t v : t) {
      x += fringe.position[v][0] / 3;
      y += fringe.position[v][1] / 3;
    }
    return y < -0.1 && static_cast<int>(80 * x) % 4 == 3;
  });
  fringe = make_mesh("fringe", fringe.position, fringe.triangle);
  ConvertOptions options = small(Layout::panels);
  options.flatten.resolution = 32;
  const ConvertResult result = convert(fringe, options);
  EXPECT_EQ(result.asset.layout, Layout::panels);
  EXPECT_LT(result.report.quality.l2_stretch, 1.05);
  EXPECT_THAT(result.report.warnings, testing::Each(testing::Not(HasSubstr("more pixels than asked for"))));
  EXPECT_LT(count_valid_pixels(result.asset), 3U * 32 * 32 / 2);
}

TEST(ConvertReport, SaysWhatTheFileHasAndTheGarmentHasNot) {
  TriangleMesh mesh = sheet();
  mesh.left_out = {"two buttons are left out"};
  EXPECT_THAT(convert(mesh, small()).report.warnings, testing::Contains("two buttons are left out"));
}

TEST(ConvertReport, NamesThePartThatIsStretched) {
  TriangleMesh mesh = joined(sheet(), sheet({3, 0, 0}, {1, 0, 0}, {0, -8, 0}));
  mesh.part = {{"front", 0, 0, 128}, {"belt", 0, 128, 128}};
  ConvertOptions options = small(Layout::square);
  options.flatten.resolution = 90;
  const ConvertReport report = convert(mesh, options).report;
  ASSERT_EQ(report.parts.size(), 2U);
  EXPECT_EQ(report.parts[0].name, "front");
  EXPECT_EQ(report.parts[0].faces, 128U);
  EXPECT_LT(report.parts[0].stretched_share, 0.05);   // flat and square
  EXPECT_GT(report.parts[1].stretched_share, 0.999);  // eight times as long as wide
  EXPECT_NEAR(report.parts[0].area_share + report.parts[1].area_share, 1, 1e-9);
  std::string warnings;
  for (const std::string& warning : report.warnings) warnings += warning + '\n';
  EXPECT_THAT(warnings, HasSubstr("mostly in part 'belt'"));
  EXPECT_THAT(warnings, testing::Not(HasSubstr("'front'")));
}

TEST(ConvertReport, WarnsNotOfStretchWhereAGarmentIsDevelopable) {
  EXPECT_THAT(convert(tube(), small(Layout::panels)).report.warnings, testing::IsEmpty());
}

TEST(Convert, GivesTheSameBitsEveryTime) {
  EXPECT_EQ(encode_asset(convert(torus(), small()).asset), encode_asset(convert(torus(), small()).asset));
}

TEST(Convert, ShowsEveryStageAndStopsWhenAsked) {
  std::set<std::string> stages;
  static_cast<void>(convert(sheet(), small(), [&](std::string_view stage, double fraction) {
    EXPECT_GE(fraction, 0);
    EXPECT_LE(fraction, 1);
    stages.emplace(stage);
  }));
  EXPECT_GE(stages.size(), 6U);
  for (const std::string& stop : stages) {
    try {
      static_cast<void>(convert(sheet(), small(), [&](std::string_view stage, double) {
        if (stage == stop) throw Error(ErrorCode::cancelled, "stopped by the user");
      }));
      ADD_FAILURE() << stop << " did not stop";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
  }
}

TEST(Convert, NamesTheFileInItsErrors) {
  try {
    static_cast<void>(convert(std::filesystem::path("no/such/garment.obj")));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::io);
    EXPECT_THAT(e.what(), HasSubstr("no/such/garment.obj"));
  }
}

TEST(Convert, WritesItsStages) {
  const test::TemporaryFolder folder;
  ConvertOptions options = small();
  options.stages = folder.path() / "deep" / "stages";
  const ConvertResult result = convert(tube(), options);
  for (const char* name : {"1_import.obj", "2_clean.obj", "3_cut.obj", "4_flat.obj", "5_image.obj", "6_welded.obj"}) {
    std::ifstream in(options.stages / name);
    std::string line;
    uint32_t faces = 0;
    while (std::getline(in, line)) faces += line.starts_with("f ") ? 1U : 0U;
    EXPECT_GT(faces, 0U) << name;
  }
  std::ifstream csv(options.stages / "5_splits.csv");
  std::string line;
  uint32_t lines = 0;
  while (std::getline(csv, line)) ++lines;
  EXPECT_EQ(lines, 1 + result.asset.splits.pixel.size());
}

// ------------------------------------------------------------------------------------------------ verification

/// A finished conversion, taken apart so that a test can spoil it.
struct Finished {
  TriangleMesh mesh = tube();
  RepairResult repaired = repair_mesh(mesh);
  FlatSurface flat;
  Raster raster;
  ConvertResult result;

  Finished() : result(convert(mesh, small())) {
    flat = result.flat;
    raster = rasterize(flat);
  }
  void check() {
    const GridMesh grid = welded_grid_mesh(result.asset, result.asset.rest_position);
    result.report.welded = measure_topology(grid.triangle, static_cast<uint32_t>(grid.position.size()));
    verify(mesh, repaired.surface, flat, raster, result.asset, result.report);
  }
  std::string refusal() {
    try {
      check();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::verification);
      return e.what();
    }
    return "";
  }
};

TEST(Verify, AcceptsWhatConvertMade) {
  Finished f;
  EXPECT_NO_THROW(f.check());
}

TEST(Verify, RefusesALostWeldAndNamesThePart) {
  Finished f;
  f.result.asset.splits = {};
  EXPECT_THAT(f.refusal(), testing::AllOf(HasSubstr("'tube'"), HasSubstr("--resolution")));
}

TEST(Verify, RefusesALostTriangle) {
  Finished f;
  f.result.asset.cell[f.result.asset.width * 5 + 5] = kCellFirst;
  EXPECT_THAT(f.refusal(), HasSubstr("boundary loops"));
}

TEST(Verify, RefusesFlipsOverlapsCrossingsAndGaps) {
  const auto spoilt = [](const std::function<void(Finished&)>& spoil) {
    Finished f;
    spoil(f);
    return f.refusal();
  };
  EXPECT_THAT(spoilt([](Finished& f) {
                f.result.report.quality.flipped = 1;
                std::swap(f.flat.uv[f.flat.triangle[7][0]], f.flat.uv[f.flat.triangle[7][1]]);
              }),
              HasSubstr("flipped"));
  EXPECT_THAT(spoilt([](Finished& f) { f.raster.overlapping.push_back(5); }), HasSubstr("covered twice"));
  EXPECT_THAT(spoilt([](Finished& f) { f.result.report.quality.crossing_springs = 1; }), HasSubstr("springs"));
  EXPECT_THAT(spoilt([](Finished& f) { f.result.report.quality.copy_gap = 1e-6; }), HasSubstr("apart"));
  EXPECT_THAT(spoilt([](Finished& f) { f.result.report.quality.mirrored = 1; }), HasSubstr("mirrored"));
}

// ------------------------------------------------------------------------------------------------ real garments

class SharedGarment : public testing::TestWithParam<std::tuple<const char*, Layout>> {};

TEST_P(SharedGarment, Converts) {
  const std::filesystem::path path =
      std::filesystem::path(GEOCLOTH_SOURCE_DIR) / ".." / "shared" / "meshes" / "garments" / std::get<0>(GetParam());
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  ConvertOptions options;
  options.flatten.layout = std::get<1>(GetParam());
  const ConvertResult result = convert(path, options);
  const ConvertReport& r = result.report;
  EXPECT_EQ(r.welded.components, r.represented.components);
  EXPECT_EQ(r.welded.boundary_loops, r.represented.boundary_loops);
  EXPECT_EQ(r.welded.euler_characteristic, r.represented.euler_characteristic);
  EXPECT_LE(r.quality.binding_error, 1e-6);
  EXPECT_GT(r.quality.psnr_db, 55);
}

INSTANTIATE_TEST_SUITE_P(Garments, SharedGarment,
                         testing::Combine(testing::Values("newton_unisex_shirt.obj", "mh_tee_shorts.obj",
                                                          "kaykit_knight_cape.glb", "codimipc_circle_skirt.obj",
                                                          "diffcloth_dress_5k.obj", "sf_sweater.glb"),
                                          testing::Values(Layout::square, Layout::panels)),
                         [](const auto& instance) {
                           const std::string name = std::get<0>(instance.param);
                           return name.substr(0, name.find('.')) + "_" + to_string(std::get<1>(instance.param));
                         });

}  // namespace
}  // namespace geocloth
