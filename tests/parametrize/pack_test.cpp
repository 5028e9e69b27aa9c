// SPDX-License-Identifier: GPL-3.0-or-later
// The atlas: charts must not touch, must not be turned but by half a turn, and must not waste the image's memory.
#include "pack/pack.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "geocloth/asset/error.h"
#include "pack/ready_shape.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

std::vector<uint8_t> pixels_of(const ChartShape& shape, bool turned) {
  std::vector<uint8_t> pixel(size_t{shape.width} * shape.height, 0);
  for (const ChartShape::Run& r : shape.run) {
    for (uint32_t x = r.first; x <= r.last; ++x) {
      const size_t i = size_t{r.row} * shape.width + x;
      pixel[turned ? pixel.size() - 1 - i : i] = 1;
    }
  }
  return pixel;
}

/// Paints the atlas, checking on the way that no pixel has a pixel of another shape among its eight neighbours.
/// @returns the share of pixels that are painted
double utilisation_of_valid(const std::vector<ChartShape>& shapes, const Packing& packing) {
  std::vector<uint32_t> owner(size_t{packing.width} * packing.height, kNone);
  double taken = 0;
  for (uint32_t c = 0; c < shapes.size(); ++c) {
    const auto [x0, y0] = packing.corner[c];
    const std::vector<uint8_t> pixel = pixels_of(shapes[c], packing.turned[c] != 0);
    EXPECT_LE(x0 + shapes[c].width, packing.width);
    EXPECT_LE(y0 + shapes[c].height, packing.height);
    for (size_t i = 0; i < pixel.size(); ++i) {
      if (pixel[i] == 0) continue;
      uint32_t& place = owner[(y0 + i / shapes[c].width) * packing.width + x0 + i % shapes[c].width];
      EXPECT_EQ(place, kNone);
      place = c;
      ++taken;
    }
  }
  for (size_t y = 0; y < packing.height; ++y) {
    for (size_t x = 0; x < packing.width; ++x) {
      const uint32_t here = owner[y * packing.width + x];
      for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {-1, 1}}) {
        const size_t x1 = x + static_cast<size_t>(dx), y1 = y + static_cast<size_t>(dy);
        if (x1 >= packing.width || y1 >= packing.height) continue;
        const uint32_t there = owner[y1 * packing.width + x1];
        EXPECT_TRUE(here == there || here == kNone || there == kNone) << x << ' ' << y;
      }
    }
  }
  return taken / static_cast<double>(owner.size());
}

ChartShape disc(double radius) {
  const auto side = static_cast<uint32_t>(2 * radius + 1);
  ChartShape shape{side, side, {}};
  for (uint32_t y = 0; y < side; ++y) {
    const double half = std::sqrt(std::max(radius * radius - (y - radius) * (y - radius), 0.0));
    shape.run.push_back({y, static_cast<uint32_t>(std::ceil(radius - half)), static_cast<uint32_t>(radius + half)});
  }
  return shape;
}

/// A right triangle with its right angle below on the left.
ChartShape wedge(uint32_t side) {
  ChartShape shape{side, side, {}};
  for (uint32_t y = 0; y < side; ++y) shape.run.push_back({y, 0, y});
  return shape;
}

TEST(Pack, OneChartFillsTheAtlas) {
  const std::vector<ChartShape> shapes{rectangle_shape(17, 5)};
  const Packing packing = pack_shapes(shapes);
  EXPECT_EQ(packing.width, 17U);
  EXPECT_EQ(packing.height, 5U);
}

// Rectangles around the shapes would need twice the atlas.
TEST(Pack, AHollowIsFilled) {
  ChartShape frame{40, 40, {}};
  for (uint32_t y = 0; y < 40; ++y) {
    frame.run.push_back({y, 0, 2});
    frame.run.push_back({y, 37, 39});
  }
  for (uint32_t y = 37; y < 40; ++y) frame.run.push_back({y, 0, 39});
  const std::vector<ChartShape> shapes{frame, rectangle_shape(32, 35)};
  const Packing packing = pack_shapes(shapes);
  utilisation_of_valid(shapes, packing);
  EXPECT_EQ(packing.width, 40U);
  EXPECT_EQ(packing.height, 40U);
}

TEST(Pack, TurnsByHalfATurnWherePanelsFitOnlySo) {
  const std::vector<ChartShape> shapes{wedge(60), wedge(60)};
  const Packing packing = pack_shapes(shapes);
  EXPECT_GT(utilisation_of_valid(shapes, packing), 0.9);
  EXPECT_NE(packing.turned[0], packing.turned[1]);
}

TEST(Pack, DoesNotTurnWithoutNeed) {
  const std::vector<ChartShape> shapes{rectangle_shape(30, 50), disc(14), rectangle_shape(20, 20)};
  const Packing packing = pack_shapes(shapes);
  EXPECT_EQ(packing.turned, std::vector<uint8_t>(3, 0));
}

// Buttons, trims and hundreds of panels: discs of all sizes in boxes would cover 0.7 of it.
TEST(Pack, HundredsOfRoundChartsWasteLittle) {
  std::mt19937 random(7);
  std::vector<ChartShape> shapes;
  for (int i = 0; i < 400; ++i) shapes.push_back(disc(4 + std::pow(1.003, random() % 1000)));
  const Packing packing = pack_shapes(shapes);
  EXPECT_GT(utilisation_of_valid(shapes, packing), 0.72);
  EXPECT_LT(std::max(packing.width, packing.height), 2 * std::min(packing.width, packing.height));
}

