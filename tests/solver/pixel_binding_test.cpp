// SPDX-License-Identifier: GPL-3.0-or-later
// A garment stands where its mesh is put, and goes from one of its assets to another: in a wrong place it would begin
// torn, and a change of resolution while it moves would be seen as a jump.
#include "geocloth/solver/pixel_binding.h"

#include <cmath>
#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/parametrize/convert.h"
#include "geocloth/solver/scene.h"
#include "solver_fixture.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

ClothAsset converted(const std::filesystem::path& file, uint32_t resolution, Layout layout = Layout::panels) {
  ConvertOptions options;
  options.flatten.resolution = resolution;
  options.flatten.layout = layout;
  return convert(file, options).asset;
}

ClothAsset shirt(uint32_t resolution, Layout layout = Layout::panels) {
  return converted(std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "meshes/garments/t_shirt.obj", resolution, layout);
}

double farthest(const ClothAsset& asset, const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double most = 0;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) most = std::max(most, double{length(a[p] - b[p])});
  return most;
}

void expect_copies_agree(const ClothAsset& asset, const std::vector<Vec3>& position) {
  for (uint32_t r = 0; r < asset.splits.rows(); ++r)
    for (uint32_t k = asset.splits.offset[r]; k < asset.splits.offset[r + 1]; ++k)
      EXPECT_EQ(position[asset.splits.pixel[k]], position[asset.splits.pixel[asset.splits.offset[r]]]);
}

// Turned, moved and enlarged as a whole, every pixel goes along to the last digits; at rest it is where it was.
TEST(PixelBinding, GoesAlongWithAMeshThatMovesAsAWhole) {
  for (const Layout layout : {Layout::panels, Layout::square}) {
    const ClothAsset asset = shirt(40, layout);
    const Transform moves{{3, -1, 2}, quat_from_euler_deg({20, 130, -70}), 2};
    std::vector<Vec3> vertices = asset.source.position, wanted = asset.rest_position, out;
    for (std::vector<Vec3>* all : {&vertices, &wanted})
      for (Vec3& p : *all) p = apply(moves, p);
    PixelBinding(asset).evaluate(vertices, out, moves.scale);
    EXPECT_LT(farthest(asset, out, wanted), 3e-6) << to_string(layout);
    expect_copies_agree(asset, out);
    PixelBinding(asset).evaluate(asset.source.position, out);
    EXPECT_LT(farthest(asset, out, asset.rest_position), 1e-6) << to_string(layout);
  }
}

// Rolled up, a sheet is where the roll is, but for what its triangles are flat.
TEST(PixelBinding, FollowsAMeshThatIsBent) {
  constexpr float kRadius = 0.5F;
  const auto rolled = [&](const Vec3& p) {
    return Vec3{kRadius * std::sin(p.x / kRadius), p.y, kRadius * (1 - std::cos(p.x / kRadius))};
  };
  const ClothAsset asset = test::make_sheet({.nx = 41, .ny = 11, .charts_x = 2});
  std::vector<Vec3> vertices = asset.source.position, wanted = asset.rest_position, out;
  for (std::vector<Vec3>* all : {&vertices, &wanted})
    for (Vec3& p : *all) p = rolled(p);
  PixelBinding(asset).evaluate(vertices, out);
  const double sagitta = 0.025 * 0.025 / (8 * double{kRadius});
  EXPECT_LT(farthest(asset, out, wanted), 1.01 * sagitta);
}

// Two layers so near that the grid of one lies on the other in places: the lining stays below when the shell is lifted.
TEST(PixelBinding, KeepsLayersApart) {
  std::string text;
  const auto place = [&](int i, int j) { return 0.05 * i + 0.03 * std::sin(0.7 * j); };
  for (int layer = 0; layer < 2; ++layer)
    for (int j = 0; j < 21; ++j)
      for (int i = 0; i < 21; ++i)
        text += "v " + std::to_string(place(i, j)) + " " + std::to_string(0.05 * j) + " " +
                std::to_string(0.02 * std::sin(0.9 * i) * std::cos(0.8 * j) + 1e-4 * layer) + "\n";
  for (int layer = 0; layer < 2; ++layer)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i) {
        const int a = 441 * layer + 21 * j + i + 1;
        text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(a + 22) + " " +
                std::to_string(a + 21) + "\n";
      }
  test::TemporaryFolder folder;
  folder.write("layers.obj", text);
  ConvertOptions options;
  options.flatten.resolution = 24;
  options.flatten.layout = Layout::panels;
  const ClothAsset asset = convert(folder / "layers.obj", options).asset;
  const std::vector<uint32_t> part = connected_parts(asset);
  std::vector<Vec3> vertices = asset.source.position, out;
  for (size_t v = 0; v < vertices.size(); ++v)
    if (asset.source.source_vertex[v] >= 441) vertices[v].z += 1;
  PixelBinding(asset).evaluate(vertices, out);
  std::set<uint32_t> above, below;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) (out[p].z > 0.5F ? above : below).insert(part[p]);
  EXPECT_EQ(above.size(), 1U);
  EXPECT_EQ(below.size(), 1U);
  EXPECT_NE(above, below);
}

