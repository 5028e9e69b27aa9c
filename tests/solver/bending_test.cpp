// SPDX-License-Identifier: GPL-3.0-or-later
// Bending with a rigidity where no closed form of a flat strip shows it: over seams, for a curved rest shape, on a grid
// whose lines are not straight, and beside the seeds' springs.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/grid_mesh.h"
#include "solver_fixture.h"

namespace geocloth {
namespace {

double farthest_from(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double farthest = 0;
  for (size_t k = 0; k < a.size(); ++k) farthest = std::max(farthest, static_cast<double>(length(a[k] - b[k])));
  return farthest;
}

/// Lets a cloth be for half a second without gravity; how far it moved [m].
double drift(const ClothDesc& cloth) {
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  Solver solver(std::vector{cloth}, settings);
  test::run(solver, 30);
  return farthest_from(test::positions_of(solver), cloth.asset->rest_position);
}

TEST(Bending, ACurvedRestShapeIsAtRestHoweverItIsCut) {
  Material material;
  material.bend_warp = material.bend_weft = 1e-3F;
  for (const uint32_t charts : {1U, 4U}) {
    const test::TubeOptions options{.nx = 24, .ny = 17, .charts_x = charts, .charts_y = charts};
    EXPECT_LT(drift(test::describe(make_tube(options), material)), 1e-5) << charts;
  }
}

// A soft knit: bending that straightened the lines within the sheet would pull it out of shape.
TEST(Bending, GridLinesThatAreNotStraightDoNotPullAFlatSheetOutOfShape) {
  Material material;
  material.stretch_warp = 3.27F;
  material.stretch_weft = 12.49F;
  material.shear = 8.81F;
  material.bend_warp = material.bend_weft = 6e-5F;
  const test::SheetOptions options{.nx = 33, .ny = 33, .width = 0.2F, .height = 0.2F, .charts_x = 2, .jitter = 0.2F};
  const double spacing = 0.2 / 32;
  EXPECT_LT(drift(test::describe(make_sheet(options), material)), 0.02 * spacing);
}

// A button of 26 pixels in measured cotton, without gravity, shook and spun ten times a second: lines that were
// straightened pulled at it.
TEST(Bending, GridLinesWithSharpTurnsLeaveAFreePieceAtRest) {
  const Material& cotton = find_material_preset("cotton")->material;
  for (const uint32_t charts : {1U, 2U}) {
    const test::SheetOptions options{
        .nx = 7, .ny = 7, .width = 0.08F, .height = 0.08F, .charts_x = charts, .jitter = 0.35F};
    const double moved = drift(test::describe(make_sheet(options), cotton));
    RecordProperty("mm", std::to_string(1000 * moved));
    EXPECT_LT(moved, 0.05 * 0.08 / 6) << charts;
  }
}

/// Elastic energy [J] that it takes to roll a knit of 20 cm a little; its grid points are moved by a share of the
/// spacing.
double rolled_energy(float jitter, bool across) {
  constexpr double kRadius = 0.5;
  Material material;
  material.stretch_warp = material.stretch_weft = 10;
  material.shear = 3;
  material.bend_warp = material.bend_weft = 6e-5F;
  const ClothDesc cloth = test::describe(
      test::make_sheet({.nx = 33, .ny = 33, .width = 0.2F, .height = 0.2F, .charts_x = 2, .jitter = jitter}), material);
  std::vector<Vec3> x = cloth.asset->rest_position;
  for (Vec3& p : x) {
    const double angle = static_cast<double>(across ? p.x : p.y) / kRadius;
    const auto along = static_cast<float>(kRadius * std::sin(angle));
    p = {across ? along : p.x, across ? p.y : along, static_cast<float>(kRadius * (1 - std::cos(angle)))};
  }
  const std::vector<Vec3> still(x.size());
  return measure_energy(cloth, {}, x, still).elastic -
         measure_energy(cloth, {}, cloth.asset->rest_position, still).elastic;
}

// Before a fourth point took up what a grid line turns within the sheet, kinked bends yielded to small curvatures.
TEST(Bending, IsAsStiffOnAGridWhoseLinesAreNotStraight) {
  for (const bool across : {false, true}) {
    const double straight = rolled_energy(0, across);
    EXPECT_NEAR(straight, 0.5 * 6e-5 / (0.5 * 0.5) * 0.2 * 0.2, 0.05 * straight);  // B A curvature^2 / 2
    EXPECT_NEAR(rolled_energy(0.1F, across), straight, 0.05 * straight);
    EXPECT_NEAR(rolled_energy(0.2F, across), straight, 0.15 * straight);
  }
}

/// Takes pixels out of a sheet, with their springs and triangles; areas are shared anew.
void keep_pixels(ClothAsset& asset, const std::vector<bool>& kept) {
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!kept[p]) {
      asset.chart[p] = kNoChart;
      asset.rest_position[p] = {};
    }
    for (uint32_t s = 0; s < kSpringCount; ++s) {
      const auto to = static_cast<int64_t>(p) + kSpringOffset[s][1] * int64_t{asset.width} + kSpringOffset[s][0];
      const bool leads = (asset.spring_mask[p] & (1U << s)) != 0;
      if (leads && !(kept[p] && kept[static_cast<size_t>(to)]))
        asset.spring_mask[p] &= static_cast<uint8_t>(~(1U << s));
    }
    if (asset.cell[p] == 0) continue;
    const bool left = (asset.cell[p] & kCellDiagonalLeft) != 0;
    const bool a = kept[p], b = kept[p + 1], c = kept[p + asset.width], d = kept[p + asset.width + 1];
    uint8_t cell = left ? kCellDiagonalLeft : 0;
    if (left ? a && c && b : a && c && d) cell |= kCellFirst;
    if (left ? b && c && d : a && d && b) cell |= kCellSecond;
    asset.cell[p] = cell;
  }
  const auto first = static_cast<uint32_t>(std::find(kept.begin(), kept.end(), true) - kept.begin());
  for (Binding& binding : asset.binding) binding.pixel = {first, first, first};  // nobody looks at the vertices
  asset.area.assign(asset.pixel_count(), 0);
  const auto& x = asset.rest_position;
  for (const auto& t : pixel_triangles(asset))
    for (const uint32_t p : t) asset.area[p] += length(cross(x[t[1]] - x[t[0]], x[t[2]] - x[t[0]])) / 6;
}

