// SPDX-License-Identifier: GPL-3.0-or-later
// What is smaller than a pixel: the image leaves it out, the report says so, and it rides on the cloth.
#include <cmath>
#include <numbers>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/convert.h"
#include "repair/narrow_pieces.h"

namespace geocloth {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr uint32_t kCells = 10;

void close_mesh(TriangleMesh& mesh) {
  mesh.name = "garment";
  mesh.polygon.resize(mesh.triangle.size());
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  mesh.material.emplace_back();
  mesh.part = {{"cloth", 0, 0, 2 * kCells * kCells}};
  const auto rest = static_cast<uint32_t>(mesh.triangle.size()) - 2 * kCells * kCells;
  if (rest != 0) mesh.part.push_back({"button", 0, 2 * kCells * kCells, rest});
}

/// A sheet of 1 m, level.
TriangleMesh sheet() {
  TriangleMesh mesh;
  for (uint32_t y = 0; y <= kCells; ++y) {
    for (uint32_t x = 0; x <= kCells; ++x) {
      mesh.position.push_back({static_cast<double>(x) / kCells, 0, static_cast<double>(y) / kCells});
    }
  }
  for (uint32_t y = 0; y < kCells; ++y) {
    for (uint32_t x = 0; x < kCells; ++x) {
      const uint32_t a = y * (kCells + 1) + x, b = a + 1, c = a + kCells + 1, d = c + 1;
      mesh.triangle.push_back({a, c, d});
      mesh.triangle.push_back({a, d, b});
    }
  }
  return mesh;
}

/// Adds a tetrahedron of the given size over a place of the sheet.
void add_button(TriangleMesh& mesh, double x, double z, double size) {
  const auto first = static_cast<uint32_t>(mesh.position.size());
  const Point3 at{x, 0.004, z};
  for (const Point3& p : {Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{0, 1, 0}, Point3{0, 0, 1}}) {
    mesh.position.push_back({at[0] + size * p[0], at[1] + size * p[1], at[2] + size * p[2]});
  }
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{0, 3, 2}, Triangle{1, 2, 3}}) {
    mesh.triangle.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

/// Adds a level square.
void add_square(TriangleMesh& mesh, double x, double y, double z, double side) {
  const auto first = static_cast<uint32_t>(mesh.position.size());
  mesh.position.insert(mesh.position.end(), {{x, y, z}, {x, y, z + side}, {x + side, y, z + side}, {x + side, y, z}});
  mesh.triangle.push_back({first, first + 1, first + 2});
  mesh.triangle.push_back({first, first + 2, first + 3});
}

ConvertResult convert_at(const TriangleMesh& mesh, uint32_t resolution, bool carry_loose = false) {
  ConvertOptions options;
  options.carry_loose = carry_loose;
  options.flatten.resolution = resolution;
  options.square_if_panels_fail = false;
  return convert(mesh, options);
}

double total_share(const ConvertReport& report) {
  double share = 0;
  for (const CarriedPart& c : report.carried) share += c.area_share;
  return share;
}

std::vector<Vec3> bound(const ClothAsset& asset, const std::vector<Vec3>& position) {
  std::vector<Vec3> normal, out;
  compute_normals(asset, position, normal);
  evaluate_binding(asset, position, normal, out);
  return out;
}

/// The sheet rolled up.
Vec3 roll(const Vec3& p) {
  constexpr float kRadius = 0.2F;
  const float angle = p.x / kRadius, r = kRadius - p.y;
  return Vec3{r * std::sin(angle), kRadius - r * std::cos(angle), p.z};
}

/// How far what is not the sheet is from where it would be if it were one with it while it rolls up.
float largest_slip(const ClothAsset& asset) {
  std::vector<Vec3> rolled = asset.rest_position;
  for (Vec3& p : rolled) p = roll(p);
  const std::vector<Vec3> moved = bound(asset, rolled);
  float slip = 0;
  for (size_t i = 0; i < moved.size(); ++i) {
    if (asset.source.source_vertex[i] < (kCells + 1) * (kCells + 1)) continue;
    slip = std::max(slip, length(moved[i] - roll(asset.source.position[i])));
  }
  return slip;
}

// A button of 3 mm on pixels of 30 mm: no cloth of its own, but reported.
TEST(SmallPieces, AButtonUnderAPixelIsCarriedAndReported) {
  TriangleMesh mesh = sheet();
  add_button(mesh, 0.52, 0.37, 0.003);
  close_mesh(mesh);
  const ConvertReport report = convert_at(mesh, 32).report;
  ASSERT_EQ(report.carried.size(), 1U);
  EXPECT_EQ(report.carried[0].part, 1U);
  EXPECT_EQ(report.carried[0].faces, 4U);
  EXPECT_NEAR(report.carried[0].area_share, (1.5 + std::sqrt(0.75)) * 9e-6, 1e-7);
  EXPECT_THAT(report.carried[0].why, HasSubstr("button"));
  EXPECT_EQ(report.cleaned.components, 2U);
  EXPECT_EQ(report.represented.components, 1U);
  EXPECT_EQ(report.welded.components, 1U);
  EXPECT_EQ(report.welded.euler_characteristic, 1);
}

// A square gives every part pixels, so that nothing is left out of it.
TEST(SmallPieces, ASquareRepresentsAButtonUnderAPixel) {
  TriangleMesh mesh = sheet();
  add_button(mesh, 0.52, 0.37, 0.003);
  close_mesh(mesh);
  ConvertOptions options;
  options.flatten = {.layout = Layout::square, .resolution = 32};
  const ConvertReport report = convert(mesh, options).report;
  EXPECT_TRUE(report.carried.empty());
  EXPECT_EQ(report.welded.components, report.cleaned.components);
  EXPECT_EQ(report.welded.euler_characteristic, report.cleaned.euler_characteristic);
}

// Its pixels make it cloth, sewn to nothing: the user is told how it rides.
TEST(SmallPieces, AButtonOverAPixelIsClothUnlessItIsToRide) {
  TriangleMesh mesh = sheet();
  add_button(mesh, 0.52, 0.37, 0.03);
  close_mesh(mesh);
  const ConvertReport report = convert_at(mesh, 128).report;
  EXPECT_TRUE(report.carried.empty());
  EXPECT_EQ(report.welded.components, 2U);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("--carry-loose")));
}

