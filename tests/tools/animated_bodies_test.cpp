// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes with bodies that an animation of their file moves, as `simulate` plays them.

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/asset_file.h"
#include "sliding_tetrahedron.h"
#include "support/make_sheet.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class AnimatedBodies : public testing::Test {
 protected:
  AnimatedBodies() {
    write_asset(make_sheet({.nx = 5, .ny = 5}), folder_ / "sheet.glb");
    folder_.write("body.gltf", kSlidingTetrahedron);
    folder_.write("still.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  }

  ProgramResult simulate(const std::string& cloth, const std::string& colliders) {
    const std::string scene = folder_.write(
        "scene.json", fmt::format(R"({{"version":1,"frames":60,"substeps":2,"cloths":[{{"asset":"sheet.glb",
      "pins":[{{"where":{{"top":0}},"follow":"{}"}}]{}}}],"colliders":[{}]}})",
                                  cloth.empty() ? "body" : "skin", cloth, colliders));
    return run_program({"simulate", scene, "--backend", "cpu", "--last-state", folder_ / "last.obj", "--quiet"});
  }

  /// A point cache in which the corners of still.obj slide to z = 0.5 m.
  /// @param size  of them
  void write_slide(const std::string& name, uint32_t frames, float step = 1, float size = 1) {
    const auto append = [](std::string& bytes, auto word) {
      const auto raw = std::bit_cast<std::array<char, sizeof word>>(word);
      bytes.append(raw.begin(), raw.end());
    };
    std::string bytes("POINTCACHE2\0", 12);
    append(bytes, uint32_t{1});
    append(bytes, uint32_t{4});
    append(bytes, 0.0F);
    append(bytes, step);
    append(bytes, frames);
    for (uint32_t frame = 0; frame < frames; ++frame) {
      const float z = 0.5F * static_cast<float>(frame) / static_cast<float>(frames - 1);
      for (const Vec3& p : {Vec3{0, 0, z}, Vec3{1, 0, z}, Vec3{0, 1, z}, Vec3{0, 0, 1 + z}})
        for (const float c : {p.x, p.y, p.z}) append(bytes, size * c);
    }
    folder_.write(name, bytes);
  }

  /// z of a point that is pinned, at the end [m].
  [[nodiscard]] float top_z() const {
    std::istringstream lines(read_text(folder_ / "last.obj"));
    std::string line;
    float x = 0, y = 0, z = 0;
    while (std::getline(lines, line)) {
      if (std::sscanf(line.c_str(), "v %f %f %f", &x, &y, &z) == 3 && std::abs(y - 0.5F) < 1e-6F) return z;
    }
    ADD_FAILURE() << "no point is where the pins are";
    return 0;
  }

  /// The body, below the cloth.
  [[nodiscard]] static std::string body(const std::string& file, const std::string& keys) {
    return fmt::format(
        R"({{"name":"body","shape":"mesh","file":"{}","spacing":0.1,"transform":{{"translate":[0,-9,0]}},{}}})", file,
        keys);
  }

  TemporaryFolder folder_;
};

TEST_F(AnimatedBodies, CarryWhatIsPinnedToThem) {
  const ProgramResult played = simulate("", body("body.gltf", R"("animation":"slide")"));
  EXPECT_EQ(played.status, 0) << played.err;
  EXPECT_NEAR(top_z(), 0.5, 1e-5);
  // Twice as fast, from the half on, and at its end in time.
  EXPECT_EQ(simulate("", body("body.gltf", R"("animation":{"clip":0,"start":0.5,"speed":0.5})")).status, 0);
  EXPECT_NEAR(top_z(), 0.125, 1e-5);
  EXPECT_EQ(simulate("", body("body.gltf", R"("parts":"tetrahedron","animation":{"speed":4})")).status, 0);
  EXPECT_NEAR(top_z(), 0.5, 1e-5);
  EXPECT_EQ(simulate("", body("body.gltf", R"("animation":{"speed":1.5,"loop":true})")).status, 0);
  EXPECT_NEAR(top_z(), 0.25, 1e-5);
}

TEST_F(AnimatedBodies, CarryTheClothWhoseSkinTheyAre) {
  const ProgramResult played = simulate(R"(,"skin":{"file":"body.gltf","animation":"slide"})", "");
  EXPECT_EQ(played.status, 0) << played.err;
  EXPECT_NEAR(top_z(), 0.5, 1e-5);
}

// The file opens three metres behind where the animation begins: its garment was dragged there in a frame.
TEST_F(AnimatedBodies, HaveClothBeginWhereTheSkinDoes) {
  std::string opens_behind = kSlidingTetrahedron;
  const std::string node = R"("nodes":[{"mesh":0)";
  opens_behind.replace(opens_behind.find(node), node.size(), node + R"(,"translation":[0,0,-3])");
  folder_.write("body.gltf", opens_behind);
  const auto with = [](const char* animation) {
    return fmt::format(R"(,"skin":{{"file":"body.gltf",{}}})", animation);
  };
  EXPECT_EQ(simulate(with(R"("animation":"slide")"), "").status, 0);
  EXPECT_NEAR(top_z(), 3.5, 1e-5);
  const ProgramResult first = run_program({"simulate", folder_ / "scene.json", "--backend", "cpu", "--frames", "0",
                                           "--last-state", folder_ / "last.obj", "--quiet"});
  EXPECT_EQ(first.status, 0) << first.err;
  std::istringstream lines(read_text(folder_ / "last.obj"));
  std::string line;
  int points = 0;
  while (std::getline(lines, line)) {
    float x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "v %f %f %f", &x, &y, &z) != 3) continue;
    EXPECT_NEAR(z, 3, 1e-5) << line;
    ++points;
  }
  EXPECT_EQ(points, 25);
  // With time to get there it begins where the file has it.
  EXPECT_EQ(simulate(with(R"("animation":{"clip":"slide","start":0.5})"), "").status, 0);
  EXPECT_NEAR(top_z(), 3.25, 1e-5);
}