/// What a strip at 45 degrees to the grid stores as a cylinder along it, of what the cloth should.
/// @param lines  of pixels along the strip, beside the middle one on each side
double rigidity_of_bias_strip(int32_t lines, bool with_bias) {
  constexpr double kCurvature = 0.5, kRigidity = 1;
  constexpr int32_t kPoints = 49, kHalfLength = 40;
  ClothAsset asset = test::make_sheet({.nx = kPoints, .ny = kPoints});
  std::vector<bool> kept(asset.pixel_count());
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    const auto i = static_cast<int32_t>(p % asset.width), j = static_cast<int32_t>(p / asset.width);
    kept[p] = asset.valid(p) && std::abs(i - j) <= lines && std::abs(i + j - (kPoints - 1)) <= kHalfLength;
    // the diagonals of the outline run along it
    if (asset.cell[p] != 0) {
      const bool at_side = std::abs(i - j) >= lines - 1;
      asset.cell[p] = static_cast<uint8_t>(kCellFirst | kCellSecond | (at_side ? 0 : kCellDiagonalLeft));
    }
  }
  keep_pixels(asset, kept);
  double area = 0;
  for (const float a : asset.area) area += static_cast<double>(a);

  Material material;
  material.bend_warp = material.bend_weft = kRigidity;
  if (with_bias) material.bend_bias = kRigidity;
  const ClothDesc cloth = test::describe(std::move(asset), material);
  std::vector<Vec3> x = cloth.asset->rest_position;
  for (Vec3& p : x) {
    const double along = static_cast<double>(p.x - p.y) / std::sqrt(2), across = static_cast<double>(p.x + p.y) / 2;
    const double bent = std::sin(kCurvature * along) / kCurvature / std::sqrt(2);
    p = {static_cast<float>(across + bent), static_cast<float>(across - bent),
         static_cast<float>((1 - std::cos(kCurvature * along)) / kCurvature)};
  }
  const std::vector<Vec3> still(x.size());
  const double stored = measure_energy(cloth, {}, x, still).elastic -
                        measure_energy(cloth, {}, cloth.asset->rest_position, still).elastic;
  return stored / (0.5 * kRigidity * kCurvature * kCurvature * area * (with_bias ? 1 : 0.5));
}