// A shirt that swings is given to a coarser and to a finer asset of it, and goes on: as one, as fast, and to the same
// rest.
TEST(PixelBinding, TakesAGarmentToAnotherResolution) {
  const ClothAsset fine = shirt(64), coarse = shirt(32);
  const auto take = [](const ClothAsset& from, const ClothAsset& to) {
    SolverSettings settings = test::cpu_settings();
    const auto begin = [&](const ClothAsset& asset) {
      Solver solver(std::vector{test::describe(asset)}, settings);
      std::vector<Pin> pins;
      for (const uint32_t p : select_pixels(asset, {}, WhereTop{0.02F})) pins.push_back({p, asset.rest_position[p]});
      solver.set_pins(0, pins);
      return solver;
    };
    Solver before = begin(from), after = begin(to);
    before.set_wind({.velocity = {1, 0, 3}});
    after.set_wind({.velocity = {1, 0, 3}});
    test::run(before, 30);
    const PixelBinding binding(to, from);
    std::vector<Vec3> position, velocity;
    binding.evaluate(test::positions_of(before), position);
    binding.evaluate_rates(test::velocities_of(before), velocity);
    expect_copies_agree(to, position);
    const StretchStatistics stretch = measure_stretch(to, 1, position);
    EXPECT_GT(stretch.mean, 0.93);  // folds that the coarser grid does not have are drawn straight
    EXPECT_LT(stretch.p99, 1.05);
    after.write_state(0, position, velocity);
    const auto middle = [](const ClothAsset& asset, const std::vector<Vec3>& of) {
      const std::vector<double> mass = test::masses_of(test::describe(asset));
      Vec3 sum;
      double all = 0;
      for (size_t p = 0; p < of.size(); ++p) {
        sum += static_cast<float>(mass[p]) * of[p];
        all += mass[p];
      }
      return static_cast<float>(1 / all) * sum;
    };
    const Vec3 speed = middle(from, test::velocities_of(before));
    EXPECT_LT(length(middle(to, position) - middle(from, test::positions_of(before))), 3e-3F);
    EXPECT_LT(length(middle(to, velocity) - speed), 0.05F * length(speed) + 1e-3F);
    for (const int frames : {1, 10, 200}) {
      test::run(before, static_cast<uint32_t>(frames));
      test::run(after, static_cast<uint32_t>(frames));
      EXPECT_LT(length(middle(to, test::positions_of(after)) - middle(from, test::positions_of(before))), 0.015F)
          << frames;
    }
  };
  take(fine, coarse);
  take(coarse, fine);
}

TEST(PixelBinding, RefusesOtherMeshesAndOtherCounts) {
  const ClothAsset asset = shirt(32), other = test::make_sheet({});
  EXPECT_THROW(PixelBinding(asset, other), Error);
  Solver solver(std::vector{test::describe(other)}, test::cpu_settings());
  ASSERT_GT(solver.cut(0, {Vec3{0.013F, -9, -9}, Vec3{0.013F, 9, -9}, Vec3{0.013F, 0, 9}}).cells, 0U);
  try {  // it was said to be of another mesh
    const PixelBinding binding(other, *solver.asset(0));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("has been cut"), std::string::npos) << error.what();
  }
  std::vector<Vec3> out;
  EXPECT_THROW(PixelBinding(asset).evaluate(std::vector<Vec3>(3), out), Error);
  EXPECT_THROW(PixelBinding(asset, asset).evaluate(asset.source.position, out), Error);
  EXPECT_THROW(PixelBinding(asset, asset).evaluate_rates(asset.source.position, out), Error);
  PixelBinding(asset, asset).evaluate(asset.rest_position, out);
  EXPECT_LT(farthest(asset, out, asset.rest_position), 1e-6);
}

}  // namespace
}  // namespace geocloth
