// SPDX-License-Identifier: GPL-3.0-or-later
// validate() stands between a broken file and a solver that would read out of bounds: every invariant that is broken on
// purpose is refused by name. Normals and binding follow the cloth.
#include "geocloth/asset/cloth_asset.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "sample_asset.h"
#include "support/make_sheet.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::sample_asset;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Break {
  const char* name;
  const char* element;  ///< what the message has to name
  std::function<void(ClothAsset&)> apply;
};

uint32_t invalid_pixel(const ClothAsset& asset) {
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (!asset.valid(i)) return i;
  }
  return kNoPixel;
}

const Break kBreaks[] = {
    {"no width", "image", [](ClothAsset& a) { a.width = 0; }},
    {"too wide", "image", [](ClothAsset& a) { a.width = kMaxImageSide + 1; }},
    {"sizes overflow", "image", [](ClothAsset& a) { a.width = a.height = 0x10000; }},
    {"no spacing", "spacing", [](ClothAsset& a) { a.spacing = 0; }},
    {"spacing NaN", "spacing", [](ClothAsset& a) { a.spacing = kNan; }},
    {"short positions", "rest_position", [](ClothAsset& a) { a.rest_position.pop_back(); }},
    {"long charts", "chart", [](ClothAsset& a) { a.chart.push_back(0); }},
    {"short springs", "spring_mask", [](ClothAsset& a) { a.spring_mask.clear(); }},
    {"short cells", "cell", [](ClothAsset& a) { a.cell.pop_back(); }},
    {"short areas", "area", [](ClothAsset& a) { a.area.pop_back(); }},
    {"chart number", "chart[0]", [](ClothAsset& a) { a.chart[0] = 77; }},
    {"chart count", "chart_count", [](ClothAsset& a) { a.chart_count = kNoChart; }},
    {"position NaN", "rest_position[0]", [](ClothAsset& a) { a.rest_position[0].y = kNan; }},
    {"position infinite", "rest_position[0]", [](ClothAsset& a) { a.rest_position[0].z = kInfinity; }},
    {"position absurd", "rest_position[0]", [](ClothAsset& a) { a.rest_position[0].z = 1e30F; }},
    {"area zero", "area[0]", [](ClothAsset& a) { a.area[0] = 0; }},
    {"area NaN", "area[0]", [](ClothAsset& a) { a.area[0] = kNan; }},
    {"area of nothing", "area", [](ClothAsset& a) { a.area[invalid_pixel(a)] = 1; }},
    {"position of nothing", "rest_position", [](ClothAsset& a) { a.rest_position[invalid_pixel(a)].x = 1; }},
    {"unknown spring", "spring_mask[0]", [](ClothAsset& a) { a.spring_mask[0] |= 0x40; }},
    {"spring over the edge", "spring_mask", [](ClothAsset& a) { a.spring_mask.back() |= kSpringRight; }},
    {"spring to the left of column 0", "spring_mask[0]", [](ClothAsset& a) { a.spring_mask[0] |= kSpringDownLeft; }},
    {"spring of nothing", "spring_mask", [](ClothAsset& a) { a.spring_mask[invalid_pixel(a)] = kSpringDown; }},
    {"spring across charts", "spring_mask[2]", [](ClothAsset& a) { a.spring_mask[2] |= kSpringRight2; }},
    {"unknown cell bit", "cell[0]", [](ClothAsset& a) { a.cell[0] |= 0x80; }},
    {"cell in the last row", "cell", [](ClothAsset& a) { a.cell.back() = kCellFirst; }},
    {"cell in the last column", "cell", [](ClothAsset& a) { a.cell[a.width - 1] = kCellFirst; }},
    {"cell over nothing", "triangle", [](ClothAsset& a) { a.cell[2] = kCellFirst | kCellSecond; }},
    {"table start", "splits.offset[0]", [](ClothAsset& a) { a.splits.offset[0] = 1; }},
    {"table end", "splits.offset", [](ClothAsset& a) { a.splits.offset.back() += 1; }},
    {"table backwards", "splits row", [](ClothAsset& a) { a.splits.offset[1] = 0xFFFFFFF0U; }},
    {"row of one", "splits row", [](ClothAsset& a) { a.splits.offset[1] = 1; }},
    {"table without rows", "splits.pixel", [](ClothAsset& a) { a.splits.offset.clear(); }},
    {"copy out of range", "splits.pixel", [](ClothAsset& a) { a.splits.pixel[1] = a.pixel_count(); }},
    {"copy not valid", "splits.pixel[0]", [](ClothAsset& a) { a.splits.pixel[0] = invalid_pixel(a); }},
    {"copy twice", "splits.pixel", [](ClothAsset& a) { a.splits.pixel[2] = a.splits.pixel[0]; }},
    {"copies descend", "splits.pixel[1]", [](ClothAsset& a) { std::swap(a.splits.pixel[0], a.splits.pixel[1]); }},
    {"copies apart", "splits.pixel[1]",
     [](ClothAsset& a) {
       float& y = a.rest_position[a.splits.pixel[1]].y;
       y = std::nextafter(y, 10.F);
     }},
    {"rows out of order", "splits row 1",
     [](ClothAsset& a) {
       std::swap(a.splits.pixel[0], a.splits.pixel[2]);
       std::swap(a.splits.pixel[1], a.splits.pixel[3]);
     }},
    {"bend out of range", "seam_bends[0]", [](ClothAsset& a) { a.seam_bends[0].a = kNoPixel; }},
    {"bend of nothing", "seam_bends[0]", [](ClothAsset& a) { a.seam_bends[0].b = invalid_pixel(a); }},
    {"bend of two", "seam_bends[0]", [](ClothAsset& a) { a.seam_bends[0].b = a.seam_bends[0].a; }},
    {"sewing out of range", "sewing[0]",
     [](ClothAsset& a) {
       a.sewing = {{kNoPixel, 0}};
     }},
    {"sewing of nothing", "sewing[0]",
     [](ClothAsset& a) {
       a.sewing = {{invalid_pixel(a), a.splits.pixel[0]}};
     }},
    {"sewing of one", "sewing[0]",
     [](ClothAsset& a) {
       a.sewing = {{a.splits.pixel[0], a.splits.pixel[0]}};
     }},
    {"bend length", "seam_bends[0]", [](ClothAsset& a) { a.seam_bends[0].rest_length = -1; }},
    {"no source", "source.position", [](ClothAsset& a) { a.source = {}; }},
    {"few normals", "source.normal", [](ClothAsset& a) { a.source.normal.pop_back(); }},
    {"few uv", "source.uv", [](ClothAsset& a) { a.source.uv.pop_back(); }},
    {"few source vertices", "source.source_vertex", [](ClothAsset& a) { a.source.source_vertex.pop_back(); }},
    {"source position", "source.position[3]", [](ClothAsset& a) { a.source.position[3].x = kNan; }},
    {"source normal", "source.normal[3]", [](ClothAsset& a) { a.source.normal[3] = {}; }},
    {"source normal NaN", "source.normal[3]", [](ClothAsset& a) { a.source.normal[3].x = kNan; }},
    {"source uv", "source.uv[3]", [](ClothAsset& a) { a.source.uv[3].x = kInfinity; }},
    {"source vertex", "source.source_vertex[3]", [](ClothAsset& a) { a.source.source_vertex[3] = 4000; }},
    {"triangle", "source.triangle[1]", [](ClothAsset& a) { a.source.triangle[1][2] = 4000; }},
    {"part gap", "source.part[1]", [](ClothAsset& a) { a.source.part[1].first_triangle += 1; }},
    {"part short", "source.part", [](ClothAsset& a) { a.source.part[1].triangle_count -= 1; }},
    {"part empty", "source.part[2]",
     [](ClothAsset& a) {
       a.source.part.push_back({"none", 0, static_cast<uint32_t>(a.source.triangle.size()), 0});
     }},
    {"part material", "source.part.material[0]", [](ClothAsset& a) { a.source.part[0].material = 9; }},
    {"material colour", "source.material[0]", [](ClothAsset& a) { a.source.material[0].base_color[1] = 2; }},
    {"material roughness", "source.material[0]", [](ClothAsset& a) { a.source.material[0].roughness = kNan; }},
    {"material image", "source.material.image[0]", [](ClothAsset& a) { a.source.material[0].base_color_image = 5; }},
    {"material cutoff", "source.material[0]", [](ClothAsset& a) { a.source.material[0].alpha_cutoff = -1; }},
    {"material modes", "source.material[2]", [](ClothAsset& a) { a.source.material[2].alpha_mask = true; }},
    {"image type", "source.image[0]", [](ClothAsset& a) { a.source.image[0].mime_type = "image/jpeg"; }},
    {"image bytes", "source.image[0]", [](ClothAsset& a) { a.source.image[0].bytes.resize(7); }},
    {"few bindings", "binding", [](ClothAsset& a) { a.binding.pop_back(); }},
    {"binding pixel", "binding[2]", [](ClothAsset& a) { a.binding[2].pixel[1] = a.pixel_count(); }},
    {"binding to nothing", "binding[2]", [](ClothAsset& a) { a.binding[2].pixel[1] = invalid_pixel(a); }},
    {"binding weights", "binding[2]", [](ClothAsset& a) { a.binding[2].weight[1] += 0.5F; }},
    {"binding weight NaN", "binding[2]", [](ClothAsset& a) { a.binding[2].weight[0] = kNan; }},
    {"binding offset", "binding[2]", [](ClothAsset& a) { a.binding[2].offset.z = kInfinity; }},
    {"middle", "source.middle[1]",
     [](ClothAsset& a) {
       a.source.middle = {{0, 1}, {2, a.source.source_vertex_count - 1}};
     }},
    {"middles", "source.middle", [](ClothAsset& a) { a.source.middle.resize(a.source.source_vertex_count + 1); }},
    {"group", "vertex_groups[0]", [](ClothAsset& a) { a.vertex_groups[0].source_vertex[0] = 1000; }},
    {"paint", "paint", [](ClothAsset& a) { a.paint.pop_back(); }},
};