// Lines that end at a slanted outline left their share of the rigidity there: a strip four spacings wide had half of
// it.
TEST(Bending, ANarrowStripOnTheBiasHasTheRigidityOfTheCloth) {
  for (const bool with_bias : {true, false})
    for (const int32_t lines : {3, 6, 11})  // 4, 8 and 16 spacings across
      EXPECT_NEAR(rigidity_of_bias_strip(lines, with_bias), 1, 0.01) << lines << (with_bias ? ", bias" : "");
}

/// A sheet of 16 x 8 cells, whole or cut from top to bottom along a diagonal of its grid, the second panel beside the
/// first one in the image.
ClothAsset make_sheet_in_two(bool cut) {
  constexpr uint32_t kColumns = 17, kRows = 9, kTop = 4, kBeside = 20;
  constexpr float kCell = 1.F / 16;
  ClothAsset asset = test::make_sheet({.nx = kBeside + kColumns,
                                       .ny = kRows,
                                       .width = kCell * (kBeside + kColumns - 1),
                                       .height = kCell * (kRows - 1)});
  std::vector<bool> kept(asset.pixel_count());
  const auto pixel = [&](uint32_t i, uint32_t j) { return j * asset.width + i; };
  for (uint32_t j = 0; j < kRows; ++j)
    for (uint32_t i = 0; i < kColumns; ++i) {
      kept[pixel(i, j)] = !cut || i <= kTop + j;
      kept[pixel(kBeside + i, j)] = cut && i >= kTop + j;
      asset.rest_position[pixel(kBeside + i, j)] = asset.rest_position[pixel(i, j)];
    }
  for (uint8_t& cell : asset.cell)
    if (cell != 0) cell = kCellFirst | kCellSecond;  // the diagonal of the seam
  keep_pixels(asset, kept);
  if (!cut) return asset;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (kept[p] && p % asset.width >= kBeside) asset.chart[p] = 1;
  asset.chart_count = 2;
  asset.splits.offset = {0};
  for (uint32_t j = 0; j < kRows; ++j) {
    const uint32_t i = kTop + j;
    asset.splits.pixel.insert(asset.splits.pixel.end(), {pixel(i, j), pixel(kBeside + i, j)});
    asset.splits.offset.push_back(static_cast<uint32_t>(asset.splits.pixel.size()));
    if (j == 0 || j == kRows - 1) continue;
    const uint32_t a = pixel(i - 1, j + 1), b = pixel(kBeside + i + 1, j - 1);
    const auto& x = asset.rest_position;
    asset.seam_bends.push_back({a, pixel(i, j), b, length(x[b] - x[a])});
  }
  return asset;
}

/// [J] What a sheet in the xy plane stores as a cylinder along x.
double cylinder_energy(const ClothDesc& cloth) {
  constexpr double kCurvature = 0.5;
  std::vector<Vec3> x = cloth.asset->rest_position;
  for (Vec3& p : x) {
    const double angle = kCurvature * static_cast<double>(p.x);
    p.x = static_cast<float>(std::sin(angle) / kCurvature);
    p.z = static_cast<float>((1 - std::cos(angle)) / kCurvature);
  }
  const std::vector<Vec3> still(x.size());
  return measure_energy(cloth, {}, x, still).elastic -
         measure_energy(cloth, {}, cloth.asset->rest_position, still).elastic;
}

