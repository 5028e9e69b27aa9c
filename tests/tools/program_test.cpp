// SPDX-License-Identifier: GPL-3.0-or-later
// The program as its users drive it: files in, files out, one clear line and no file when something is wrong.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <ostream>
#include <sstream>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const std::string kMeshes = GEOCLOTH_SOURCE_DIR "/meshes/";

constexpr const char* kTriangles = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

void expect_one_line(const ProgramResult& result, const std::string& about) {
  EXPECT_EQ(result.status, 1) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.err, StartsWith("geocloth "));
  EXPECT_THAT(result.err, HasSubstr(about));
}

/// An asset that several tests read; made once.
const std::string& sleeve_asset() {
  static const TemporaryFolder folder;
  static const std::string path = [] {
    const std::string asset = folder / "sleeve.glb";
    const ProgramResult result =
        run_program({"convert", kMeshes + "garments/sleeve.obj", "-o", asset, "--resolution", "24", "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    return asset;
  }();
  return path;
}

// ------------------------------------------------------------------------------------------- standard streams

// Who closes standard error had the progress written into the first file that was opened.
TEST(Streams, WhatIsClosedIsNoPlaceForFiles) {
  const TemporaryFolder folder;
  const std::string cache = folder / "a.pc2", closed = folder / "b.pc2", asset = sleeve_asset();
  EXPECT_EQ(run_in_shell("simulate " + asset + " --frames 3 -o " + cache + " 2> /dev/null"), 0);
  EXPECT_EQ(run_in_shell("simulate " + asset + " --frames 3 -o " + closed + " <&- >&- 2>&-"), 0);
  EXPECT_EQ(read_text(cache), read_text(closed));
}

TEST(Streams, WhatCannotBeSaidStopsNothingAndWhatCannotBePrintedFails) {
  const TemporaryFolder folder;
  const std::string asset = sleeve_asset(), cache = folder / "a.pc2";
  EXPECT_EQ(run_in_shell("simulate " + asset + " --frames 3 -o " + cache + " 2> /dev/full > /dev/null"), 0);
  EXPECT_EQ(run_in_shell("inspect nothing.glb 2> /dev/full"), 1);
  EXPECT_EQ(run_in_shell("inspect " + asset + " --json > /dev/full 2> /dev/null"), 1);
}

// ------------------------------------------------------------------------------------------------- convert

class BadMesh : public testing::TestWithParam<std::pair<const char*, std::string>> {};

TEST_P(BadMesh, IsOneLineAndNoFile) {
  const TemporaryFolder folder;
  const auto& [name, content] = GetParam();
  const std::string mesh = folder.write(name, content);
  const ProgramResult result = run_program({"convert", mesh, "-o", folder / "out.glb", "--report", folder / "out.json",
                                            "--pictures", folder / "pictures", "--quiet"});
  expect_one_line(result, name);
  EXPECT_THAT(folder.entries(), ElementsAre(name));
}

TEST(Convert, WritesReportsForPeopleAndForPrograms) {
  const TemporaryFolder folder;
  // Without a device there are no pictures of the garment itself, and a sanitizer has no driver to look into.
  setenv("VK_DRIVER_FILES", "/nowhere", 1);
  setenv("VK_ICD_FILENAMES", "/nowhere", 1);
  const ProgramResult result =
      run_program({"convert", kMeshes + "garments/sleeve.obj", "-o", folder / "sleeve.glb", "--resolution", "24",
                   "--report", folder / "out.html", "--report", folder / "out.json", "--quiet"});
  unsetenv("VK_DRIVER_FILES");
  unsetenv("VK_ICD_FILENAMES");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(folder.entries(), ElementsAre("out.html", "out.json", "sleeve.glb"));
  EXPECT_TRUE(json::parse(read_text(folder / "out.json")).contains("quality"));
  const std::string page = read_text(folder / "out.html");
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(page, HasSubstr("<h1>sleeve</h1>"));
  EXPECT_THAT(page, HasSubstr("There is no picture of the garment itself"));
}

std::string head_of(const std::string& path, double share) {
  const std::string text = read_text(path);
  return text.substr(0, static_cast<std::size_t>(share * static_cast<double>(text.size())));
}

INSTANTIATE_TEST_SUITE_P(
    Convert, BadMesh,
    testing::Values(std::pair{"empty.obj", std::string()}, std::pair{"empty.glb", std::string()},
                    std::pair{"empty.stl", std::string()}, std::pair{"empty.ply", std::string()},
                    std::pair{"prose.obj", std::string("It was a dark and stormy night.\nv is a letter.\n")},
                    std::pair{"prose.glb", std::string("It was a dark and stormy night.\n")},
                    std::pair{"prose.fbx", std::string("It was a dark and stormy night.\n")},
                    std::pair{"prose.dae", std::string("It was a dark and stormy night.\n")},
                    std::pair{"prose.gltf", std::string("{\"asset\": 12}")},
                    std::pair{"unknown.xyz", std::string(kTriangles)},
                    std::pair{"points.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\n")},
                    std::pair{"nan.obj", std::string("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n")},
                    std::pair{"inf.obj", std::string("v 0 0 0\nv inf 0 0\nv 0 1 0\nf 1 2 3\n")},
                    std::pair{"huge.obj", std::string("v 0 0 0\nv 1e300 0 0\nv 0 1e300 0\nf 1 2 3\n")},
                    std::pair{"range.obj", std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n")},
                    std::pair{"flat.obj", std::string("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")},
                    std::pair{"many.ply", std::string("ply\nformat ascii 1.0\nelement vertex 4000000000\n"
                                                      "property float x\nproperty float y\nproperty float z\n"
                                                      "element face 4000000000\n"
                                                      "property list uchar int vertex_indices\nend_header\n")}),
    [](const auto& mesh) {
      std::string name = mesh.param.first;
      std::replace(name.begin(), name.end(), '.', '_');
      return name;
    });

TEST(Convert, MissingFileAndFolderAreNamed) {
  const TemporaryFolder folder;
  expect_one_line(run_program({"convert", folder / "none.obj", "-o", folder / "out.glb", "-q"}), "none.obj");
  std::filesystem::create_directory(folder / "folder.obj");
  expect_one_line(run_program({"convert", folder / "folder.obj", "-o", folder / "out.glb", "-q"}), "folder.obj");
  EXPECT_THAT(folder.entries(), ElementsAre("folder.obj"));
}

TEST(Convert, TruncatedAssetAsMeshIsRefused) {
  const TemporaryFolder folder;
  for (const double share : {0.001, 0.01, 0.3, 0.6, 0.99}) {
    const std::string mesh = folder.write("cut.glb", head_of(sleeve_asset(), share));
    expect_one_line(run_program({"convert", mesh, "-o", folder / "out.glb", "-q"}), "cut.glb");
  }
  EXPECT_THAT(folder.entries(), ElementsAre("cut.glb"));
}

TEST(Convert, OutputFolderThatIsMissingIsKnownBeforeTheWorkStarts) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program({"convert", kMeshes + "garments/t_shirt.obj", "-o", folder / "no/out.glb"});
  expect_one_line(result, "out.glb");
}

TEST(Convert, NothingIsLeftWhenTheReportCannotBeWritten) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "report.json");
  expect_one_line(run_program({"convert", kMeshes + "garments/sleeve.obj", "-o", folder / "out.glb", "--report",
                               folder / "report.json", "-q"}),
                  "report.json");
  EXPECT_THAT(folder.entries(), ElementsAre("report.json"));
}