class Validate : public testing::TestWithParam<Break> {};

TEST_P(Validate, RefusesAndNamesTheElement) {
  ClothAsset asset = sample_asset();
  GetParam().apply(asset);
  try {
    validate(asset);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_data);
    EXPECT_THAT(error.what(), testing::HasSubstr(GetParam().element));
  }
}

INSTANTIATE_TEST_SUITE_P(Broken, Validate, testing::ValuesIn(kBreaks), [](const auto& broken) {
  std::string name = broken.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

TEST(ClothAsset, TheSampleIsValid) {
  EXPECT_NO_THROW(validate(sample_asset()));
  EXPECT_EQ(count_valid_pixels(sample_asset()), 36U);
}

TEST(ClothAsset, NormalsOfCopiesAgreeBitForBitOnACurvedSeam) {
  const ClothAsset asset = test::make_tube({.nx = 16, .ny = 6});
  std::vector<Vec3> normal;
  compute_normals(asset, asset.rest_position, normal);
  ASSERT_GT(asset.splits.rows(), 0U);
  for (uint32_t row = 0; row < asset.splits.rows(); ++row) {
    for (uint32_t k = asset.splits.offset[row]; k < asset.splits.offset[row + 1]; ++k) {
      EXPECT_EQ(normal[asset.splits.pixel[k]], normal[asset.splits.pixel[asset.splits.offset[row]]]);
    }
  }
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    const Vec3 outwards = normalized({asset.rest_position[i].x, 0, asset.rest_position[i].z});
    EXPECT_GT(dot(normal[i], outwards), 0.99F);
    EXPECT_NEAR(length(normal[i]), 1, 1e-6F);
  }
}

TEST(ClothAsset, NormalsOfATinySheetDoNotUnderflow) {
  const ClothAsset asset = make_sheet({.nx = 4, .ny = 4, .width = 1e-12F, .height = 1e-12F});
  std::vector<Vec3> normal;
  compute_normals(asset, asset.rest_position, normal);
  for (const Vec3& n : normal) EXPECT_NEAR(n.z, 1, 1e-6F);
}

TEST(ClothAsset, ACollapsedSheetStillHasUnitNormals) {
  const ClothAsset asset = make_sheet({.nx = 4, .ny = 4});
  std::vector<Vec3> normal, out;
  compute_normals(asset, std::vector<Vec3>(asset.pixel_count()), normal);
  for (const Vec3& n : normal) EXPECT_FLOAT_EQ(length(n), 1);
  evaluate_binding(asset, std::vector<Vec3>(asset.pixel_count()), normal, out);
  for (const Vec3& p : out) EXPECT_TRUE(is_finite(p));
}

// The file was blamed for what its caller had counted wrong.
TEST(ClothAsset, AnotherNumberOfPositionsIsTheCallersMistake) {
  const ClothAsset asset = make_sheet({.nx = 4, .ny = 4});
  const std::vector<Vec3> few(3), all(16), bound = bind_normals(asset);
  std::vector<Vec3> out;
  const auto refused = [](const auto& call) {
    try {
      call();
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument) << error.what();
    }
  };
  refused([&] { compute_normals(asset, few, out); });
  refused([&] { evaluate_binding(asset, few, all, out); });
  refused([&] { evaluate_binding(asset, all, few, out); });
  refused([&] { evaluate_bound_normals(asset, few, all, all, out); });
  refused([&] { evaluate_bound_normals(asset, bound, few, all, out); });
  refused([&] { evaluate_bound_normals(asset, bound, all, few, out); });
}

