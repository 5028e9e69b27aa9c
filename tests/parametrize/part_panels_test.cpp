// SPDX-License-Identifier: GPL-3.0-or-later
// Charts that spread wide leave half of the image empty: memory that every frame of a game reads for nothing. They are
// parted where that helps, and only as far as seams and borders allow.
#include "develop/part_panels.h"

#include <cmath>

#include <gtest/gtest.h>

#include "develop/chart_overlap.h"
#include "develop/develop.h"
#include "develop/grain.h"
#include "pack/panel_piece.h"
#include "parametrize/clean_surfaces.h"

namespace geocloth {
namespace {

constexpr double kPi = 3.14159265358979;

/// A wide skirt laid flat: a ring's sector that hangs in the plane z = 0.
CleanSurface fan(double angle, double width = 1) {
  CleanSurface sheet = test::disk(61, 13);
  for (Point3& p : sheet.position) {
    const double a = angle * (p[0] - 0.5), r = 1.5 - width * p[1];
    p = {r * std::sin(a), -r * std::cos(a), 0};
  }
  return sheet;
}

struct Laid {
  CutSurface cut;
  Sheet sheet;
  std::vector<Chart> charts;
};

Laid laid_flat(const CleanSurface& surface) {
  Laid laid;
  laid.cut = cut_to_disks(surface);
  laid.sheet = find_sheet(laid.cut);
  for (std::vector<uint32_t>& t : triangles_of_components(laid.cut)) {
    laid.charts.push_back(extract_chart(laid.cut, std::move(t)));
    for (const Point3& p : laid.charts.back().position) laid.charts.back().uv.push_back({p[0], p[1]});
  }
  return laid;
}

/// Parts charts as is thought best. @returns whether that pays
bool part_panels(Laid& laid, const PartingOptions& options) {
  std::vector<PartedPanels> ways = ways_to_part(laid.charts, laid.sheet, options);
  if (ways.empty()) return false;
  laid.charts = std::move(ways.front().charts);
  laid.sheet = std::move(ways.front().sheet);
  return true;
}

double utilisation_of(const Laid& laid, double pixel) {
  return filling_of(laid.charts, laid.sheet, pixel).utilisation;
}

double area_of(const std::vector<Chart>& charts) {
  double area = 0;
  for (const Chart& c : charts) area += total_area(c);
  return area;
}

TEST(PartPanels, NoClothOfAWideSkirtIsLost) {
  Laid laid = laid_flat(fan(0.9 * kPi));
  const double area = area_of(laid.charts);
  const PartingOptions options{.pixel = std::sqrt(area) / 128};
  ASSERT_TRUE(part_panels(laid, options));
  EXPECT_GT(laid.charts.size(), 1U);
  EXPECT_NEAR(area_of(laid.charts), area, 1e-9 * area) << "cloth was lost or doubled";
  for (Chart& c : laid.charts) {
    turn_upright(c);
    EXPECT_FALSE(crossing_edges(c, outline_loop(c)));
  }
}

TEST(PartPanels, ARibbonThatRunsAroundAnEmptyImageIsPartedThoughItIsMostlyBorder) {
  Laid laid = laid_flat(fan(1.8 * kPi, 0.1));
  const double pixel = std::sqrt(area_of(laid.charts)) / 128;
  const double before = utilisation_of(laid, pixel);
  ASSERT_TRUE(part_panels(laid, {.pixel = pixel}));
  for (Chart& c : laid.charts) turn_upright(c);
  EXPECT_GT(utilisation_of(laid, pixel), 2 * before);
}

TEST(PartPanels, ARectangleStaysWhole) {
  Laid laid = laid_flat(test::disk(30, 20, 1.5, 1));
  EXPECT_FALSE(part_panels(laid, {.pixel = std::sqrt(1.5) / 128}));
  EXPECT_EQ(laid.charts.size(), 1U);
}

// Its seams would be several times as long for a few points: lines on the cloth against a little memory.
TEST(PartPanels, AnAlmostRoundSkirtStaysWholeForItFillsTheImageWellEnough) {
  Laid laid = laid_flat(fan(1.92 * kPi, 1.2));
  const double pixel = std::sqrt(area_of(laid.charts)) / 128;
  const Filling whole = filling_of(laid.charts, laid.sheet, pixel);
  ASSERT_GT(whole.utilisation, 0.7);
  ASSERT_LT(whole.utilisation, 0.75);
  EXPECT_FALSE(part_panels(laid, {.pixel = pixel}));
  EXPECT_TRUE(part_panels(laid, {.pixel = pixel, .seam_price = 0.01})) << "there are ways";
}

TEST(PartPanels, KeepsToItsBudgetsOfBorderAndSeam) {
  const Laid laid = laid_flat(fan(0.9 * kPi));
  const double pixel = std::sqrt(area_of(laid.charts)) / 128;
  const auto is_parted = [&](const PartingOptions& options) {
    Laid copy = laid;
    return part_panels(copy, options);
  };
  EXPECT_TRUE(is_parted({.pixel = pixel}));
  EXPECT_FALSE(is_parted({.pixel = 4 * pixel})) << "an image of 32 x 32 has no pixels to spare for more border";
  EXPECT_FALSE(is_parted({.pixel = pixel, .most_seam = 0.2}));
  EXPECT_FALSE(is_parted({.pixel = 0})) << "who asks for no packing gets none";
}

TEST(PartPanels, DoesNotDependOnTheUnit) {
  CleanSurface metres = fan(0.8 * kPi), millimetres = metres;
  for (Point3& p : millimetres.position) p = {1000 * p[0], 1000 * p[1], 1000 * p[2]};
  Laid a = laid_flat(metres), b = laid_flat(millimetres);
  const double pixel = std::sqrt(area_of(a.charts)) / 128;
  part_panels(a, {.pixel = pixel});
  part_panels(b, {.pixel = 1000 * pixel});
  ASSERT_EQ(a.charts.size(), b.charts.size());
  for (size_t i = 0; i < a.charts.size(); ++i) EXPECT_EQ(a.charts[i].global_triangle, b.charts[i].global_triangle);
}

// A garment that needs longer seams than most may be parted too, but its seams are to stay about what it needs.
TEST(PartPanels, SeamsThatAreLongerThanTheirBudgetAlreadyMayGrowByAShareOfThemselves) {
  Laid laid = laid_flat(fan(0.9 * kPi, 0.5));
  const double pixel = std::sqrt(area_of(laid.charts)) / 256;
  ASSERT_TRUE(part_panels(laid, {.pixel = pixel, .wanted = 0.6, .much_fuller = 1, .most_seam = 0.5}));
  const Filling once = filling_of(laid.charts, laid.sheet, pixel);
  ASSERT_GT(once.seam, 0.2);
  PartingOptions options{.pixel = pixel, .wanted = 0.9, .seam_price = 0.01, .most_seam = 0.2, .most_longer = 3};
  const std::vector<PartedPanels> ways = ways_to_part(laid.charts, laid.sheet, options);
  EXPECT_FALSE(ways.empty());
  for (const PartedPanels& way : ways) {
    EXPECT_LT(filling_of(way.charts, way.sheet, pixel).seam, 1.1 * options.most_longer * once.seam)
        << "along the mesh's edges";
  }
  options.most_longer = 1.1;
  EXPECT_TRUE(ways_to_part(laid.charts, laid.sheet, options).empty());
}

// Rows of buttons and trims have their share of borders for good.
TEST(PartPanels, BordersThatAreOverTheirBudgetAlreadyAreNoReasonToWasteRoom) {
  Laid laid = laid_flat(fan(0.9 * kPi, 0.5));
  const double pixel = std::sqrt(area_of(laid.charts)) / 96;
  const Filling whole = filling_of(laid.charts, laid.sheet, pixel);
  ASSERT_GT(whole.border, 0.07);
  ASSERT_LT(whole.border, 0.09);
  const PartingOptions options{.pixel = pixel};
  EXPECT_TRUE(part_panels(laid, options));
  const Filling parted = filling_of(laid.charts, laid.sheet, pixel);
  EXPECT_LT(parted.border, 0.105);
  EXPECT_LT(misses_of(parted, parted.seam - whole.seam, options), misses_of(whole, 0, options));
}

// By its promise a way is left out when another has kept as much.
TEST(PartPanels, TheMostPromisingWayComesFirstAndPays) {
  const Laid laid = laid_flat(fan(0.9 * kPi, 0.5));
  const double pixel = std::sqrt(area_of(laid.charts)) / 192;
  const PartingOptions options{.pixel = pixel};
  const std::vector<PartedPanels> ways = ways_to_part(laid.charts, laid.sheet, options);
  ASSERT_GT(ways.size(), 1U);
  for (const PartedPanels& way : ways) EXPECT_GE(way.promise, ways.front().promise - 1e-5);
  Laid parted{laid.cut, ways[0].sheet, ways[0].charts};
  for (Chart& c : parted.charts) turn_upright(c);
  const Filling whole = filling_of(laid.charts, laid.sheet, pixel);
  const Filling f = filling_of(parted.charts, parted.sheet, pixel);
  EXPECT_LT(misses_of(f, f.seam - whole.seam, options), misses_of(whole, 0, options))
      << "already with seams along the mesh's edges";
}

// A half empty image is worse than one whose border is a little too long; but what is met stays so, unless another
// target is met for it.
TEST(PartPanels, WhatIsFarOffItsTargetCountsForMore) {
  const PartingOptions options;
  const auto misses = [&](double utilisation, double border) {
    return misses_of({utilisation, border, 0}, 0.2, options);
  };
  EXPECT_LT(misses(0.60, 0.072), misses(0.47, 0.065));
  EXPECT_GT(misses(0.74, 0.080), misses(0.72, 0.065));
  EXPECT_LT(misses(0.80, 0.060), misses(0.74, 0.060)) << "to be full enough is worth something by itself";
  EXPECT_DOUBLE_EQ(misses(0.80, 0.060), misses(0.95, 0.020)) << "what is reached is enough";
  EXPECT_TRUE(gives_up_too_much({0.60, 0.072, 0}, {0.47, 0.065, 0}, options));
  EXPECT_FALSE(gives_up_too_much({0.78, 0.072, 0}, {0.47, 0.065, 0}, options)) << "another target is met for it";
  EXPECT_FALSE(gives_up_too_much({0.60, 0.085, 0}, {0.47, 0.080, 0}, options)) << "it was too long already";
  EXPECT_TRUE(gives_up_too_much({0.46, 0.05, 0.3}, {0.40, 0.03, 0}, options)) << "what lies flat is not cut for little";
  EXPECT_FALSE(gives_up_too_much({0.61, 0.05, 0.3}, {0.40, 0.03, 0}, options)) << "a half more is not little";
  EXPECT_FALSE(gives_up_too_much({0.78, 0.05, 0.3}, {0.70, 0.03, 0}, options)) << "the image is well filled for it";
  EXPECT_FALSE(gives_up_too_much({0.46, 0.05, 0.8}, {0.40, 0.03, 0.5}, options)) << "it has seams already";
  EXPECT_LE(least_misses(0.08, 0.2, options), misses(1, 0.08)) << "no packing is better";
}

// No one wants a flat sheet cut for a few points of memory.
TEST(PartPanels, AFlatSheetIsNotCutForALittleMoreUtilisation) {
  const Laid laid = laid_flat(fan(0.9 * kPi, 0.5));
  const double pixel = std::sqrt(area_of(laid.charts)) / 256;
  PartingOptions options{.pixel = pixel, .most_seam = 0.5};
  EXPECT_TRUE(ways_to_part(laid.charts, laid.sheet, options).empty()) << "so short a seam brings little";
  options.much_fuller = 1;
  EXPECT_FALSE(ways_to_part(laid.charts, laid.sheet, options).empty()) << "though it would bring something";
}

TEST(PartPanels, FillingIsThatOfTheImage) {
  const Laid laid = laid_flat(test::disk(30, 20, 1.5, 1));
  const Filling filling = filling_of(laid.charts, laid.sheet, 0.01);
  EXPECT_NEAR(filling.utilisation, 1, 0.01);
  EXPECT_NEAR(filling.border, 500.0 / (151 * 101), 0.003) << "the rim of 151 x 101 pixels";
  EXPECT_DOUBLE_EQ(filling.seam, 0);
  const Filling loose = unpacked(laid.charts, laid.sheet, 0.01);
  EXPECT_DOUBLE_EQ(loose.border, filling.border);
  EXPECT_DOUBLE_EQ(loose.seam, filling.seam);
}

/// Triangles of a coarse mesh are large beside the cells in which a piece's upward direction is summed up.
TEST(PartPanels, APieceOfACoarseMeshIsThoughtToHangAsItDoes) {
  CleanSurface sheet = test::disk(5, 2);
  for (Point3& p : sheet.position) {
    const double a = 0.9 * kPi * (p[0] - 0.5), r = 1.5 - p[1];
    p = {r * std::sin(a), -r * std::cos(a), 0};
  }
  const Chart chart = laid_flat(sheet).charts.at(0);
  const PanelPlan plan(chart, std::sqrt(total_area(chart)) / 80);
  std::vector<uint32_t> piece;
  for (uint32_t i = 0; i < plan.loop().size(); ++i) {
    if (plan.place(i)[0] < 1e-9) piece.push_back(i);
  }
  std::vector<Point2> outline;
  for (const uint32_t i : piece) outline.push_back(plan.place(i));
  GrainSum sum;
  for (const Triangle& t : chart.triangle) {
    const std::array<Point2, 3> uv{chart.uv[t[0]], chart.uv[t[1]], chart.uv[t[2]]};
    if (uv[0][0] + uv[1][0] + uv[2][0] > 0) continue;
    sum.add(grain_of_triangle({chart.position[t[0]], chart.position[t[1]], chart.position[t[2]]}, uv));
  }
  ASSERT_GT(sum.area, 0.3 * total_area(chart));
  const Point2 thought = plan.up_of(piece), true_up = upward(sum, outline);
  EXPECT_NEAR(std::atan2(thought[0], thought[1]), std::atan2(true_up[0], true_up[1]), 0.02);
}

/// Darts that were drawn straight once would lose length each time.
TEST(PartPanels, SeamsThatThereWereStayWhereTheyAre) {
  const Laid laid = laid_flat(fan(0.9 * kPi));
  const double pixel = std::sqrt(area_of(laid.charts)) / 192;
  const std::vector<PartedPanels> ways = ways_to_part(laid.charts, laid.sheet, {.pixel = pixel, .seam_price = 0.05});
  ASSERT_FALSE(ways.empty());
  for (const PartedPanels& way : ways) {
    for (const uint32_t v : outline_loop(laid.charts[0])) {
      EXPECT_NE(way.sheet.pinned[laid.sheet.of_vertex[laid.charts[0].cut_vertex[v]]], 0);
    }
    size_t free = 0;
    for (const uint32_t v : outline_loop(way.charts[0])) {
      if (way.sheet.pinned[laid.sheet.of_vertex[way.charts[0].cut_vertex[v]]] == 0) ++free;
    }
    EXPECT_GT(free, 0U) << "the new seam";
  }
}

/// The new seams end where they were chosen: if they slid to where they are shortest, the pieces would be others.
TEST(PartPanels, AWideSkirtFillsTheImageBetter) {
  const CleanSurface skirt = fan(0.9 * kPi, 0.5);
  const CutSurface cut = cut_to_disks(skirt);
  const Laid laid = laid_flat(skirt);
  DevelopOptions options;
  const DevelopedSurface whole = develop(cut, options);
  options.parting.pixel = std::sqrt(area_of(laid.charts)) / 192;
  const DevelopedSurface parted = develop(cut, options);
  EXPECT_EQ(whole.cut.component_count, 1U);
  EXPECT_GT(parted.cut.component_count, 1U);
  std::vector<Chart> charts;
  for (std::vector<uint32_t>& t : triangles_of_components(parted.cut)) {
    Chart c = extract_chart(parted.cut, std::move(t));
    for (const uint32_t v : c.cut_vertex) c.uv.push_back(parted.uv[v]);
    charts.push_back(std::move(c));
  }
  EXPECT_NEAR(area_of(charts), area_of(laid.charts), 1e-9);
  EXPECT_GT(filling_of(charts, find_sheet(parted.cut), options.parting.pixel).utilisation,
            utilisation_of(laid, options.parting.pixel) + 0.05);
  for (const double e : parted.energy) EXPECT_LT(e, 4.001) << "a flat skirt in pieces is flat";
}

}  // namespace
}  // namespace geocloth
