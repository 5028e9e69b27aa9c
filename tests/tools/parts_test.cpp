// SPDX-License-Identifier: GPL-3.0-or-later
// convert --parts: a garment file holds more than the cloth, and its user says what to take.
#include <algorithm>

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
using testing::StartsWith;

/// A square sheet of OBJ text at height z, in the file's running numbers. @param vertices  written so far
std::string sheet(int vertices, double size, double z) {
  std::string text;
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
    text += "v " + std::to_string(size * x) + " " + std::to_string(size * y) + " " + std::to_string(z) + "\n";
  }
  const auto corner = [&](int i) { return std::to_string(vertices + i) + " "; };
  return text + "f " + corner(1) + corner(2) + corner(3) + corner(4) + "\n";
}

/// A shirt of two sleeves in one cloth, and a button of metal.
std::string outfit() {
  return "mtllib none.mtl\no body\nusemtl cotton\n" + sheet(0, 1, 0) + "o left\nusemtl cotton\n" + sheet(4, 0.5, 1) +
         "o right\nusemtl wool\n" + sheet(8, 0.5, 2) + "o button\nusemtl metal\n" + sheet(12, 0.1, 3);
}

/// The sheets of a mesh in one object.
std::string loose_pieces() {
  return sheet(0, 0.1, 0) + sheet(4, 1, 1) + sheet(8, 0.5, 2);
}