TEST(Pack, ThousandsOfCrumbsWasteLittle) {
  const std::vector<ChartShape> shapes(5000, rectangle_shape(5, 4));
  const Packing packing = pack_shapes(shapes);
  // With the gap every crumb needs 6 x 5 pixels.
  EXPECT_GT(utilisation_of_valid(shapes, packing), 0.95 * 20 / 30);
}

// A large image is packed in blocks of pixels; the gap must hold all the same.
TEST(Pack, LargeChartsKeepTheirDistance) {
  std::vector<ChartShape> shapes;
  for (int i = 0; i < 6; ++i) shapes.push_back(disc(200 + 11 * i));
  const Packing packing = pack_shapes(shapes);
  EXPECT_GT(utilisation_of_valid(shapes, packing), 0.65);
}

// Rows of one to four words of 64 pixels, and of more, are gone through each in its own way.
TEST(Pack, KeepsDistancesInRowsOfAnyLength) {
  for (const uint32_t side : {7U, 15U, 28U, 45U, 58U, 78U, 110U}) {
    std::vector<ChartShape> shapes;
    for (uint32_t i = 0; i < 3; ++i) {
      shapes.push_back(disc(0.5 * side - i));
      shapes.push_back(wedge(side - 2 * i));
      shapes.push_back(rectangle_shape(side / 2 + i, side - i));
    }
    for (const PackEffort effort : {PackEffort::quick, PackEffort::thorough}) {
      EXPECT_GT(utilisation_of_valid(shapes, pack_shapes(shapes, effort)), effort == PackEffort::quick ? 0.55 : 0.6)
          << side;
    }
  }
}

TEST(Pack, IsDeterministic) {
  const std::vector<ChartShape> shapes{disc(30), wedge(40), rectangle_shape(11, 60), disc(12), wedge(25)};
  const Packing once = pack_shapes(shapes), again = pack_shapes(shapes);
  EXPECT_EQ(once.corner, again.corner);
  EXPECT_EQ(once.turned, again.turned);
}

// Boards of one, two, three and four words, and of more, are looked at in different ways.
TEST(Pack, IsTheSameWithEveryInstructionSet) {
  for (const uint32_t side : {20U, 50U, 90U, 120U, 160U}) {
    const std::vector<ChartShape> shapes{disc(0.5 * side), wedge(side), rectangle_shape(side / 3, side),
                                         disc(side / 5.0), wedge(side / 2)};
    for (const PackEffort effort : {PackEffort::quick, PackEffort::thorough}) {
      const Packing best = pack_shapes(shapes, effort);
      for (const int64_t target : {int64_t{HWY_SSE4}, int64_t{HWY_AVX2}, int64_t{HWY_AVX3}, int64_t{HWY_NEON}}) {
        if ((hwy::SupportedTargets() & target) == 0) continue;
        hwy::SetSupportedTargetsForTest(target);
        const Packing here = pack_shapes(shapes, effort);
        hwy::SetSupportedTargetsForTest(0);
        EXPECT_EQ(best.corner, here.corner) << hwy::TargetName(target) << ' ' << side;
        EXPECT_EQ(best.turned, here.turned) << hwy::TargetName(target) << ' ' << side;
      }
    }
  }
}

TEST(Pack, ShapesThatAreReadyArePackedAlike) {
  const std::vector<ChartShape> shapes{disc(30), wedge(40), rectangle_shape(11, 60), disc(12), wedge(25)};
  std::vector<ReadyShape> ready;
  for (const ChartShape& s : shapes) ready.push_back(make_ready(s));
  std::vector<const ReadyShape*> each;
  for (const ReadyShape& r : ready) each.push_back(&r);
  const Packing packing = pack_shapes(shapes, PackEffort::quick), same = pack_quickly(each);
  EXPECT_EQ(packing.corner, same.corner);
  EXPECT_EQ(packing.turned, same.turned);
}

TEST(Pack, RefusesAnAtlasThatIsTooLarge) {
  const ChartShape tall{2, kMaxImageSide + 1, {{kMaxImageSide, 0, 1}}};
  EXPECT_THROW((void)pack_shapes({&tall, 1}), Error);
  try {
    (void)rectangle_shape(kMaxImageSide + 1, 2);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::limit);
    EXPECT_NE(std::string(e.what()).find("resolution"), std::string::npos);
  }
}

// A turned chart must sample the cloth as before: its vertices turn with its outline.
TEST(Pack, OutlinesStayOnTheirVertices) {
  const CleanSurface sphere = test::sphere(24, 16);
  const FlatSurface flat = flatten(sphere, cut_to_disks(sphere), {.layout = Layout::panels, .resolution = 64});
  for (const FlatChart& chart : flat.charts) {
    for (const OutlineSample& s : chart.outline) {
      EXPECT_LT(std::abs(flat.uv[s.vertex][0] - s.x), 3);
      EXPECT_LT(std::abs(flat.uv[s.vertex][1] - s.y), 3);
    }
  }
}

}  // namespace
}  // namespace geocloth