// One bend over each point of such a seam, at 45 degrees, saw half of the curvature along the rows: the seam folded.
TEST(Bending, ASeamAcrossTheGridBendsAsTheClothDoes) {
  for (const bool with_bias : {false, true}) {
    Material material;
    material.bend_warp = material.bend_weft = 1;
    if (with_bias) material.bend_bias = 1;
    const double whole = cylinder_energy(test::describe(make_sheet_in_two(false), material));
    const double sewn = cylinder_energy(test::describe(make_sheet_in_two(true), material));
    EXPECT_NEAR(sewn, whole, 0.01 * whole) << with_bias;
  }
}

// Measured cotton on a grid of 3 mm is much stiffer than one sweep of its curvatures can be. Swept in one direction
// only it gained energy, and the cloth trembled for ever, by 3 mm from frame to frame.
TEST(Bending, StiffClothOverABallComesToRest) {
  for (const uint32_t charts : {1U, 2U}) {
    for (const uint32_t relaxation_steps : {1U, 2U}) {
      const test::SheetOptions options{
          .nx = 65, .ny = 65, .width = 0.2F, .height = 0.2F, .charts_x = charts, .horizontal = true};
      SolverSettings settings = test::cpu_settings();
      settings.substeps = 16;
      settings.relaxation_steps = relaxation_steps;
      const ClothDesc cloth = test::describe(make_sheet(options), find_material_preset("cotton")->material);
      Solver solver({&cloth, 1}, settings);
      solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, -0.06F, 0}, 0.05F}, 0.4F, {}}});
      test::run(solver, 180);
      const double tremble = test::tremble(solver, 20);
      RecordProperty("mm", std::to_string(1000 * tremble));
      EXPECT_LT(tremble, 0.0002) << charts << " charts, " << relaxation_steps << " relaxation steps";
    }
  }
}

// Bent by an angle at the clamp alone, a strip has the curvature 2 sin(angle / 2) / spacing over a free half cell,
// which is the curvature of a whole one at a free row: B curvature^2 there for half of that elsewhere.
TEST(Bending, EnergyCountsAClampAsItActs) {
  constexpr double kAngle = 0.2, kWidth = 0.1, kRigidity = 1e-4;
  Material material;
  material.bend_warp = material.bend_weft = static_cast<float>(kRigidity);
  for (const uint32_t charts : {1U, 2U}) {  // with two, the clamp lies on their seam and the bend is in the list
    const test::SheetOptions options{.nx = 5, .ny = 5, .width = 0.1F, .height = 0.1F, .charts_y = charts};
    const ClothDesc cloth = test::describe(test::make_sheet(options), material);
    Solver solver(std::vector{cloth}, test::cpu_settings());
    std::vector<Vec3> x = cloth.asset->rest_position;
    std::vector<Pin> pins;
    for (const uint32_t row : {0U, 1U, 2U})
      for (uint32_t column = 0; column < 5; ++column) {
        const uint32_t pixel = test::sheet_pixel(options, column, row);
        pins.push_back({pixel, x[pixel]});
      }
    pins.push_back({test::sheet_pixel(options, 0, 4), {}, 2.0F});  // a soft pin holds nothing
    solver.set_pins(0, pins);
    EXPECT_THAT(solver.held_pixels(0), testing::SizeIs(10 + 5 * charts));

    const double spacing = 0.025;
    const float clamp = x[pins[10].pixel].y, way = clamp - x[pins[5].pixel].y;
    for (Vec3& p : x) {
      const float rows = std::round((p.y - clamp) / way);
      if (rows <= 0) continue;
      p.y = clamp + rows * way * static_cast<float>(std::cos(kAngle));
      p.z = rows * static_cast<float>(spacing * std::sin(kAngle));
    }
    const std::vector<Vec3> still(x.size());
    const double curvature = 2 * std::sin(kAngle / 2) / spacing;
    const double free_bend = kRigidity / 2 * curvature * curvature * kWidth * spacing;
    const EnergyMeter meter(cloth);
    EXPECT_NEAR(meter.measure({}, x, still).elastic, free_bend, 0.001 * free_bend) << charts;
    EXPECT_NEAR(meter.measure({}, x, still, solver.held_pixels(0)).elastic, 2 * free_bend, 0.002 * free_bend) << charts;
  }
}