TEST(Convert, WritesAssetReportAndPictures) {
  const TemporaryFolder folder;
  const ProgramResult result =
      run_program({"convert", kMeshes + "garments/t_shirt.obj", "-o", folder / "shirt.glb", "--resolution", "48",
                   "--report", folder / "report.json", "--pictures", folder / "pictures"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("4 boundary loops"));
  EXPECT_THAT(result.err, HasSubstr("geocloth convert: "));  // progress
  const json report = json::parse(read_text(folder / "report.json"));
  for (const char* key : {"source", "repairs", "cleaned", "carried", "represented", "image", "welded", "quality",
                          "seconds", "peak_memory_bytes"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["welded"]["boundary_loops"], 4);
  EXPECT_EQ(report["welded"]["euler_characteristic"], -2);
  EXPECT_EQ(report["quality"]["flipped"], 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "pictures/geometry_image.png"));
}

// A batch program of 4 GB made each of its conversions report 4 GB.
TEST(Convert, TheReportsMemoryIsNotThatOfTheProgramThatStartedIt) {
  const TemporaryFolder folder;
  constexpr std::size_t kOurs = std::size_t{768} << 20U;
  const std::vector<char> ours(kOurs, 1);
  const ProgramResult result = run_program({"convert", kMeshes + "defects/pocket.obj", "-o", folder / "out.glb",
                                            "--resolution", "32", "--report", folder / "report.json", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_LT(json::parse(read_text(folder / "report.json"))["peak_memory_bytes"].get<std::size_t>(), ours.size());
}

TEST(Convert, QuietSaysNothingOnStandardError) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program(
      {"convert", kMeshes + "garments/sleeve.obj", "-o", folder / "out.glb", "--resolution", "16", "--quiet"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, IsEmpty());
}

TEST(Convert, ManyCarriedPartsAreSummedUp) {
  const TemporaryFolder folder;
  std::string mesh = kTriangles;
  for (int i = 0; i < 30; ++i) {
    for (const char* corner : {"0 2", "0.001 2", "0 2.001"}) mesh += "v " + std::to_string(2 + i) + " " + corner + "\n";
    mesh += "f -3 -2 -1\n";
  }
  const ProgramResult result = run_program(
      {"convert", folder.write("crumbs.obj", mesh), "-o", folder / "out.glb", "--resolution", "16", "--quiet"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("carried: 22 more, smaller ones; all 30 are"));
  EXPECT_LT(std::count(result.out.begin(), result.out.end(), '\n'), 16) << result.out;
}

TEST(Convert, SameInputGivesTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* name : {"a.glb", "b.glb"}) {
    ASSERT_EQ(run_program({"convert", kMeshes + "garments/skirt.obj", "-o", folder / name, "--resolution", "32", "-q"})
                  .status,
              0);
  }
  EXPECT_EQ(read_text(folder / "a.glb"), read_text(folder / "b.glb"));
}

TEST(Convert, DrawsLayersApartOnRequestAndSaysSo) {
  const TemporaryFolder folder;
  constexpr int kSide = 9;
  std::ostringstream obj;
  for (const bool dips : {false, true}) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        const double beside = dips ? 0.43 : 0, height = dips ? 0.05 * (i + 1.07 * j) - 0.13 : 0;
        obj << "v " << 0.1 * i + beside << ' ' << 0.1 * j + beside << ' ' << height << '\n';
      }
    }
  }
  for (int j = 0; j + 1 < 2 * kSide; ++j) {
    for (int i = 1; i < kSide && j + 1 != kSide; ++i) {
      const int a = j * kSide + i;
      obj << "f " << a << ' ' << a + 1 << ' ' << a + kSide + 1 << ' ' << a + kSide << '\n';
    }
  }
  const std::string mesh = folder.write("sheets.obj", obj.str());
  std::vector<std::string> command{"convert", mesh, "-o", folder / "out.glb", "--resolution", "32", "-q"};
  EXPECT_THAT(run_program(command).out, Not(HasSubstr("untangled")));
  command.emplace_back("--untangle");
  const ProgramResult result = run_program(command);
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("pairs of the mesh's triangles cut through each other, now 0; moved by"));
}