// Two triangles back to back would be all of it, whose normals cancel: what is bound to them flew about.
TEST(SmallPieces, AButtonAsWideAsAPixelIsCarriedAndAPatchOfThatAreaIsCloth) {
  TriangleMesh mesh = sheet();
  add_button(mesh, 0.52, 0.37, 0.029);
  close_mesh(mesh);
  const ConvertReport report = convert_at(mesh, 32).report;
  ASSERT_EQ(report.carried.size(), 1U);
  EXPECT_THAT(report.carried[0].why, HasSubstr("it is closed, and its area is 2"));
  EXPECT_EQ(report.welded.components, 1U);
  TriangleMesh patched = sheet();
  add_square(patched, 0.52, 0.01, 0.37, 0.045);
  close_mesh(patched);
  const ConvertReport with_patch = convert_at(patched, 32).report;
  EXPECT_TRUE(with_patch.carried.empty());
  EXPECT_EQ(with_patch.welded.components, 2U);
}

// A thing of 10 cm on a sheet of 1 m is cloth. It is sewn to nothing, and the user is told.
TEST(SmallPieces, WhatIsMoreThanATwentiethOfTheGarmentIsCloth) {
  TriangleMesh mesh = sheet();
  add_button(mesh, 0.52, 0.37, 0.06);
  close_mesh(mesh);
  const ConvertReport report = convert_at(mesh, 32, true).report;
  EXPECT_TRUE(report.carried.empty());
  EXPECT_EQ(report.welded.components, 2U);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("1 small piece, up to 0.104 m across, is attached to nothing")));
}

// Buttons of a few pixels were cloths of their own, sewn to nothing: they stayed in mid-air when the shirt fell.
TEST(SmallPieces, AButtonOfSomePixelsRidesOnTheCloth) {
  for (const bool closed : {true, false}) {
    TriangleMesh mesh = sheet();
    if (closed) {
      add_button(mesh, 0.52, 0.37, 0.03);
    } else {
      add_square(mesh, 0.52, 0.004, 0.37, 0.03);
    }
    close_mesh(mesh);
    const ConvertResult result = convert_at(mesh, 128, true);
    const ConvertReport& report = result.report;
    ASSERT_EQ(report.carried.size(), 1U);
    EXPECT_GT(report.carried[0].area_share * 128 * 128, 10);
    EXPECT_THAT(report.carried[0].why, HasSubstr("attached to nothing"));
    EXPECT_EQ(report.represented.components, 1U);
    EXPECT_EQ(report.welded.components, 1U);
    EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("the mesh is coarse")));
    EXPECT_LT(largest_slip(result.asset), 0.004F);
  }
}

