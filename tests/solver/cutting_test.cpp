// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth that is cut while it moves: what is cut off falls freely, what hangs stays, and nothing is left between them.
// A cut that does not part the sides of a seam, or leaves an attachment, would hold the piece up in the air.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "geocloth/solver/scene.h"
#include "solver_fixture.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

using test::describe;
using test::make_sheet;
using test::pins_at_rest;
using test::positions_of;
using test::run;
using test::SheetOptions;
using test::velocities_of;
using Triangle3 = std::array<Vec3, 3>;

constexpr double kGravity = 9.81;  // [m/s^2]

/// A 1 m sheet about the origin in the xy plane, its top at y = 0.5.
SheetOptions sheet_options(uint32_t charts_x = 1, uint32_t charts_y = 1) {
  return {.nx = 21, .ny = 21, .charts_x = charts_x, .charts_y = charts_y};
}

/// Level, wider than the sheet, at this height; the other one completes it to a rectangle.
Triangle3 level_cut(float y) {
  return {Vec3{-3, y, -2}, Vec3{3, y, -2}, Vec3{0, y, 4}};
}
/// Upright from the hem to this height, at this x.
Triangle3 upright_cut(float x, float top) {
  return {Vec3{x, -6, -8}, Vec3{x, -6, 8}, Vec3{x, top, 0}};
}

Material inelastic() {
  Material material = test::undamped();
  material.max_stretch = 0.01F;
  return material;
}

Solver hanging(const ClothDesc& cloth, uint32_t threads = 1, SolverPath path = SolverPath::automatic) {
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 8;
  settings.threads = threads;
  settings.path = path;
  Solver solver(std::vector{cloth}, settings);
  solver.set_pins(0, pins_at_rest(*cloth.asset, "top"));
  return solver;
}

/// Segments of springs of the asset that cross the plane y = height.
uint32_t springs_across(const ClothAsset& asset, const std::vector<Vec3>& position, float height) {
  uint32_t count = 0;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    for (uint32_t c = 0; c < kSpringCount; ++c) {
      if ((asset.spring_mask[p] & (1U << c)) == 0) continue;
      const auto q = static_cast<size_t>(int64_t{p} + kSpringOffset[c][0] + int64_t{asset.width} * kSpringOffset[c][1]);
      count += static_cast<uint32_t>((position[p].y - height) * (position[q].y - height) < 0);
    }
  return count;
}

struct Piece {
  double mass = 0, height = 0, speed = 0;  ///< [kg], [m] of the middle, [m/s] upwards
};
/// Of the points that began below a height.
Piece piece_below(Solver& solver, const ClothDesc& cloth, float height) {
  Piece piece;
  const std::vector<double> mass = test::masses_of(cloth);
  const std::vector<Vec3> position = positions_of(solver), velocity = velocities_of(solver);
  for (uint32_t p = 0; p < position.size(); ++p) {
    if (!cloth.asset->valid(p) || cloth.asset->rest_position[p].y > height) continue;
    piece.mass += mass[p];
    piece.height += mass[p] * static_cast<double>(position[p].y);
    piece.speed += mass[p] * static_cast<double>(velocity[p].y);
  }
  piece.height /= piece.mass;
  piece.speed /= piece.mass;
  return piece;
}

class CutAcross : public testing::TestWithParam<std::pair<uint32_t, uint32_t>> {};