/// A sheet whose source mesh floats 1 cm in front of it, and to the side.
ClothAsset sheet_with_offsets() {
  ClothAsset asset = make_sheet({.nx = 6, .ny = 6, .charts_x = 2});
  for (Binding& binding : asset.binding) binding.offset = {0.002F, -0.003F, 0.01F};
  std::vector<Vec3> normal;
  compute_normals(asset, asset.rest_position, normal);
  evaluate_binding(asset, asset.rest_position, normal, asset.source.position);
  for (Vec3& n : asset.source.normal) n = normalized({0.6F, 0, 0.8F});
  return asset;
}

TEST(ClothAsset, TheBindingTurnsWithTheCloth) {
  const ClothAsset asset = sheet_with_offsets();
  // A quarter turn about x, then away: (x, y, z) -> (x, -z, y) + t.
  const auto move = [](const Vec3& p) { return Vec3{p.x + 1, -p.z + 2, p.y + 3}; };
  std::vector<Vec3> position, normal, moved, moved_normal;
  for (const Vec3& p : asset.rest_position) position.push_back(move(p));
  compute_normals(asset, position, normal);
  evaluate_binding(asset, position, normal, moved);
  evaluate_bound_normals(asset, bind_normals(asset), position, normal, moved_normal);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    EXPECT_LT(length(moved[i] - move(asset.source.position[i])), 1e-6F);
    EXPECT_LT(length(moved_normal[i] - Vec3{0.6F, -0.8F, 0}), 1e-6F);
  }
}

TEST(ClothAsset, OffsetsGrowWithTheGarment) {
  const ClothAsset asset = sheet_with_offsets();
  std::vector<Vec3> position, normal, scaled;
  for (const Vec3& p : asset.rest_position) position.push_back(p * 3);
  compute_normals(asset, position, normal);
  evaluate_binding(asset, position, normal, scaled, 3);
  for (std::size_t i = 0; i < scaled.size(); ++i) {
    EXPECT_LT(length(scaled[i] - asset.source.position[i] * 3), 1e-6F);
  }
}

TEST(ClothAsset, LayoutsHaveNames) {
  EXPECT_STREQ(to_string(Layout::square), "square");
  EXPECT_STREQ(to_string(Layout::panels), "panels");
  EXPECT_STREQ(to_string(Layout::uv), "uv");
}

}  // namespace
}  // namespace geocloth