/// Adds a level square of 4 x 4 cells.
void add_fine_square(TriangleMesh& mesh, double x, double z, double side) {
  constexpr uint32_t kAcross = 4;
  const auto first = static_cast<uint32_t>(mesh.position.size());
  for (uint32_t v = 0; v <= kAcross; ++v) {
    for (uint32_t u = 0; u <= kAcross; ++u) {
      mesh.position.push_back({x + side * u / kAcross, 0.004, z + side * v / kAcross});
    }
  }
  for (uint32_t v = 0; v < kAcross; ++v) {
    for (uint32_t u = 0; u < kAcross; ++u) {
      const uint32_t a = first + v * (kAcross + 1) + u, c = a + kAcross + 1;
      mesh.triangle.push_back({a, c, c + 1});
      mesh.triangle.push_back({a, c + 1, a + 1});
    }
  }
}

// Each button that rode as the user had asked was called smaller than a spring, and to be converted by itself.
TEST(SmallPieces, WhatRidesAsAskedIsNotCalledTooFine) {
  const auto too_fine = Contains(HasSubstr("parts of another scale"));
  TriangleMesh mesh = sheet();
  add_fine_square(mesh, 0.52, 0.37, 0.03);
  close_mesh(mesh);
  const ConvertReport asked = convert_at(mesh, 48, true).report;
  EXPECT_EQ(asked.carried.size(), 1U);
  EXPECT_THAT(asked.warnings, Not(too_fine));
  const ConvertReport not_asked = convert_at(mesh, 16).report;
  EXPECT_EQ(not_asked.carried.size(), 1U);
  EXPECT_THAT(not_asked.warnings, too_fine);
}

// The option was advised for pieces that it does not take, in squares, which carry nothing, and after it was given.
TEST(SmallPieces, CarryLooseIsAdvisedWhereItHelps) {
  const auto option = HasSubstr("--carry-loose");
  TriangleMesh button = sheet();
  add_button(button, 0.52, 0.37, 0.03);
  TriangleMesh both = button;
  add_square(both, 0.1, 0.004, 0.1, 0.1);
  TriangleMesh pocket = sheet();
  add_square(pocket, 0.1, 0.004, 0.1, 0.1);
  TriangleMesh off = sheet();
  add_square(off, 0.52, 0.1, 0.37, 0.03);
  for (TriangleMesh* mesh : {&button, &both, &pocket, &off}) close_mesh(*mesh);

  EXPECT_THAT(convert_at(button, 48).report.warnings,
              Contains(HasSubstr("let it ride on the cloth with --carry-loose")));
  EXPECT_THAT(convert_at(both, 48).report.warnings,
              Contains(HasSubstr("let 1 of them ride on the cloth with --carry-loose")));
  ConvertOptions options;
  options.flatten = {.layout = Layout::square, .resolution = 48};
  for (const ConvertReport& report :
       {convert_at(pocket, 48).report, convert_at(off, 48).report, convert_at(both, 48, true).report,
        convert_at(pocket, 48, true).report, convert(button, options).report}) {
    EXPECT_THAT(report.warnings, Contains(HasSubstr("1 small piece, ")));
    EXPECT_THAT(report.warnings, Contains(HasSubstr("merge it with the cloth")));
    EXPECT_THAT(report.warnings, Not(Contains(option)));
  }
}

// Strands of hair more than half as long as the figure were called small.
TEST(SmallPieces, ALongPieceIsNotCalledSmall) {
  TriangleMesh mesh = sheet();
  const auto first = static_cast<uint32_t>(mesh.position.size());
  mesh.position.insert(mesh.position.end(), {{0.2, 0.05, 0.3}, {0.2, 0.05, 0.33}, {0.7, 0.05, 0.33}, {0.7, 0.05, 0.3}});
  mesh.triangle.push_back({first, first + 1, first + 2});
  mesh.triangle.push_back({first, first + 2, first + 3});
  close_mesh(mesh);
  EXPECT_THAT(convert_at(mesh, 64).report.warnings, Contains(HasSubstr("1 piece, up to 0.501 m across")));
}