TEST(Convert, UnitScalesTheGarment) {
  const TemporaryFolder folder;
  const auto height = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words{
        "convert", kMeshes + "garments/sleeve.obj", "-o", folder / "out.glb", "--resolution", "16", "-q"};
    words.insert(words.end(), options.begin(), options.end());
    EXPECT_EQ(run_program(words).status, 0);
    const json bounds = json::parse(run_program({"inspect", folder / "out.glb", "--json"}).out)["bounds"];
    return bounds["max"][1].get<double>() - bounds["min"][1].get<double>();
  };
  const double metres = height({});
  EXPECT_NEAR(metres, 0.59, 0.02);
  EXPECT_NEAR(height({"--unit", "in"}) / metres, 0.0254, 1e-5);
  EXPECT_NEAR(height({"--unit", "dm"}) / metres, 0.1, 1e-5);  // MakeHuman's
  EXPECT_NEAR(height({"--scale", "2.5"}) / metres, 2.5, 1e-4);
}

// ------------------------------------------------------------------------------------------------- inspect

TEST(Inspect, SaysWhatIsInAnAsset) {
  const json found = json::parse(run_program({"inspect", sleeve_asset(), "--json"}).out);
  EXPECT_EQ(found["image"]["layout"], "panels");
  EXPECT_EQ(found["welded"]["boundary_loops"], 2);
  EXPECT_EQ(found["welded"]["components"], 1);
  EXPECT_EQ(found["source"]["triangles"], 1464);
  EXPECT_THAT(run_program({"inspect", sleeve_asset()}).out, HasSubstr("2 boundary loops"));
}