/// Height / width of a strip of 20 cm that is clamped at one end, Gamma = w L^3 / B = 5, cut into charts.
double droop(uint32_t charts_x, uint32_t charts_y) {
  constexpr uint32_t kCells = 12;
  constexpr double kLength = 0.2, kCell = kLength / (kCells - 1);  // clamped at row 1
  const test::SheetOptions options{.nx = 5,
                                   .ny = kCells + 1,
                                   .width = static_cast<float>(4 * kCell),
                                   .height = static_cast<float>(kCells * kCell),
                                   .charts_x = charts_x,
                                   .charts_y = charts_y,
                                   .horizontal = true};
  Material material;
  material.stretch_warp = material.stretch_weft = 5000;
  material.shear = 500;
  material.damping = 8;
  material.max_stretch = 0;
  material.bend_warp = material.bend_weft = static_cast<float>(0.2 * 9.81 * kLength * kLength * kLength / 5);
  const ClothDesc cloth = test::describe(make_sheet(options), material);
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 32;
  settings.relaxation_steps = 4;
  Solver solver(std::vector{cloth}, settings);
  std::vector<Pin> pins;
  for (uint32_t j = 0; j < 2; ++j) {
    for (uint32_t i = 0; i < options.nx; ++i) {
      const uint32_t pixel = test::sheet_pixel(options, i, j);
      pins.push_back({pixel, cloth.asset->rest_position[pixel]});
    }
  }
  solver.set_pins(0, pins);
  test::run(solver, 180);
  const std::vector<Vec3> x = test::positions_of(solver);
  const Vec3 tip = x[test::sheet_pixel(options, 2, kCells)], clamp = x[test::sheet_pixel(options, 2, 0)];
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  return static_cast<double>(clamp.y - tip.y) / (static_cast<double>(tip.z - clamp.z) - kCell);
}

TEST(Bending, ASeamIsNoHinge) {
  constexpr double kHeavyElastica = 0.5857;
  for (const auto& [charts_x, charts_y] : {std::pair{1U, 1U}, std::pair{1U, 4U}, std::pair{2U, 4U}}) {
    EXPECT_NEAR(droop(charts_x, charts_y), kHeavyElastica, 0.03 * kHeavyElastica) << charts_x << " x " << charts_y;
  }
}

std::vector<std::string> passes_with(const Material& material) {
  SolverSettings settings = test::cpu_settings();
  settings.timings = true;
  Solver solver(std::vector{test::describe(test::make_sheet({.nx = 9, .ny = 9, .charts_x = 2}), material)}, settings);
  test::run(solver, 2);
  std::vector<std::string> names;
  for (const PassTiming& timing : solver.statistics().passes) names.push_back(timing.pass);
  return names;
}

TEST(Bending, TheSeedsSpringsAndTheRigidityExcludeEachOther) {
  Material seeds;
  seeds.bend_stiffness = 0.5F;
  EXPECT_THAT(passes_with(seeds), testing::IsSupersetOf({"bending", "seam_bends"}));
  EXPECT_THAT(passes_with(seeds), testing::Not(testing::Contains("curvature")));
  EXPECT_THAT(passes_with({}), testing::IsSupersetOf({"curvature", "seam_curvature"}));
  EXPECT_THAT(passes_with({}), testing::Not(testing::Contains("bending")));
  Material limp;
  limp.bend_warp = limp.bend_weft = 0;
  EXPECT_THAT(passes_with(limp), testing::Not(testing::Contains("curvature")));
}

}  // namespace
}  // namespace geocloth