// What is off the cloth by more than twice its own size, or 3 % of the garment, is none of its trimmings.
TEST(SmallPieces, WhatDoesNotLieOnTheClothDoesNotRide) {
  struct Place {
    double height, side;
  };
  for (const Place& place : {Place{0.1, 0.03}, Place{0.015, 0.005}}) {
    TriangleMesh mesh = sheet();
    add_square(mesh, 0.52, place.height, 0.37, place.side);
    add_square(mesh, 0.22, place.height, 0.37, place.side);
    close_mesh(mesh);
    const ConvertReport report = convert_at(mesh, 256, true).report;
    EXPECT_TRUE(report.carried.empty());
    EXPECT_EQ(report.welded.components, 3U);
    EXPECT_THAT(report.warnings, Contains(HasSubstr("2 small pieces")));
  }
}

// A pocket that is not sewn on is cloth, as large as it is.
TEST(SmallPieces, APocketDoesNotRide) {
  TriangleMesh mesh = sheet();
  add_square(mesh, 0.52, 0.004, 0.37, 0.3);
  close_mesh(mesh);
  for (const uint32_t resolution : {8U, 64U}) {
    const ConvertReport report = convert_at(mesh, resolution, true).report;
    EXPECT_TRUE(report.carried.empty());
    EXPECT_EQ(report.welded.components, 2U);
    EXPECT_THAT(report.warnings, Not(Contains(HasSubstr("attached to nothing"))));
  }
}

// Of 600 sequins of half a pixel 400 are carried else, and the rest become cloths of a pixel each.
TEST(SmallPieces, OfEqualSequinsAllAreCarried) {
  TriangleMesh mesh = sheet();
  constexpr uint32_t kSequins = 100;
  for (uint32_t i = 0; i < kSequins; ++i) add_square(mesh, 0.03 + 0.1 * (i % 10), 0.002, 0.02 + 0.1 * (i / 10), 0.02);
  close_mesh(mesh);
  const ConvertReport report = convert_at(mesh, 32, true).report;
  EXPECT_EQ(report.carried.size(), kSequins);
  EXPECT_EQ(report.welded.components, 1U);
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("100 small pieces, 3.8 % of the area, have no pixels")));
}

// As many as fit into a hundredth of the area rode, and the other 40 fell.
TEST(SmallPieces, OfEqualSequinsNoneIsCarriedWhereNotAllMayBe) {
  TriangleMesh mesh = sheet();
  constexpr uint32_t kSequins = 100;
  for (uint32_t i = 0; i < kSequins; ++i) add_square(mesh, 0.03 + 0.1 * (i % 10), 0.002, 0.02 + 0.1 * (i / 10), 0.013);
  add_square(mesh, 0.05, 0.002, 0.07, 0.02);  // one of its own that may be
  close_mesh(mesh);
  const ConvertReport report = convert_at(mesh, 48).report;
  ASSERT_EQ(report.carried.size(), 1U);
  EXPECT_EQ(report.represented.components, 1 + kSequins);
  EXPECT_THAT(report.warnings, Contains(HasSubstr("100 small pieces")));
}

// The button moves with the cloth beside it and keeps its shape while the cloth rolls up.
TEST(SmallPieces, ACarriedButtonRidesOnTheClothAndKeepsItsShape) {
  TriangleMesh mesh = sheet();
  add_button(mesh, 0.52, 0.37, 0.003);
  close_mesh(mesh);
  const ClothAsset asset = convert_at(mesh, 32).asset;
  const std::vector<Vec3> rest = bound(asset, asset.rest_position);
  std::vector<Vec3> rolled = asset.rest_position;
  constexpr float kRadius = 0.2F;
  for (Vec3& p : rolled) {
    const float angle = p.x / kRadius, r = kRadius - p.y;
    p = {r * std::sin(angle), kRadius - r * std::cos(angle), p.z};
  }
  const std::vector<Vec3> moved = bound(asset, rolled);
  const float angle = 0.52F / kRadius, r = kRadius - 0.004F;
  const Vec3 expected{r * std::sin(angle), kRadius - r * std::cos(angle), 0.37F};
  std::vector<size_t> button;  // render vertices
  for (size_t i = 0; i < rest.size(); ++i) {
    if (asset.source.source_vertex[i] >= (kCells + 1) * (kCells + 1)) button.push_back(i);
  }
  ASSERT_GE(button.size(), 4U);
  for (const size_t i : button) {
    EXPECT_LT(length(rest[i] - asset.source.position[i]), 1e-6F);  // exact at rest
    EXPECT_LT(length(moved[i] - expected), 0.006F);
    for (const size_t k : button) {
      EXPECT_NEAR(length(moved[i] - moved[k]), length(rest[i] - rest[k]), 1e-5F);
    }
  }
}

