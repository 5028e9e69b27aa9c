// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth that begins as a file has it, as `simulate` plays it: as it was posed in a modelling program, or where an
// earlier simulation has left it.

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "export/cache_reader.h"
#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/grid_mesh.h"
#include "support/make_sheet.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

using testing::HasSubstr;

class Starts : public testing::Test {
 protected:
  Starts() { write_asset(make_sheet({.nx = 9, .ny = 9, .charts_x = 2}), folder_ / "sheet.glb"); }

  ProgramResult simulate(const std::string& cloth, int frames, const std::string& name) {
    const std::string scene =
        folder_.write(name + ".json", fmt::format(R"({{"version":1,"frames":{},"substeps":4,"cloths":[{{
      "asset":"sheet.glb","pins":[{{"where":{{"vertices":[0,1,2,3,4,5,6,7,8]}}}}]{}}}]}})",
                                                  frames, cloth));
    return run_program({"simulate", scene, "--backend", "cpu", "--last-state", folder_ / (name + ".obj"), "-o",
                        folder_ / (name + ".mdd"), "-o", folder_ / (name + ".pc2"), "--report",
                        folder_ / (name + "_report.json"), "--quiet"});
  }
  [[nodiscard]] std::string state(const std::string& name) const { return read_text(folder_ / (name + ".obj")); }
  [[nodiscard]] double kinetic(const std::string& name) const {
    return nlohmann::json::parse(read_text(folder_ / (name + "_report.json")))["energy"].back()["kinetic"];
  }

  TemporaryFolder folder_;
};

// The grid of --last-state has every bit; a point cache has the vertices, which here are the grid's points.
TEST_F(Starts, WhereAnEarlierSimulationHasLeftIt) {
  const std::string swings = R"(,"transform":{"rotate_deg":[90,0,0]})";
  ASSERT_EQ(simulate(swings, 20, "first").status, 0);
  for (const char* file : {"first.obj", "first.pc2", "first.mdd"}) {
    const ProgramResult again = simulate(fmt::format(R"(,"start":"{}")", file), 0, "again");
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(state("again"), state("first")) << file;
  }
  ASSERT_EQ(simulate(R"(,"start":{"file":"first.pc2","frame":0})", 0, "begins").status, 0);
  ASSERT_EQ(simulate(swings, 0, "begun").status, 0);
  EXPECT_EQ(state("begins"), state("begun"));
}

// A garment has other vertices than its grid; the grid's own begin with the same bits again.
TEST_F(Starts, WhereTheGridOfAGarmentWas) {
  const std::filesystem::path shirt = std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "meshes/garments/t_shirt.obj";
  ASSERT_EQ(run_program({"convert", shirt, "-o", folder_ / "sheet.glb", "--resolution", "24", "--quiet"}).status, 0);
  ASSERT_EQ(simulate("", 10, "first").status, 0);
  const ProgramResult again = simulate(R"(,"start":"first.obj")", 0, "again");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(state("again"), state("first"));
}

// A grid that has as many points as the mesh has vertices has them in another order.
TEST_F(Starts, WhereTheGridOfAGridWas) {
  {
    std::ofstream obj(folder_ / "grid.obj");
    constexpr int kSide = 13;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) obj << fmt::format("v {} {} 0\n", 0.05 * x, 0.05 * y);
    for (int y = 0; y + 1 < kSide; ++y)
      for (int x = 0; x + 1 < kSide; ++x) {
        const int v = y * kSide + x + 1;
        obj << fmt::format("f {} {} {} {}\n", v, v + 1, v + 1 + kSide, v + kSide);
      }
  }
  ASSERT_EQ(run_program({"convert", folder_ / "grid.obj", "-o", folder_ / "sheet.glb", "--spacing", "0.05", "--quiet"})
                .status,
            0);
  const ClothAsset asset = read_asset(folder_ / "sheet.glb");
  ASSERT_EQ(asset.source.file_vertex_count(), welded_grid_mesh(asset, asset.rest_position).pixel.size());
  ASSERT_EQ(simulate("", 10, "first").status, 0);
  const ProgramResult again = simulate(R"(,"start":"first.obj")", 0, "again");
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(state("again"), state("first"));
  const ProgramResult posed = simulate(R"(,"start":"grid.obj")", 0, "posed");
  ASSERT_EQ(posed.status, 0) << posed.err;
  const ProgramResult rest = simulate("", 0, "rest");
  ASSERT_EQ(rest.status, 0) << rest.err;
  const std::vector<Vec3> was = read_point_cache(folder_ / "rest.pc2").frames.back(),
                          is = read_point_cache(folder_ / "posed.pc2").frames.back();
  ASSERT_EQ(was.size(), is.size());
  for (std::size_t i = 0; i < was.size(); ++i) EXPECT_LT(length(was[i] - is[i]), 1e-6F) << i;
}