TEST_P(CutAcross, WhatHangsBelowFallsFreelyAndTheRestStays) {
  const ClothDesc cloth = describe(make_sheet(sheet_options(GetParam().first, GetParam().second)), inelastic());
  constexpr float kHeight = 0.02F;  // between two rows at rest, and still while it hangs
  Solver solver = hanging(cloth);
  run(solver, 5);
  const uint64_t springs = solver.statistics().springs;
  const CutResult cut = solver.cut(0, level_cut(kHeight));
  EXPECT_GE(cut.springs, 21U + 2 * 20U + 2 * 21U);
  EXPECT_GE(cut.cells, 20U);
  EXPECT_EQ(springs_across(*solver.asset(0), positions_of(solver), kHeight), 0U);
  EXPECT_EQ(solver.statistics().springs, springs - cut.springs);
  validate(*solver.asset(0));

  const Piece start = piece_below(solver, cloth, 0.01F);
  constexpr uint32_t kFrames = 30;
  run(solver, kFrames);
  const Piece end = piece_below(solver, cloth, 0.01F);
  const double t = kFrames / 60.0, dt = 1 / (60.0 * 8);
  EXPECT_NEAR(end.height - start.height, start.speed * t - kGravity * t * t / 2, kGravity * t * dt);
  EXPECT_NEAR(end.speed - start.speed, -kGravity * t, 1e-3);

  const std::vector<Vec3> position = positions_of(solver);
  for (uint32_t p = 0; p < position.size(); ++p) {
    if (cloth.asset->valid(p) && cloth.asset->rest_position[p].y > 0.03F) {
      EXPECT_GT(position[p].y, -0.1F) << p;
    }
  }
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

INSTANTIATE_TEST_SUITE_P(Charts, CutAcross, testing::Values(std::pair{1U, 1U}, std::pair{2U, 1U}, std::pair{3U, 2U}));

TEST(CutAlongASeam, PartsItsCopiesAndNothingElse) {
  const ClothDesc cloth = describe(make_sheet(sheet_options(1, 2)), inelastic());
  Solver solver = hanging(cloth);  // the seam is at y = 0
  const CutResult cut = solver.cut(0, level_cut(0));
  EXPECT_EQ(cut.parted_points, 21U);
  EXPECT_EQ(cut.cells, 0U);
  EXPECT_EQ(cut.springs, cloth.asset->seam_bends.size());
  EXPECT_EQ(solver.asset(0)->splits.rows(), 0U);
  EXPECT_EQ(solver.asset(0)->spring_mask, cloth.asset->spring_mask);
  run(solver, 30);
  EXPECT_NEAR(piece_below(solver, cloth, -0.03F).height, -0.275 - kGravity / 8, 0.02);
  const std::vector<Vec3> position = positions_of(solver);
  double lowest_above = 1, highest_below = -10;
  for (uint32_t r = 0; r < cloth.asset->splits.rows(); ++r) {
    const uint32_t k = cloth.asset->splits.offset[r];
    const float upper = position[cloth.asset->splits.pixel[k]].y, lower = position[cloth.asset->splits.pixel[k + 1]].y;
    lowest_above = std::min(lowest_above, static_cast<double>(upper));
    highest_below = std::max(highest_below, static_cast<double>(lower));
  }
  EXPECT_GT(lowest_above, -0.1);
  EXPECT_LT(highest_below, -1);
}

TEST(CutAlongASeam, PartsOneOfTwoThatCross) {
  const ClothDesc cloth = describe(make_sheet(sheet_options(2, 2)), inelastic());
  Solver solver = hanging(cloth);
  EXPECT_EQ(solver.cut(0, level_cut(0)).parted_points, 21U);
  validate(*solver.asset(0));
  EXPECT_EQ(solver.asset(0)->splits.rows(), 22U);  // the other seam: 21 points, of which the middle is two
  run(solver, 20);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  EXPECT_LT(piece_below(solver, cloth, -0.03F).height, -0.7);
}

TEST(CutAlongTheHem, MeetsNoSpring) {
  Solver solver = hanging(describe(make_sheet(sheet_options())));
  EXPECT_EQ(solver.cut(0, level_cut(-0.5F)), CutResult{});
}

TEST(Slit, OpensWhileTheSheetStillHangs) {
  const SheetOptions options = sheet_options();
  const ClothDesc cloth = describe(make_sheet(options), inelastic());
  Solver solver = hanging(cloth);
  EXPECT_GT(solver.cut(0, upright_cut(0.025F, 0.1F)).springs, 20U);
  const uint32_t left = test::sheet_pixel(options, 10, 20), right = test::sheet_pixel(options, 11, 20);
  // Drawn apart by its lower corners.
  std::vector<Pin> pins = pins_at_rest(*cloth.asset, "top");
  for (int f = 1; f <= 30; ++f) {
    const float way = 0.01F * static_cast<float>(f);
    std::vector<Pin> all = pins;
    all.push_back({test::sheet_pixel(options, 0, 20), Vec3{-0.5F - way, -0.5F + way, 0}});
    all.push_back({test::sheet_pixel(options, 20, 20), Vec3{0.5F + way, -0.5F + way, 0}});
    solver.set_pins(0, all);
    solver.step();
  }
  const std::vector<Vec3> position = positions_of(solver);
  EXPECT_GT(length(position[left] - position[right]), 0.2F);
  const uint32_t above = test::sheet_pixel(options, 10, 5), beside = test::sheet_pixel(options, 11, 5);
  EXPECT_LT(length(position[above] - position[beside]), 0.06F);
  for (uint32_t p = 0; p < position.size(); ++p) EXPECT_GT(position[p].y, -0.8F) << p;
}

TEST(Cut, BeforeItNothingIsDifferentAndMissingChangesNothing) {
  const ClothDesc cloth = describe(make_sheet(sheet_options(2)));
  Solver plain = hanging(cloth), missed = hanging(cloth);
  run(plain, 4);
  run(missed, 2);
  EXPECT_EQ(missed.cut(0, {Vec3{4, 0, 0}, Vec3{5, 0, 0}, Vec3{4, 1, 1}}), CutResult{});
  run(missed, 2);
  EXPECT_EQ(hash_state(*cloth.asset, positions_of(plain)), hash_state(*cloth.asset, positions_of(missed)));
  EXPECT_EQ(missed.asset(0), cloth.asset);
}

TEST(Cut, ThreadsAndPathsDoNotChangeTheResult) {
  const ClothDesc cloth = describe(make_sheet({.nx = 40, .ny = 40, .charts_x = 2, .charts_y = 2}));
  const auto hash = [&](uint32_t threads, SolverPath path) {
    Solver solver = hanging(cloth, threads, path);
    run(solver, 3);
    solver.cut(0, upright_cut(0.1F, 0.2F));
    solver.cut(0, level_cut(-0.21F));
    run(solver, 5);
    return hash_state(*cloth.asset, positions_of(solver));
  };
  const uint64_t one = hash(1, SolverPath::automatic);
  EXPECT_EQ(one, hash(1, SolverPath::automatic));
  EXPECT_EQ(one, hash(2, SolverPath::automatic));
  EXPECT_EQ(one, hash(3, SolverPath::plain));
}

TEST(Cut, SeveralRelaxationStepsAndMomentumGoOn) {
  const ClothDesc cloth = describe(make_sheet(sheet_options(2, 2)), inelastic());
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 4;
  settings.relaxation_steps = 3;
  for (const bool momentum : {false, true}) {
    settings.keep_momentum = momentum;
    Solver solver(std::vector{cloth}, settings);
    solver.set_pins(0, pins_at_rest(*cloth.asset, "top"));
    run(solver, 3);
    solver.cut(0, level_cut(0.03F));
    run(solver, 27);
    EXPECT_LT(piece_below(solver, cloth, 0).height, -0.9) << momentum;
    EXPECT_TRUE(test::all_finite(positions_of(solver)));
  }
}

TEST(Cut, InOneFrameSeveralTakeAPieceOut) {
  const ClothDesc cloth = describe(make_sheet(sheet_options()), inelastic());
  Solver solver = hanging(cloth);
  const uint64_t springs = solver.statistics().springs;
  uint64_t severed = 0;
  for (const float x : {-0.22F, 0.23F}) severed += solver.cut(0, upright_cut(x, 0.9F)).springs;
  for (const float y : {-0.27F, 0.22F}) severed += solver.cut(0, level_cut(y)).springs;
  EXPECT_LT(solver.statistics().springs, springs);
  EXPECT_GT(severed, 0U);
  run(solver, 30);
  const std::vector<Vec3> position = positions_of(solver);
  EXPECT_LT(position[test::sheet_pixel(sheet_options(), 10, 10)].y, -1.1F);  // the piece between
  EXPECT_LT(position[test::sheet_pixel(sheet_options(), 10, 18)].y, -1.3F);
  EXPECT_GT(position[test::sheet_pixel(sheet_options(), 10, 2)].y, 0.3F);  // hangs
  EXPECT_EQ(solver.asset(0)->area, cloth.asset->area);                     // and its mass
}

TEST(Cut, AttachmentsRunAroundTheSlit) {
  const SheetOptions options = sheet_options();
  const ClothDesc cloth = describe(make_sheet(options), inelastic());
  SolverSettings settings = test::cpu_settings();
  Solver solver(std::vector{cloth}, settings);
  const auto corner = [&](float y) {
    solver.set_pins(0, std::vector<Pin>{{test::sheet_pixel(options, 0, 0), Vec3{-0.5F, y, 0}}});
  };
  corner(0.5F);
  // All but the right edge: then the lower half hangs on the end of the upper one.
  solver.cut(0, {Vec3{-4, 0.02F, -4}, Vec3{0.43F, 0.02F, 0}, Vec3{-4, 0.02F, 4}});
  run(solver, 120);
  // Straight down there are 1 m of cloth from the pin to the lower left corner, around the slit more than 1.8 m.
  EXPECT_LT(positions_of(solver)[test::sheet_pixel(options, 0, 20)].y, 0.5F - 1.2F);
}

TEST(Cut, OpenCellsFeelNoWindAndMeetNoCollider) {
  const ClothAsset asset = make_sheet(sheet_options());
  Solver solver = hanging(describe(asset));
  solver.cut(0, level_cut(0.02F));
  std::vector<Vec3> normal;
  solver.read_normals(0, normal);
  for (const uint8_t cell : {solver.asset(0)->cell[9 * 21 + 4], solver.asset(0)->cell[9 * 21 + 12]}) EXPECT_EQ(cell, 0);
  EXPECT_NEAR(normal[4 * 21 + 4].z, 1, 1e-6);
  EXPECT_LT(pixel_triangles(*solver.asset(0)).size(), pixel_triangles(asset).size());
}

TEST(Cut, TheSourceMeshOpensAndItsVerticesStayWhereTheyAre) {
  const ClothDesc cloth = describe(make_sheet(sheet_options()), inelastic());
  Solver solver = hanging(cloth);
  run(solver, 4);
  std::vector<Vec3> normal, before, after;
  solver.read_normals(0, normal);
  evaluate_binding(*cloth.asset, positions_of(solver), normal, before);
  solver.cut(0, level_cut(0.02F));
  const ClothAsset& cut = *solver.asset(0);
  evaluate_binding(cut, positions_of(solver), normal, after);
  ASSERT_EQ(after.size(), before.size());
  for (size_t v = 0; v < after.size(); ++v) EXPECT_LT(length(after[v] - before[v]), 1e-5F) << v;
  EXPECT_LT(cut.source.triangle.size(), cloth.asset->source.triangle.size());

  run(solver, 40);
  solver.read_normals(0, normal);
  evaluate_binding(cut, positions_of(solver), normal, after);
  for (const Triangle& t : cut.source.triangle)
    for (size_t i = 0; i < 3; ++i) EXPECT_LT(length(after[t[i]] - after[t[(i + 1) % 3]]), 0.12F) << "spans the gap";
}

TEST(SceneCut, ComesAtItsTime) {
  const test::TemporaryFolder folder;
  write_asset(make_sheet(sheet_options()), folder / "sheet.glb");
  const Scene scene = parse_scene(R"({ "version": 1, "cloths": [ { "asset": "sheet.glb",
      "pins": [ { "where": { "vertex_group": "top" } } ],
      "cuts": [ { "time": 0.1, "triangle": [[-3, 0.02, -2], [3, 0.02, -2], [0, 0.02, 4]] },
                { "time": 0.1, "triangle": [[0.02, -3, -2], [0.02, -3, 2], [0.02, 0.1, 0]] },
                { "time": 0.155, "triangle": [[7, 0, 0], [8, 0, 0], [7, 1, 0]] } ] } ] })",
                                  folder / "scene.json");
  Simulation simulation(scene, test::cpu_settings());
  const std::shared_ptr<const ClothAsset> whole = simulation.cloths()[0].asset;
  for (int f = 0; f < 6; ++f) simulation.step();
  EXPECT_EQ(simulation.cloths()[0].asset, whole);
  simulation.step();
  const std::shared_ptr<const ClothAsset> cut = simulation.cloths()[0].asset;
  EXPECT_LT(pixel_triangles(*cut).size(), pixel_triangles(*whole).size() - 40);
  for (int f = 0; f < 40; ++f) simulation.step();
  EXPECT_EQ(simulation.cloths()[0].asset, cut);
  EXPECT_LT(positions_of(simulation.solver())[test::sheet_pixel(sheet_options(), 3, 15)].y, -1.5F);
}

std::string refusal_of(const Triangle3& triangle, uint32_t cloth = 0) {
  Solver solver = hanging(describe(make_sheet(sheet_options())));
  try {
    solver.cut(cloth, triangle);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Cut, RefusesWhatIsNoTriangle) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(refusal_of({Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{2, 0, 0}}), testing::HasSubstr("no area"));
  EXPECT_THAT(refusal_of({Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{0, 0, 0}}), testing::HasSubstr("no area"));
  EXPECT_THAT(refusal_of({Vec3{nan, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}), testing::HasSubstr("corner"));
  EXPECT_THAT(refusal_of(level_cut(0), 3), testing::HasSubstr("there is no cloth 3"));
}

}  // namespace
}  // namespace geocloth