/// Adds a band of 0.8 m along x, over the middle of the sheet, or a closed thread of as many sides.
void add_band(TriangleMesh& mesh, double width, double above, uint32_t sides) {
  constexpr uint32_t kAlong = 40;
  const auto first = static_cast<uint32_t>(mesh.position.size());
  const uint32_t rows = sides == 1 ? 2 : sides;
  for (uint32_t i = 0; i <= kAlong; ++i) {
    for (uint32_t k = 0; k < rows; ++k) {
      const double angle = 2 * std::numbers::pi * k / rows;
      mesh.position.push_back({0.1 + 0.8 * i / kAlong, above + (sides == 1 ? 0 : width / 2 * std::sin(angle)),
                               0.52 + width / 2 * std::cos(angle)});
    }
  }
  for (uint32_t i = 0; i < kAlong; ++i) {
    for (uint32_t k = 0; k < sides; ++k) {
      const uint32_t a = first + i * rows + k, b = first + i * rows + (k + 1) % rows, c = a + rows, d = b + rows;
      mesh.triangle.push_back({a, b, d});
      mesh.triangle.push_back({a, d, c});
    }
  }
}

// Rows of stitches of 3 mm on pixels of 30 mm, flat or round: on a grid of their own their sides would be as far apart
// as a tenth of a spring.
TEST(SmallPieces, AThreadOnTheClothIsCarriedAndFollowsIt) {
  for (const uint32_t sides : {1U, 4U}) {
    TriangleMesh mesh = sheet();
    add_band(mesh, 0.003, 0.004, sides);
    close_mesh(mesh);
    const ConvertResult result = convert_at(mesh, 32);
    const ConvertReport& report = result.report;
    ASSERT_EQ(report.carried.size(), 1U) << sides;
    EXPECT_THAT(report.carried[0].why, HasSubstr("strip"));
    EXPECT_GT(report.carried[0].area_share * 32 * 32, 1);
    EXPECT_EQ(report.cleaned.components, 2U);
    EXPECT_EQ(report.welded.components, 1U);
    EXPECT_LT(largest_slip(result.asset), 0.006F);
  }
}

/// Adds a thread that goes to and fro across the sheet, every leg of it two triangles from end to end.
void add_zigzag(TriangleMesh& mesh, uint32_t legs, double width) {
  for (uint32_t i = 0; i < legs; ++i) {
    const auto first = static_cast<uint32_t>(mesh.position.size());
    const double z = 0.02 + 0.96 * i / legs;
    for (const double x : {0.02, 0.98}) {
      for (const double beside : {0.0, width}) mesh.position.push_back({x + beside, width, z + beside});
    }
    mesh.triangle.push_back({first, first + 1, first + 3});
    mesh.triangle.push_back({first, first + 3, first + 2});
    if (i == 0) continue;
    const uint32_t end = i % 2 == 0 ? 0 : 2;  // where the leg before is joined
    mesh.triangle.push_back({first + end - 4, first + end - 3, first + end});
    mesh.triangle.push_back({first + end - 3, first + end + 1, first + end});
  }
}

// Until it was known how wide chains and embroidery of long needles are, a coarse image took half a minute and a fine
// one all memory: a needle was halved into far more bits than its length has places, each compared with every other.
TEST(SmallPieces, LongNeedlesAreMeasuredInAsManyPlacesAsTheyAreLong) {
  constexpr double kPixel = 1e-4, kWidth = 0.3 * kPixel;
  TriangleMesh mesh = sheet();
  add_zigzag(mesh, 8, kWidth);
  close_mesh(mesh);
  const CleanSurface clean = repair_mesh(mesh).surface;
  const std::vector<uint8_t> none(clean.component_count, 0);
  const std::vector<NarrowPieces> found = find_narrow_pieces(clean, kPixel, 0.01, none);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].area, 8 * 0.96 * kWidth + 7 * kWidth * 0.12, 1e-6);
  // At the turns two legs are within the radius.
  EXPECT_GT(found[0].width, 0.9 * kWidth);
  EXPECT_LT(found[0].width, 1.6 * kWidth);
}