// A mesh is posed, and its cache laid on it, by programs that know nothing of the triangles that were divided.
TEST_F(Starts, WhereTheFileOfADividedMeshHasItsVertices) {
  const std::filesystem::path shirt = std::filesystem::path(GEOCLOTH_SOURCE_DIR) / "meshes/garments/t_shirt.obj";
  ASSERT_EQ(
      run_program({"convert", shirt, "-o", folder_ / "sheet.glb", "--resolution", "24", "--refine", "0.5", "--quiet"})
          .status,
      0);
  const ClothAsset asset = read_asset(folder_ / "sheet.glb");
  ASSERT_GT(asset.source.middle.size(), 100U);
  ASSERT_EQ(simulate("", 10, "first").status, 0);
  EXPECT_EQ(read_point_cache(folder_ / "first.pc2").points, asset.source.file_vertex_count());
  const ProgramResult again = simulate(R"(,"start":"first.pc2")", 0, "again");
  ASSERT_EQ(again.status, 0) << again.err;
  const std::vector<Vec3> was = read_point_cache(folder_ / "first.pc2").frames.back(),
                          is = read_point_cache(folder_ / "again.pc2").frames.back();
  ASSERT_EQ(was.size(), is.size());
  for (std::size_t i = 0; i < was.size(); ++i) EXPECT_LT(length(was[i] - is[i]), asset.spacing) << i;
  const ProgramResult posed = simulate(fmt::format(R"(,"start":"{}")", shirt.string()), 0, "posed");
  EXPECT_EQ(posed.status, 0) << posed.err;
  EXPECT_EQ(run_program({"render", folder_ / "first.pc2", "--asset", folder_ / "sheet.glb", "--size", "32x32", "-o",
                         folder_ / "a.png", "-q"})
                .status,
            0);
}

// Cloth goes on falling from where it is taken over, or begins there at rest.
TEST_F(Starts, AsFastAsItWas) {
  ASSERT_EQ(simulate(R"(,"transform":{"rotate_deg":[90,0,0]})", 12, "first").status, 0);
  ASSERT_EQ(simulate(R"(,"start":{"file":"first.mdd","moving":true})", 1, "moving").status, 0);
  ASSERT_EQ(simulate(R"(,"start":"first.mdd")", 1, "still").status, 0);
  ASSERT_EQ(simulate(R"(,"transform":{"rotate_deg":[90,0,0]})", 13, "whole").status, 0);
  EXPECT_NEAR(kinetic("moving"), kinetic("whole"), 0.1 * kinetic("whole"));
  EXPECT_LT(kinetic("still"), 0.1 * kinetic("whole"));
}

// As exported from a modelling program in centimetres: pins hold it where it is there.
TEST_F(Starts, AsAMeshFileHasIt) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9, .charts_x = 2});
  std::string text;
  for (const Vec3& p : asset.source.position) text += fmt::format("v {} {} {}\n", 100 * p.x, 300 + 100 * p.y, 50 * p.z);
  for (const Triangle& t : asset.source.triangle) text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  folder_.write("modelled.obj", text);
  const ProgramResult played = simulate(R"(,"start":{"file":"modelled.obj","transform":{"scale":0.01}})", 5, "posed");
  ASSERT_EQ(played.status, 0) << played.err;
  EXPECT_THAT(state("posed"), HasSubstr("v 0.5 3.5 "));
  const ProgramResult huge = simulate(R"(,"start":"modelled.obj")", 5, "huge");
  EXPECT_EQ(huge.status, 1);
  EXPECT_THAT(huge.err, HasSubstr("modelled.obj: is 141.421 m across there, and the cloth 1.41421 m at rest"));
  EXPECT_THAT(huge.err, HasSubstr(R"("transform": { "scale": 0.01 })"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "huge.obj"));
}

TEST_F(Starts, WhatIsOfNoUseIsNamed) {
  ASSERT_EQ(simulate("", 2, "first").status, 0);
  folder_.write("other.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto refused = [&](const std::string& start) {
    const ProgramResult result = simulate(R"(,"start":)" + start, 1, "refused");
    EXPECT_EQ(result.status, 1) << start;
    EXPECT_THAT(result.err, HasSubstr("cloths[0].start")) << start;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "refused.obj"));
    return result.err;
  };
  EXPECT_THAT(refused(R"("other.obj")"), HasSubstr("has 3 vertices, and the mesh that the asset was converted from has "
                                                   "81 (its grid 81); it must be the same mesh"));
  EXPECT_THAT(refused(R"({"file":"first.pc2","frame":9})"), HasSubstr("has 3 frames, and no frame 9"));
  EXPECT_THAT(refused(R"({"file":"first.pc2","frame":0,"moving":true})"), HasSubstr("has no frame before"));
  EXPECT_THAT(refused(R"({"file":"first.obj","moving":true})"), HasSubstr("has no frame before"));
  EXPECT_THAT(refused(R"({"file":"first.obj","frame":1})"), HasSubstr("is a mesh; frames are for point caches"));
  std::string jumps = read_text(folder_ / "first.pc2");
  constexpr size_t kHeader = 32, kPoints = 81;
  const float far = 9e5F;
  for (size_t p = 0; p < kPoints; ++p)
    jumps.replace(kHeader + 12 * (kPoints + p), 4, reinterpret_cast<const char*>(&far), 4);
  folder_.write("jumps.pc2", jumps);
  EXPECT_THAT(refused(R"({"file":"jumps.pc2","moving":true})"),
              HasSubstr("jumps.pc2: the speed from the frame before"));
  EXPECT_THAT(refused(R"("missing.pc2")"), HasSubstr("missing.pc2"));
  EXPECT_THAT(refused(R"("missing.obj")"), HasSubstr("missing.obj"));
  EXPECT_THAT(refused(R"({"frame":1})"), HasSubstr("the key \"file\" is missing"));
  EXPECT_THAT(refused(R"({"file":"first.pc2","frames":1})"), HasSubstr("unknown key \"frames\""));
  EXPECT_THAT(refused(R"("")"), HasSubstr("must name a mesh file or a point cache"));
  EXPECT_THAT(refused(R"({"file":"first.obj","transform":{"scale":1e6}})"), HasSubstr("first.obj"));
}

}  // namespace
}  // namespace geocloth::test