// What a program computes for each vertex, muscles or cloth say, leaves it as a point cache.
TEST_F(AnimatedBodies, PlayPointCachesOfTheirVertices) {
  const auto z_with = [&](const std::string& animation) {
    const ProgramResult played = simulate("", body("still.obj", "\"animation\":" + animation));
    EXPECT_EQ(played.status, 0) << played.err;
    return top_z();
  };
  write_slide("slide.pc2", 61);
  EXPECT_NEAR(z_with(R"("slide.pc2")"), 0.5, 1e-5) << "its frames are the scene's";
  EXPECT_NEAR(z_with(R"({"file":"slide.pc2","rate":30})"), 0.25, 1e-5);
  EXPECT_NEAR(z_with(R"({"file":"slide.pc2","start":0.5,"speed":0.5})"), 0.125, 1e-5);
  EXPECT_NEAR(z_with(R"({"file":"slide.pc2","speed":4})"), 0.5, 1e-5) << "it holds its last frame";
  EXPECT_NEAR(z_with(R"({"file":"slide.pc2","speed":1.5,"loop":true})"), 0.25, 1e-5);
  write_slide("some.PC2", 3, 60);  // every 60th frame
  EXPECT_NEAR(z_with(R"("some.PC2")"), 0.25, 1e-5);
  EXPECT_NEAR(z_with(R"({"file":"some.PC2","speed":0.5})"), 0.125, 1e-5) << "evenly between frames";
  write_slide("inches.pc2", 61, 1, 1 / 0.0254F);
  EXPECT_NEAR(z_with(R"({"file":"inches.pc2","transform":{"scale":0.0254}})"), 0.5, 1e-5);
  const ProgramResult skin = simulate(R"(,"skin":{"file":"still.obj","animation":"slide.pc2"})", "");
  EXPECT_EQ(skin.status, 0) << skin.err;
  EXPECT_NEAR(top_z(), 0.5, 1e-5);
}

// What simulate wrote of one cloth moves the next one.
TEST_F(AnimatedBodies, PlayWhatSimulateWrote) {
  ASSERT_EQ(run_program({"inspect", folder_ / "sheet.glb", "--mesh", folder_ / "sheet.obj"}).status, 0);
  for (const char* cache : {"slides.pc2", "slides.mdd"}) {
    ASSERT_EQ(simulate("", body("body.gltf", R"("animation":"slide")")).status, 0);
    ASSERT_EQ(run_program({"simulate", folder_ / "scene.json", "--backend", "cpu", "-o", folder_ / cache, "-q"}).status,
              0);
    const ProgramResult again = simulate(fmt::format(R"(,"skin":{{"file":"sheet.obj","animation":"{}"}})", cache), "");
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_NEAR(top_z(), 0.5, 1e-5) << cache;
  }
}

TEST_F(AnimatedBodies, PointCachesOfOtherMeshesAreRefused) {
  write_slide("slide.pc2", 61);
  folder_.write("more.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 2 2 2\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const ProgramResult result = simulate("", body("more.obj", R"("animation":"slide.pc2")"));
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("colliders[0]"), HasSubstr("slide.pc2: has 4 points, but "),
                                HasSubstr("more.obj has 5 vertices")));
  folder_.write("cut.pc2", read_text(folder_ / "slide.pc2").substr(0, 500));
  EXPECT_THAT(simulate("", body("still.obj", R"("animation":"cut.pc2")")).err, HasSubstr("cut.pc2: does not hold"));
  // It would be lost.
  EXPECT_THAT(run_program({"simulate", folder_ / "scene.json", "-o", folder_ / "cut.pc2"}).err,
              AllOf(HasSubstr("cut.pc2"), HasSubstr("a collider of the scene")));
}

TEST_F(AnimatedBodies, ThatAreNotThereAreNamed) {
  const auto said = [&](const std::string& file, const std::string& keys) {
    const ProgramResult result = simulate("", body(file, keys));
    EXPECT_EQ(result.status, 1);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "last.obj"));
    EXPECT_EQ(run_program({"simulate", folder_ / "scene.json", "--check"}).status, 1);
    return result.err;
  };
  EXPECT_THAT(said("body.gltf", R"("animation":"walk")"),
              AllOf(HasSubstr("scene.json: colliders[0]: "), HasSubstr("body.gltf"), HasSubstr("slide")));
  EXPECT_THAT(said("body.gltf", R"("animation":1)"), HasSubstr("slide"));
  EXPECT_THAT(said("body.gltf", R"("animation":0,"parts":"cape")"), HasSubstr("no part is called cape"));
  EXPECT_THAT(said("body.gltf", R"("parts":"cape")"), HasSubstr("no part is called cape"));
  EXPECT_THAT(said("still.obj", R"("animation":0)"), AllOf(HasSubstr("still.obj"), HasSubstr("glTF")));
  EXPECT_THAT(said("none.gltf", R"("animation":0)"), HasSubstr("none.gltf"));
}

}  // namespace
}  // namespace geocloth::test