// A ribbon of more than half a pixel has pixels, and so has a thread that hangs free: nothing would carry it.
TEST(SmallPieces, ARibbonAndAThreadThatHangsFreeAreCloth) {
  struct Band {
    double width, above;
  };
  for (const Band& band : {Band{0.02, 0.004}, Band{0.003, 0.2}}) {
    TriangleMesh mesh = sheet();
    add_band(mesh, band.width, band.above, 1);
    close_mesh(mesh);
    const ConvertReport report = convert_at(mesh, 32).report;
    EXPECT_TRUE(report.carried.empty());
    EXPECT_EQ(report.welded.components, 2U);
  }
}

// A narrow fold that is sewn to the cloth is a part of it.
TEST(SmallPieces, ANarrowStripSewnToTheClothIsCloth) {
  TriangleMesh mesh = sheet();
  const uint32_t row = 5 * (kCells + 1), first = static_cast<uint32_t>(mesh.position.size());
  for (uint32_t x = 0; x <= kCells; ++x) {
    mesh.position.push_back({static_cast<double>(x) / kCells, 0.008, 0.5});
  }
  for (uint32_t x = 0; x < kCells; ++x) {
    mesh.triangle.push_back({row + x, row + x + 1, first + x + 1});
    mesh.triangle.push_back({row + x, first + x + 1, first + x});
  }
  close_mesh(mesh);
  const ConvertReport report = convert_at(mesh, 32).report;
  EXPECT_TRUE(report.carried.empty());
  EXPECT_EQ(report.welded.components, report.cleaned.components);
}

// A buttonhole of 10 mm on pixels of 30 mm is closed; on pixels of 5 mm it is a hole.
TEST(SmallPieces, AHoleUnderAPixelIsClosed) {
  TriangleMesh mesh = sheet();
  const uint32_t cell = 4 * kCells + 5, a = cell / kCells * (kCells + 1) + cell % kCells;
  const std::array<uint32_t, 4> outer{a, a + kCells + 1, a + kCells + 2, a + 1};
  Point3 middle{};
  for (const uint32_t v : outer) {
    for (size_t k = 0; k < 3; ++k) middle[k] += mesh.position[v][k] / 4;
  }
  const auto first = static_cast<uint32_t>(mesh.position.size());
  for (const uint32_t v : outer) {
    const Point3 p = mesh.position[v];
    mesh.position.push_back({middle[0] + 0.1 * (p[0] - middle[0]), 0, middle[2] + 0.1 * (p[2] - middle[2])});
  }
  std::vector<Triangle> ring;
  for (uint32_t k = 0; k < 4; ++k) {
    const uint32_t next = (k + 1) % 4;
    ring.push_back({outer[k], outer[next], first + next});
    ring.push_back({outer[k], first + next, first + k});
  }
  mesh.triangle.erase(mesh.triangle.begin() + 2 * cell, mesh.triangle.begin() + 2 * cell + 2);
  mesh.triangle.insert(mesh.triangle.end(), ring.begin(), ring.end());
  close_mesh(mesh);

  const ConvertReport coarse = convert_at(mesh, 32).report;
  ASSERT_EQ(coarse.carried.size(), 1U);
  EXPECT_EQ(coarse.carried[0].faces, 0U);
  EXPECT_THAT(coarse.carried[0].why, HasSubstr("hole"));
  EXPECT_EQ(coarse.cleaned.boundary_loops, 2U);
  EXPECT_EQ(coarse.represented.boundary_loops, 1U);
  EXPECT_EQ(coarse.welded.boundary_loops, 1U);
  const ConvertReport fine = convert_at(mesh, 200).report;
  EXPECT_TRUE(fine.carried.empty());
  EXPECT_EQ(fine.welded.boundary_loops, 2U);
}