class Parts : public testing::Test {
 protected:
  ProgramResult convert(const std::vector<std::string>& options) {
    std::vector<std::string> words{"convert", mesh_, "-o", folder_ / "out.glb", "--resolution", "16", "-q"};
    words.insert(words.end(), options.begin(), options.end());
    return run_program(words);
  }
  /// Connected components of the image, and the area of its cloth [m^2] within a tenth.
  json image_of(const std::string& selection) {
    const ProgramResult result = convert({"--parts", selection, "--report", folder_ / "report.json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return json::parse(read_text(folder_ / "report.json"));
  }

  TemporaryFolder folder_;
  std::string mesh_ = folder_.write("outfit.obj", outfit());
};

TEST_F(Parts, ListIsForPeopleAndWritesNothing) {
  const ProgramResult result = run_program({"convert", mesh_, "--parts", "list"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, IsEmpty());
  for (const char* word : {"body", "left", "right", "button", "cotton", "wool", "metal", "0.25", "0.5 x 0.5 x 0"}) {
    EXPECT_THAT(result.out, HasSubstr(word));
  }
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 5) << result.out;
  EXPECT_THAT(folder_.entries(), ElementsAre("outfit.obj"));
}

TEST_F(Parts, AFileOfOnePartIsTakenIntoPieces) {
  mesh_ = folder_.write("pieces.obj", loose_pieces());
  const std::string list = run_program({"convert", mesh_, "--parts", "list"}).out;
  EXPECT_EQ(std::count(list.begin(), list.end(), '\n'), 4) << list;
  EXPECT_LT(list.find("1 x 1 x 0"), list.find("0.1 x 0.1 x 0")) << list;
  EXPECT_EQ(image_of("0-1")["welded"]["components"], 2);
  EXPECT_EQ(image_of("-piece 0")["source"]["faces"], 2);
}

// Who models names objects; their meshes are called "Plane.004" and "Cube.017".
TEST_F(Parts, OfScenesAreCalledAsTheirObjectsOrElseAsTheirMeshes) {
  mesh_ = folder_.write("objects.gltf", R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2]}],
    "nodes":[{"mesh":0,"name":"Cape"},{"mesh":0,"name":"Hood","translation":[3,0,0]},{"mesh":1,"translation":[6,0,0]}],
    "meshes":[{"name":"Plane.004","primitives":[{"attributes":{"POSITION":0}}]},
              {"name":"Hood","primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,
    "uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
  const std::string list = run_program({"convert", mesh_, "--parts", "list"}).out;
  EXPECT_THAT(list, HasSubstr("0  Cape"));
  EXPECT_THAT(list, HasSubstr("1  Hood"));
  EXPECT_THAT(list, HasSubstr("2  Hood"));
  EXPECT_EQ(image_of("Cape")["source"]["faces"], 1);
  EXPECT_EQ(image_of("Hood")["source"]["faces"], 2);
  EXPECT_EQ(image_of("Plane.004")["source"]["faces"], 2);
  EXPECT_EQ(image_of("-Cape")["source"]["faces"], 2);
}

// A cache goes on one object of a modelling program; of the whole file it would have other vertices.
TEST_F(Parts, HavePointCachesOfTheirOwn) {
  ASSERT_EQ(convert({"--parts", "left,right"}).status, 0);
  const ProgramResult result = run_program({"simulate", folder_ / "out.glb", "--frames", "1", "--backend", "cpu",
                                            "--each-part", "-o", folder_ / "c.pc2", "-q"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("c_left.pc2\n"));
  EXPECT_THAT(folder_.entries(), ElementsAre("c_left.pc2", "c_right.pc2", "out.glb", "outfit.obj"));
  for (const char* name : {"c_left.pc2", "c_right.pc2"}) {
    EXPECT_EQ(read_text(folder_ / name).size(), 32U + 2 * 4 * 12) << name;  // two frames of four points
  }
}

TEST_F(Parts, ACacheOfOneIsNotWrittenOverWhatTheSceneReads) {
  mesh_ = folder_.write("outfit.obj", "o sheet\n" + sheet(0, 1, 0));
  ASSERT_EQ(convert({}).status, 0);
  const auto simulate = [&](const std::string& scene) {
    return run_program({"simulate", folder_ / scene, "--each-part", "-o", folder_ / "c.pc2", "-q"});
  };
  folder_.write("first.json", R"({"version":1,"frames":1,"cloths":[{"asset":"out.glb"}]})");
  ASSERT_EQ(simulate("first.json").status, 0);
  folder_.write("again.json", R"({"version":1,"frames":1,"cloths":[{"asset":"out.glb","start":"c_sheet.pc2"}]})");
  const ProgramResult again = simulate("again.json");
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.err, AllOf(HasSubstr("c_sheet.pc2"), HasSubstr("a start of the scene")));
}

TEST_F(Parts, AreChosenByNumberNameAndMaterial) {
  const std::vector<std::pair<std::string, int>> components{{"0", 1},
                                                            {"0,2", 2},
                                                            {"1-3", 3},
                                                            {"left,right", 2},
                                                            {"body,button", 2},
                                                            {"-3", 3},
                                                            {"-1-2", 2},
                                                            {"-left", 3},
                                                            {"material:cotton", 2},
                                                            {"-material:metal,-wool_is_no_name", 0},
                                                            {"0-3,-right", 3},
                                                            {"-0,0", 4},
                                                            {"-material:wool", 3}};
  for (const auto& [selection, count] : components) {
    if (count == 0) {
      EXPECT_EQ(convert({"--parts", selection}).status, 1) << selection;
      continue;
    }
    EXPECT_EQ(image_of(selection)["welded"]["components"], count) << selection;
  }
}

// The numbers by which scenes pin vertices stay those of the file.
TEST_F(Parts, VerticesKeepTheirNumbers) {
  image_of("button");
  const json found = json::parse(run_program({"inspect", folder_ / "out.glb", "--json"}).out);
  EXPECT_EQ(found["source"]["triangles"], 2);
  EXPECT_EQ(found["source"]["vertices"], 16);
}

TEST_F(Parts, WhatIsNoPartIsOneLineThatSaysWhatThereIs) {
  for (const char* selection :
       {"4", "2-9", "3-2", "collar", "material:silk", "-0,-1,-2,-3", "1.5", "Body", "-body,-9"}) {
    const ProgramResult result = convert({"--parts", selection});
    EXPECT_EQ(result.status, 1) << selection;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("outfit.obj"));
    EXPECT_THAT(result.err, HasSubstr("--parts list"));
  }
  EXPECT_THAT(convert({"--parts", "collar"}).err, HasSubstr("0 body, 1 left, 2 right, 3 button"));
  EXPECT_THAT(folder_.entries(), ElementsAre("outfit.obj"));
}

TEST_F(Parts, NonsenseIsWrongUsage) {
  for (const char* selection : {"", ",", "0,,1", "0,", "-", "0,-"}) {
    const ProgramResult result = convert({"--parts", selection});
    EXPECT_EQ(result.status, 2) << "'" << selection << "' " << result.err;
    EXPECT_THAT(result.err, StartsWith("geocloth convert: "));
  }
}

}  // namespace
}  // namespace geocloth::test