TEST(Inspect, WritesTheGridMeshWeldedAndApart) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      run_program({"inspect", sleeve_asset(), "--mesh", folder / "mesh.obj", "--charts", folder / "charts.obj"}).status,
      0);
  const std::string mesh = read_text(folder / "mesh.obj"), charts = read_text(folder / "charts.obj");
  EXPECT_THAT(mesh, HasSubstr("\nf "));
  EXPECT_THAT(mesh, Not(HasSubstr("\nvt ")));
  EXPECT_THAT(charts, HasSubstr("\nvt "));
  EXPECT_GT(charts.size(), mesh.size());
}

TEST(Inspect, RefusesWhatIsNoAsset) {
  const TemporaryFolder folder;
  expect_one_line(run_program({"inspect", folder.write("bad.glb", "glTF")}), "bad.glb");
  expect_one_line(run_program({"inspect", folder / "none.glb"}), "none.glb");
  expect_one_line(run_program({"inspect", kMeshes + "garments/sleeve.obj"}), "sleeve.obj");
}

// ------------------------------------------------------------------------------------------------- simulate

/// Stands for the path of the asset, which is not made before a test runs: each of them is a process of its own.
constexpr std::string_view kAssetHere = "@asset@";

std::string with_asset(std::string scene) {
  const size_t at = scene.find(kAssetHere);
  return at == std::string::npos ? scene : scene.replace(at, kAssetHere.size(), sleeve_asset());
}

/// A scene with kAssetHere.
std::string scene_pattern(const std::string& more_of_scene, const std::string& more_of_cloth, int substeps = 4) {
  return R"({"version": 1, "frames": 3, "substeps": )" + std::to_string(substeps) + R"(, "cloths": [{"asset": ")" +
         std::string(kAssetHere) + "\"" + more_of_cloth +
         R"(}], "colliders": [{"name": "ball", "shape": "sphere", "center": [0, 0.7, 0],)" + R"( "radius": 0.2}])" +
         more_of_scene + "}";
}

std::string scene_text(const std::string& more_of_scene = "", const std::string& more_of_cloth = "", int substeps = 4) {
  return with_asset(scene_pattern(more_of_scene, more_of_cloth, substeps));
}