/// Every cell of the sheet with a square hole in its middle.
TriangleMesh net(double hole) {
  TriangleMesh mesh = sheet();
  mesh.triangle.clear();
  for (uint32_t cell = 0; cell < kCells * kCells; ++cell) {
    const uint32_t a = cell / kCells * (kCells + 1) + cell % kCells;
    const std::array<uint32_t, 4> outer{a, a + kCells + 1, a + kCells + 2, a + 1};
    const Point3 low = mesh.position[outer[0]], high = mesh.position[outer[2]];
    const Point3 middle{(low[0] + high[0]) / 2, 0, (low[2] + high[2]) / 2};
    const auto first = static_cast<uint32_t>(mesh.position.size());
    for (const uint32_t v : outer) {
      const Point3 p = mesh.position[v];
      mesh.position.push_back({middle[0] + hole * (p[0] - middle[0]), 0, middle[2] + hole * (p[2] - middle[2])});
    }
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t next = (k + 1) % 4;
      mesh.triangle.push_back({outer[k], outer[next], first + next});
      mesh.triangle.push_back({outer[k], first + next, first + k});
    }
  }
  close_mesh(mesh);
  return mesh;
}

// Holes that are closed are carried too: a hundredth of the area, however fine a net is.
TEST(SmallPieces, OfANetAHundredthIsClosed) {
  for (const uint32_t resolution : {8U, 30U}) {
    const ConvertReport report = convert_at(net(0.2), resolution).report;
    EXPECT_GT(report.carried.size(), 0U);
    EXPECT_LE(total_share(report), 0.01);
    EXPECT_EQ(report.welded.boundary_loops + report.carried.size(), report.cleaned.boundary_loops);
  }
}

// A heap of scraps that all are smaller than a pixel is the garment itself: 1 % of it at most may be left out.
TEST(SmallPieces, AtMostAHundredthOfTheAreaIsCarried) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < 300; ++i) {
    const double x = 0.05 * (i % 20), z = 0.05 * (i / 20), size = 0.002 + 1e-5 * i;
    mesh.position.insert(mesh.position.end(), {{x, 0, z}, {x, 0, z + size}, {x + size, 0, z}});
    mesh.triangle.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  mesh.name = "scraps";
  mesh.polygon.resize(mesh.triangle.size());
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  mesh.material.emplace_back();
  mesh.part = {{"scraps", 0, 0, 300}};
  const ConvertReport report = convert_at(mesh, 8).report;
  EXPECT_LE(total_share(report), 0.01);
  EXPECT_EQ(report.represented.components + report.carried.size(), 300U);
  EXPECT_EQ(report.welded.components, report.represented.components);
}

/// A fishnet sleeve: threads one cell wide, three cells apart, on a tube of 0.3 m.
TriangleMesh fishnet(uint32_t meshes) {
  TriangleMesh mesh;
  const uint32_t n = 4 * meshes;
  std::vector<uint32_t> number(static_cast<std::size_t>(n) * (n + 1), kNone);
  const auto vertex = [&](uint32_t i, uint32_t j) {
    uint32_t& v = number[static_cast<std::size_t>(j) * n + i % n];
    if (v == kNone) {
      v = static_cast<uint32_t>(mesh.position.size());
      const double angle = 2 * std::numbers::pi * i / n;
      mesh.position.push_back({0.3 * std::cos(angle), static_cast<double>(j) / n, 0.3 * std::sin(angle)});
    }
    return v;
  };
  for (uint32_t j = 0; j < n; ++j) {
    for (uint32_t i = 0; i < n; ++i) {
      if (i % 4 != 0 && j % 4 != 0) continue;
      const uint32_t a = vertex(i, j), b = vertex(i + 1, j), c = vertex(i + 1, j + 1), d = vertex(i, j + 1);
      mesh.triangle.push_back({a, b, c});
      mesh.triangle.push_back({a, c, d});
    }
  }
  mesh.name = "net";
  mesh.polygon.resize(mesh.triangle.size());
  std::iota(mesh.polygon.begin(), mesh.polygon.end(), 0U);
  mesh.material.emplace_back();
  mesh.part = {{"net", 0, 0, static_cast<uint32_t>(mesh.triangle.size())}};
  return mesh;
}

// A chart whose outline finds no room becomes a disk, whose area grows with the square of the outline: a net's was
// hundreds of images large and thousands of times as stretched as the cloth.
TEST(SmallPieces, ANetOfThreadsBelowAPixelTakesNoDisk) {
  try {
    EXPECT_LT(count_valid_pixels(convert_at(fishnet(8), 16).asset), 4 * 16 * 16);
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("raise the resolution"));
  }
}

}  // namespace
}  // namespace geocloth