TEST(Simulate, AnAssetWithoutASceneHangsByItsHighestBoundary) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program({"simulate", sleeve_asset(), "-o", folder / "out.glb", "--frames", "5",
                                            "--backend", "cpu", "--report", folder / "report.json", "--quiet"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(folder.entries(), ElementsAre("out.glb", "report.json"));
}

TEST(Simulate, ReportHasEveryKey) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", scene_text());
  ASSERT_EQ(run_program({"simulate", scene, "--backend", "cpu", "--report", folder / "report.json", "-q"}).status, 0);
  const json report = json::parse(read_text(folder / "report.json"));
  for (const char* key : {"backend",
                          "device",
                          "path",
                          "threads",
                          "frames",
                          "substeps",
                          "particles",
                          "springs",
                          "ms_per_frame",
                          "passes_ms",
                          "springs_per_second",
                          "stretch",
                          "copy_gap",
                          "penetration",
                          "drawn_penetration",
                          "intersections",
                          "energy",
                          "non_finite",
                          "state_hash",
                          "warnings"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["backend"], "cpu");
  EXPECT_EQ(report["frames"], 3);
  EXPECT_EQ(report["substeps"], 4);
  EXPECT_EQ(report["energy"].size(), 3U);
  EXPECT_EQ(report["non_finite"], 0);
  EXPECT_LE(report["copy_gap"].get<double>(), 1e-6);
  EXPECT_GT(report["springs_per_second"].get<double>(), 0);
}

TEST(Simulate, ReportsHowHardClothPressesWhereTheSceneAsks) {
  const TemporaryFolder folder;
  const auto report_of = [&](const std::string& more) {
    const std::string scene = folder.write("scene.json", scene_text(more));
    const ProgramResult result = run_program(
        {"simulate", scene, "--backend", "cpu", "--frames", "30", "--report", folder / "report.json", "-q"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(read_text(folder / "report.json"));
  };
  EXPECT_FALSE(report_of("").contains("contact_forces"));
  const json forces = report_of(R"(, "contact_forces": true)").at("contact_forces");
  ASSERT_EQ(forces.size(), 1U);
  EXPECT_EQ(forces[0]["collider"], "ball");
  ASSERT_EQ(forces[0]["force"].size(), 3U);
  EXPECT_GT(forces[0]["largest"].get<double>(), std::abs(forces[0]["force"][1].get<double>()));
  expect_one_line(
      run_program({"simulate", folder.write("bad.json", scene_text(R"(, "contact_forces": 1)")), "--check"}),
      "contact_forces");
}

TEST(Simulate, TheStateDoesNotDependOnThreads) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", scene_text());
  std::vector<std::string> hashes;
  for (const char* threads : {"1", "3"}) {
    ASSERT_EQ(run_program({"simulate", scene, "--backend", "cpu", "--threads", threads, "--report",
                           folder / "report.json", "-q"})
                  .status,
              0);
    hashes.push_back(json::parse(read_text(folder / "report.json"))["state_hash"]);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Simulate, SeveralOutputsAndTheLastState) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", scene_text());
  const ProgramResult result =
      run_program({"simulate", "-o", folder / "a.glb", "-o", folder / "b.obj", "-o", folder / "c.pc2", scene,
                   "--last-state", folder / "last.obj", "--frames", "2", "--backend", "cpu", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(folder.entries(), ElementsAre("a.glb", "b_0001.obj", "b_0002.obj", "c.pc2", "last.obj", "scene.json"));
}

TEST(Convert, StagesNeverReplaceTheMesh) {
  const TemporaryFolder folder;
  const std::string mesh = folder.write("2_clean.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const ProgramResult result = run_program({"convert", mesh, "-o", folder / "a.glb", "--stages", folder.path(), "-q"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.err, HasSubstr("2_clean.obj would replace the mesh"));
  EXPECT_THAT(folder.entries(), ElementsAre("2_clean.obj"));
}

TEST(Simulate, NoFramesAreTheFirstState) {
  const TemporaryFolder folder;
  const std::string scene =
      folder.write("scene.json", R"({"version": 1, "frames": 0, "cloths": [{"asset": ")" + sleeve_asset() + "\"}]}");
  const ProgramResult result = run_program({"simulate", scene, "-o", folder / "a.glb", "-o", folder / "b.obj", "-o",
                                            folder / "c.pc2", "--backend", "cpu", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(folder.entries(), ElementsAre("a.glb", "b_0000.obj", "c.pc2", "scene.json"));
}

TEST(Simulate, NothingIsLeftWhenTheSecondOutputFails) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", scene_text());
  const ProgramResult result = run_program({"simulate", scene, "-o", folder / "a.obj", "-o", folder / "no/b.pc2",
                                            "--report", folder / "report.json", "--backend", "cpu", "-q"});
  expect_one_line(result, "b.pc2");
  EXPECT_THAT(folder.entries(), ElementsAre("scene.json"));
}

TEST(Simulate, AnOutputNeverReplacesTheAssetThatTheSceneNames) {
  const TemporaryFolder folder;
  const std::string garment = folder.write("garment.glb", read_text(sleeve_asset()));
  const std::string scene = folder.write("scene.json", R"({"version": 1, "cloths": [{"asset": "garment.glb"}]})");
  const ProgramResult result = run_program({"simulate", scene, "-o", garment, "--backend", "cpu", "-q"});
  expect_one_line(result, "garment.glb would replace");
  EXPECT_EQ(read_text(garment), read_text(sleeve_asset()));
}

TEST(Simulate, CachesOfSeveralClothsAreNamedByTheFilesThatTheyAre) {
  const TemporaryFolder folder;
  const std::string cloth = R"({"asset": ")" + sleeve_asset() + "\"}";
  const std::string scene =
      folder.write("scene.json", R"({"version": 1, "frames": 0, "cloths": [)" + cloth + ", " + cloth + "]}");
  ProgramResult result = run_program({"simulate", scene, "-o", folder / "out.pc2", "--backend", "cpu", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("out_1.pc2\n"), HasSubstr("out_2.pc2\n"), Not(HasSubstr("out.pc2"))));
  EXPECT_THAT(folder.entries(), ElementsAre("out_1.pc2", "out_2.pc2", "scene.json"));

  result = run_program(
      {"simulate", scene, "-o", folder / "out.pc2", "--report", folder / "out_2.pc2", "--backend", "cpu", "-q"});
  expect_one_line(result, "would replace what --output writes");
}

TEST(Simulate, CheckOnlyReads) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", scene_text());
  const ProgramResult result = run_program({"simulate", scene, "--check"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("1 cloth with "), HasSubstr(" particles, 1 collider, 3 frames at 60 a second")));
  EXPECT_THAT(folder.entries(), ElementsAre("scene.json"));
}

TEST(Simulate, WhatStopsASceneOnItsWayNamesTheSceneAndTheFrame) {
  const TemporaryFolder folder;
  const std::string scene = folder.write(
      "scene.json",
      scene_text("", R"(, "pins": [{"where": {"top": 0.1}, "motion": [{"time": 0, "translate": [0, 0, 0]},)"
                     R"( {"time": 0.03, "translate": [0, 1e6, 0]}]}])"));
  const ProgramResult result = run_program({"simulate", scene, "-o", folder / "out.obj", "-q", "--backend", "cpu"});
  expect_one_line(result, "scene.json: frame 2: ");
  EXPECT_THAT(folder.entries(), ElementsAre("scene.json"));
}

struct BadSceneText {
  const char* name;
  std::string text;   ///< with kAssetHere, if any
  std::string about;  ///< what the message names
};
void PrintTo(const BadSceneText& scene, std::ostream* out) {
  *out << scene.name;
}

class BadScene : public testing::TestWithParam<BadSceneText> {};

TEST_P(BadScene, IsOneLineThatNamesTheElement) {
  const TemporaryFolder folder;
  const auto& [name, text, about] = GetParam();
  const std::string scene = folder.write("scene.json", with_asset(text));
  for (const bool check : {true, false}) {
    const ProgramResult result = check ? run_program({"simulate", scene, "--check"})
                                       : run_program({"simulate", scene, "-o", folder / "out.obj", "-q"});
    expect_one_line(result, "scene.json");
    EXPECT_THAT(result.err, HasSubstr(about));
  }
  EXPECT_THAT(folder.entries(), ElementsAre("scene.json"));
}

INSTANTIATE_TEST_SUITE_P(
    Simulate, BadScene,
    testing::Values(
        BadSceneText{"empty", "", "scene.json"}, BadSceneText{"array", "[]", ""},
        BadSceneText{"cut", "{\"version\": 1", ""},
        BadSceneText{"version", "{\"version\": 2, \"cloths\": []}", "version"},
        BadSceneText{"unknown_key", scene_pattern(", \"gravty\": [0, 0, 0]", ""), "gravity"},
        BadSceneText{"gravity", scene_pattern(", \"gravity\": \"down\"", ""), "gravity"},
        BadSceneText{"substeps", scene_pattern(", \"substeps\": 0", ""), "substeps"},
        BadSceneText{"frame_rate", scene_pattern(", \"frame_rate\": -60", ""), "frame_rate"},
        BadSceneText{"material", scene_pattern("", ", \"material\": \"adamantium\""), "material"},
        BadSceneText{"boundary", scene_pattern("", ", \"pins\": [{\"where\": {\"boundary\": 7}}]"), "boundary 7"},
        BadSceneText{"collider", scene_pattern("", ", \"pins\": [{\"where\": {\"top\": 0.1}, \"follow\": \"bal\"}]"),
                     "ball"},
        BadSceneText{"asset", "{\"version\": 1, \"cloths\": [{\"asset\": \"none.glb\"}]}", "none.glb"}),
    [](const auto& scene) { return scene.param.name; });

TEST(Simulate, TruncatedAssetIsRefused) {
  const TemporaryFolder folder;
  for (const double share : {0.0, 0.01, 0.5, 0.99}) {
    const std::string asset = folder.write("cut.glb", head_of(sleeve_asset(), share));
    expect_one_line(run_program({"simulate", asset, "-o", folder / "out.obj", "--backend", "cpu", "-q"}), "cut.glb");
  }
  EXPECT_THAT(folder.entries(), ElementsAre("cut.glb"));
}

TEST(Simulate, UnknownDeviceIsNamed) {
  const TemporaryFolder folder;
  expect_one_line(run_program({"simulate", sleeve_asset(), "-o", folder / "out.obj", "--backend", "vulkan", "--device",
                               "no such device", "-q"}),
                  "no such device");
  EXPECT_THAT(folder.entries(), IsEmpty());
}

// ------------------------------------------------------------------------------------------------- interrupt

class Interrupt : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Signals, Interrupt, testing::Values(SIGINT, SIGTERM, SIGHUP, SIGPIPE));

TEST_P(Interrupt, SimulateLeavesNoPartialFile) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", scene_text("", "", 256));
  const ProgramResult result =
      run_program({"simulate", scene, "-o", folder / "a.glb", "-o", folder / "b.obj", "-o", folder / "c.pc2",
                   "--report", folder / "report.json", "--frames", "4000", "--backend", "cpu", "-q"},
                  std::chrono::milliseconds(700), GetParam());
  EXPECT_EQ(result.status, 128 + GetParam()) << result.err;
  EXPECT_THAT(folder.entries(), ElementsAre("scene.json"));
}

TEST(InterruptConvert, LeavesNoPartialFile) {
  const TemporaryFolder folder;
  const ProgramResult result = run_program({"convert", kMeshes + "garments/t_shirt.obj", "-o", folder / "out.glb",
                                            "--resolution", "1024", "--report", folder / "report.json"},
                                           std::chrono::milliseconds(400));
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_THAT(folder.entries(), IsEmpty());
}

// ------------------------------------------------------------------------------------------------- devices

TEST(Devices, ListTheCpuFirst) {
  const ProgramResult result = run_program({"devices", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  const json devices = json::parse(result.out)["devices"];
  ASSERT_FALSE(devices.empty());
  EXPECT_EQ(devices[0]["backend"], "cpu");
  EXPECT_EQ(std::count_if(devices.begin(), devices.end(), [](const json& d) { return d["chosen_automatically"]; }), 1);
}

}  // namespace
}  // namespace geocloth::test
