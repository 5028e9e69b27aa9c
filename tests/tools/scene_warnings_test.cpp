// SPDX-License-Identifier: GPL-3.0-or-later
// What `simulate` says of scenes that play without an error and not as their authors expect.
#include <algorithm>
#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geocloth/asset/asset_file.h"
#include "sliding_tetrahedron.h"
#include "support/make_sheet.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class SceneWarnings : public testing::Test {
 protected:
  SceneWarnings() {
    ClothAsset sheet = make_sheet({.nx = 9, .ny = 9, .charts_x = 2});
    write_asset(sheet, folder_ / "sheet.glb");
    ClothAsset sewn = sheet;
    for (uint32_t row = 0; row < sheet.splits.rows(); ++row) {
      const std::span<const uint32_t> copies = sheet.splits.copies(row);
      sewn.sewing.push_back({copies.front(), copies.back()});
    }
    sheet.splits = {};  // two sheets side by side
    sheet.seam_bends.clear();
    write_asset(sheet, folder_ / "two.glb");
    sewn.splits = {};
    sewn.seam_bends.clear();
    write_asset(sewn, folder_ / "sewn.glb");
  }

  /// Of a run; --check says the same, less what only playing tells.
  std::vector<std::string> warnings(const std::string& cloths, const std::string& more_of_scene = "",
                                    size_t only_played = 0) {
    const std::string scene = folder_.write(
        "scene.json",
        fmt::format(R"({{"version":1,"frames":30,"substeps":4,"cloths":[{}]{}}})", cloths, more_of_scene));
    const ProgramResult played =
        run_program({"simulate", scene, "--backend", "cpu", "--report", folder_ / "r.json", "--quiet"});
    EXPECT_EQ(played.status, 0) << played.err;
    const std::vector<std::string> said = nlohmann::json::parse(read_text(folder_ / "r.json"))["warnings"];
    for (const std::string& warning : said) EXPECT_THAT(played.err, HasSubstr("scene.json: warning: " + warning));
    const ProgramResult checked = run_program({"simulate", scene, "--check"});
    EXPECT_EQ(checked.status, 0) << checked.err;
    const auto lines = static_cast<size_t>(std::count(checked.err.begin(), checked.err.end(), '\n'));
    EXPECT_EQ(lines + only_played, said.size()) << checked.err << played.err;
    for (size_t i = 0; i < std::min(lines, said.size()); ++i) EXPECT_THAT(checked.err, HasSubstr(said[i]));
    return said;
  }

  TemporaryFolder folder_;
};

constexpr const char* kFloor = R"(,"colliders":[{"shape":"plane","point":[0,-3,0],"normal":[0,1,0]}])";

/// Shorts of a garment whose T-shirt was pinned fell 39 m without a word.
TEST_F(SceneWarnings, TellThatAPartHangsOnNoPin) {
  const std::string left = R"({"asset":"two.glb","pins":[{"where":{"vertices":[0,1]}}]})";
  EXPECT_THAT(warnings(left),
              ElementsAre(AllOf(HasSubstr("cloths[0] (two.glb): a part of it ("), HasSubstr("near vertex "),
                                HasSubstr("is held by no pin and falls"), HasSubstr("--parts"))));
  EXPECT_THAT(warnings(left, R"(,"gravity":[0,0,0])"), IsEmpty());
  EXPECT_THAT(warnings(R"({"asset":"two.glb"})", kFloor), IsEmpty());
  EXPECT_THAT(warnings(R"({"asset":"two.glb","pins":[{"where":{"top":0.1}}]})"), IsEmpty());
  EXPECT_THAT(warnings(R"({"asset":"sheet.glb","pins":[{"where":{"vertices":[0,1]}}]})"), IsEmpty());
  EXPECT_THAT(warnings(R"({"asset":"two.glb","pins":[{"where":{"vertices":[0]}},
                                                     {"where":{"vertices":[8]},"from":0.2,"frequency":3}]})"),
              IsEmpty());
}

/// Who pinned the lower panel too could not close the seam.
TEST_F(SceneWarnings, DoNotTellOfAPanelThatIsSewnToAPinnedOne) {
  const std::string pinned = R"("pins":[{"where":{"vertices":[0,1]}}])";
  EXPECT_THAT(warnings(R"({"asset":"sewn.glb",)" + pinned + "}"), IsEmpty());
  EXPECT_THAT(warnings(R"({"asset":"sewn.glb",)" + pinned + R"(,"sewing":{"start":9}})"),
              ElementsAre(HasSubstr("is held by no pin and falls")));
  EXPECT_THAT(warnings(R"({"asset":"sewn.glb",)" + pinned + R"(,"sewing":false})"),
              ElementsAre(HasSubstr("is held by no pin and falls")));
}

constexpr const char* kAway = R"("triangle":[[7,0,0],[8,0,0],[7,1,0]])";
constexpr const char* kAcross = R"("triangle":[[-3,0.02,-2],[3,0.02,-2],[0,0.02,4]])";

TEST_F(SceneWarnings, TellThatACutMetNothing) {
  const std::string sheet = fmt::format(
      R"({{"asset":"sheet.glb","pins":[{{"where":{{"top":0.1}}}}],"cuts":[{{"time":0.1,{}}},{{"time":0,{}}}]}})", kAway,
      kAcross);
  EXPECT_THAT(warnings(sheet, "", 1),
              ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): cuts[0] met no cloth"), HasSubstr("triangle"))));
}

TEST_F(SceneWarnings, TellWhatComesAfterTheLastFrame) {
  // 30 frames at 60 a second: the last one is from 0.48333 to 0.5 s.
  const auto sheet = [](double cut, double pin) {
    return fmt::format(
        R"({{"asset":"sheet.glb","pins":[{{"where":{{"top":0.1}}}},{{"where":{{"vertices":[40]}},"from":{}}}],)"
        R"("cuts":[{{"time":{},{}}}]}})",
        pin, cut, kAcross);
  };
  EXPECT_THAT(warnings(sheet(0.48333333333, 0.49)), IsEmpty());
  EXPECT_THAT(warnings(sheet(0.49, 0.1)),
              ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): cuts[0] would come after the last frame"),
                                HasSubstr("begins at 0.483333 s"))));
  EXPECT_THAT(warnings(sheet(0.1, 0.5)),
              ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): pins[1] would take hold after the last frame"),
                                HasSubstr("ends at 0.5 s"))));
  std::string many = fmt::format(R"({{"time":9,{}}})", kAcross);
  for (int i = 0; i < 5; ++i) many += fmt::format(R"(,{{"time":9,{}}})", kAcross);
  EXPECT_THAT(warnings(R"({"asset":"sheet.glb","cuts":[)" + many + "]}", kFloor),
              ElementsAre(HasSubstr("cuts[0], cuts[1], cuts[2] and 3 more would come")));
}

TEST_F(SceneWarnings, TellThatOnlySomePinsJump) {
  const std::string bar = R"(,"colliders":[{"name":"bar","shape":"sphere","center":[0,3,0],"radius":0.1,"motion":[
      {"time":0},{"time":0.2,"translate":[3,0,0],"teleport":true}]}])";
  const auto sheet = [](const std::string& second) {
    return R"({"asset":"sheet.glb","pins":[{"where":{"vertices":[0]},"follow":"bar"},{"where":{"vertices":[8]},)" +
           second + "}]}";
  };
  EXPECT_THAT(warnings(sheet(R"("follow":"bar")"), bar), IsEmpty());
  EXPECT_THAT(warnings(sheet(R"("follow":"world")"), bar),
              ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): 1 of its 2 pins follow \"bar\""),
                                HasSubstr("jumps at 0.2 s"))));
  EXPECT_THAT(warnings(sheet(R"("until":0.1)"), bar), IsEmpty());

  const auto pins = [](const std::string& first, const std::string& second) {
    return R"({"asset":"sheet.glb","pins":[{"where":{"vertices":[0]},"motion":[{"time":0},)" + first +
           R"(]},{"where":{"vertices":[8]},"motion":[{"time":0},)" + second + "]}]}";
  };
  const std::string away = R"({"time":0.2,"translate":[3,0,0],"teleport":true})";
  EXPECT_THAT(warnings(pins(away, away)), IsEmpty());
  EXPECT_THAT(warnings(pins(away, R"({"time":0.2,"translate":[0,0,0]})")),
              ElementsAre(AllOf(HasSubstr("1 of its 2 pins jump at 0.2 s"), HasSubstr("jump alike"))));
  const std::string turn = R"({"time":0.2,"rotate_deg":[0,90,0],"teleport":true})";
  EXPECT_THAT(warnings(pins(turn, turn)), ElementsAre(HasSubstr("but apart")));
  EXPECT_THAT(warnings(std::regex_replace(pins(turn, turn), std::regex(R"("motion")"), R"("pivot":[0,1,0],"motion")")),
              IsEmpty());
  EXPECT_THAT(warnings(pins(away, R"({"time":0.2,"translate":[3,1,0],"teleport":true})")),
              ElementsAre(HasSubstr("its pins jump at 0.2 s, but apart")));
}

TEST_F(SceneWarnings, SayThatClothOnlyFallsUnlessNothingDrawsItDown) {
  EXPECT_THAT(warnings(R"({"asset":"sheet.glb"})"), ElementsAre(HasSubstr("it only falls")));
  for (const std::string scale : {"0", "-0.1"})
    EXPECT_THAT(warnings(R"({"asset":"sheet.glb","gravity_scale":)" + scale + "}"), IsEmpty()) << scale;
}

/// Two sheets that were to lie closer lay in one another, without a word.
TEST_F(SceneWarnings, TellOfPointsThatFitBetweenOthers) {
  const auto sheet = [](const char* collision) {
    return fmt::format(R"({{"asset":"sheet.glb","pins":[{{"where":{{"top":0.1}}}}]{}}})", collision);
  };
  EXPECT_THAT(
      warnings(sheet(R"(,"self_collision":{"distance":0.08})")),
      ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): \"self_collision\" keeps points 0.08 m apart"),
                        HasSubstr("0.125 m from their neighbours"), HasSubstr("\"distance\" of 0.11 or more"))));
  EXPECT_THAT(warnings(sheet(R"(,"self_collision":{"distance":0.1})")), IsEmpty());
  const std::string narrow = sheet(R"(,"inter_collision":{"distance":0.05})");
  EXPECT_THAT(warnings(narrow + "," + sheet(R"(,"inter_collision":true)")),
              ElementsAre(HasSubstr("\"inter_collision\" keeps points 0.05 m apart")));
}

TEST_F(SceneWarnings, TellWhatHasNoEffect) {
  const auto sheet = [](const std::string& more) {
    return R"({"asset":"sheet.glb","pins":[{"where":{"vertex_group":"top"}}])" + more + "}";
  };
  const std::string apart = R"(,"inter_collision":true)";
  EXPECT_THAT(warnings(sheet(apart)),
              ElementsAre(HasSubstr("cloths[0] (sheet.glb): \"inter_collision\" has no effect")));
  EXPECT_THAT(warnings(sheet(apart) + "," + sheet("")), ElementsAre(HasSubstr("\"inter_collision\" has no effect")));
  EXPECT_THAT(warnings(sheet(apart) + R"(,{"asset":"sheet.glb","transform":{"translate":[0,0,1]})" + apart + "}"),
              IsEmpty());
  EXPECT_THAT(warnings(sheet(R"(,"inertia_scale":[0.5,1,1])")),
              ElementsAre(HasSubstr("\"inertia_scale\" has no effect")));
  EXPECT_THAT(warnings(sheet(R"(,"inertia_scale":[0.5,1,1],"motion":[{"time":0}])")), IsEmpty());
}

TEST_F(SceneWarnings, TellThatNothingHoldsACloth) {
  const std::string sheet = R"({"asset":"sheet.glb"})";
  EXPECT_THAT(warnings(sheet),
              ElementsAre(HasSubstr("cloths[0] (sheet.glb): it has no pins, and there are no colliders")));
  EXPECT_THAT(warnings(sheet, kFloor), IsEmpty());
  EXPECT_THAT(warnings(sheet, R"(,"gravity":[0,0,0])"), IsEmpty());
  EXPECT_THAT(warnings(R"({"asset":"sheet.glb","collides_with":[]})", kFloor),
              ElementsAre(HasSubstr("cloths[0] (sheet.glb): it has no pins, and it meets no collider")));
}

TEST_F(SceneWarnings, SayNothingOfCollidersThatAClothDoesNotMeet) {
  const auto sheet = [](const std::string& more) {
    return R"({"asset":"sheet.glb","pins":[{"where":{"vertex_group":"top"}}])" + more + "}";
  };
  const std::string around = R"(,"colliders":[{"name":"ball","shape":"sphere","center":[0,0,0],"radius":3}])";
  EXPECT_THAT(warnings(sheet(""), around), ElementsAre(HasSubstr("points begin inside collider \"ball\"")));
  EXPECT_THAT(warnings(sheet(R"(,"ignores":["ball"])"), around), IsEmpty());
}

/// A knight with 8 animations stood still, and nothing said so.
TEST_F(SceneWarnings, TellThatABodyIsAnimated) {
  folder_.write("moves.gltf", kSlidingTetrahedron);
  folder_.write("still.gltf",
                std::regex_replace(kSlidingTetrahedron, std::regex(R"("animations":\[\{[^!]*\}\]\}\],)"), ""));
  const auto on = [](const std::string& file) {
    return R"(,"colliders":[{"shape":"mesh","file":")" + file + R"(","transform":{"translate":[0,-5,0]}}])";
  };
  const std::string sheet = R"({"asset":"sheet.glb","pins":[{"where":{"vertex_group":"top"}}]})";
  EXPECT_THAT(warnings(sheet, on("moves.gltf")),
              ElementsAre(HasSubstr("colliders[0] (moves.gltf): the file has 1 animation, which is not played")));
  EXPECT_THAT(warnings(sheet, on("still.gltf")), IsEmpty());
  EXPECT_THAT(warnings(sheet, std::regex_replace(on("moves.gltf"), std::regex("gltf\""), "gltf\",\"animation\":0")),
              IsEmpty());
}

/// A walk that went two metres and began anew where it had begun threw what was worn.
TEST_F(SceneWarnings, TellThatALoopDoesNotClose) {
  folder_.write("moves.gltf", kSlidingTetrahedron);
  const auto plays = [](const std::string& animation) {
    return R"(,"colliders":[{"shape":"mesh","file":"moves.gltf","transform":{"translate":[0,-9,0],"scale":2},"animation":)" +
           animation + "}]";
  };
  const std::string sheet = R"({"asset":"sheet.glb","pins":[{"where":{"vertex_group":"top"}}]})";
  EXPECT_THAT(warnings(sheet, plays(R"({"loop":true})")),
              ElementsAre(HasSubstr("colliders[0] (moves.gltf): its animation ends up to 1 m from where it begins")));
  EXPECT_THAT(warnings(sheet, plays("{}")), IsEmpty());
  // One that goes all the way in three frames goes as fast as it jumps.
  EXPECT_THAT(warnings(sheet, plays(R"({"loop":true,"speed":20})")), IsEmpty());
}

/// Pins on levers of a hundred metres, where a garment was converted from centimetres, throw it about.
TEST_F(SceneWarnings, TellThatASkinIsNotTheGarment) {
  folder_.write("moves.gltf", kSlidingTetrahedron);
  const auto with = [](const std::string& transform, const std::string& follow) {
    return fmt::format(R"({{"asset":"sheet.glb","pins":[{{"where":{{"vertex_group":"top"}},"follow":"{}"}}],
        "skin":{{"file":"moves.gltf","animation":0{}}}}})",
                       follow, transform);
  };
  const std::string around = R"(,"transform":{"translate":[-1,-1,0],"scale":4})";  // a face of it lies on the sheet
  EXPECT_THAT(warnings(with(around, "skin")), IsEmpty());
  EXPECT_THAT(warnings(with("", "skin")),
              ElementsAre(AllOf(HasSubstr("its pins begin up to 0.5 m away"), HasSubstr("moves.gltf"))));
  EXPECT_THAT(warnings(with(around, "cloth")), ElementsAre(HasSubstr("it has a skin, which moves nothing")));
}

/// Cloth stayed a finger's breadth inside of its wearer, and nothing said why.
TEST_F(SceneWarnings, TellThatASkinFacesInwards) {
  folder_.write("out.gltf", kSlidingTetrahedron);
  // The other two corners of each triangle first.
  folder_.write("in.gltf",
                std::regex_replace(kSlidingTetrahedron, std::regex("D8AAgEAAQMAAwIBAgM="), "D8AAQIAAwEAAgMBAwI="));
  const auto with = [](const std::string& file, const std::string& backstop) {
    return fmt::format(R"({{"asset":"sheet.glb","pins":[
        {{"where":{{"vertex_group":"top"}},"follow":"skin","max_distance":0.1{}}}],
        "skin":{{"file":"{}","animation":0,"transform":{{"translate":[-1,-1,0],"scale":4}}}}}})",
                       backstop, file);
  };
  const std::string backstop = R"(,"backstop":0.02)";
  EXPECT_THAT(warnings(with("out.gltf", backstop)), IsEmpty());
  EXPECT_THAT(warnings(with("in.gltf", "")), IsEmpty());
  EXPECT_THAT(warnings(with("in.gltf", backstop)),
              ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): its \"backstop\""),
                                HasSubstr("cloths[0].skin (in.gltf)"), HasSubstr("face inwards"))));
}

/// A curtain that was drawn lay squeezed in its plane, in a heap of cells, and nothing said why.
TEST_F(SceneWarnings, TellThatFlatClothCannotFold) {
  const std::string drawn =
      R"({"asset":"sheet.glb","pins":[{"where":{"vertex_group":"left"},"motion":[{"time":0},{"time":0.3,"translate":[0.3,0,0]}]},)"
      R"({"where":{"vertex_group":"right"},"motion":[{"time":0},{"time":0.3,"translate":[-0.3,0,0]}]}]})";
  EXPECT_THAT(warnings(drawn, "", 1), ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): it is squeezed in the plane"),
                                                        HasSubstr("\"imperfection\""))));
  EXPECT_THAT(warnings(drawn, R"(,"imperfection":1e-6)"), IsEmpty());
  EXPECT_THAT(warnings(R"({"asset":"sheet.glb","pins":[{"where":{"vertex_group":"top"}}]})"), IsEmpty());
}

/// A cushion at 200 Pa was half as large again, and flew off.
TEST_F(SceneWarnings, TellThatSubstepsDoNotHoldAPressure) {
  const auto sail = [](double pressure) {
    return fmt::format(R"({{"asset":"sheet.glb","pressure":{},"pins":[{{"where":{{"vertex_group":"top"}}}},
        {{"where":{{"vertex_group":"bottom"}}}}]}})",
                       pressure);
  };
  EXPECT_THAT(warnings(sail(500), "", 1),
              ElementsAre(AllOf(HasSubstr("cloths[0] (sheet.glb): its pressure of 500 Pa stretches it by about"),
                                HasSubstr("\"substeps\""))));
  EXPECT_THAT(warnings(sail(2)), IsEmpty());
}

/// A tube was twice as much wider as its material lets it be, without a word: half of its springs run along it.
TEST_F(SceneWarnings, TellThatSubstepsDoNotHoldATubesPressure) {
  write_asset(make_tube({}), folder_ / "tube.glb");
  const auto tube = [](double pressure) {
    return fmt::format(
        R"({{"asset":"tube.glb","pressure":{},"material":{{"max_stretch":0}},"pins":[{{"where":{{"vertex_group":"top"}}}}]}})",
        pressure);
  };
  EXPECT_THAT(warnings(tube(7), "", 1), ElementsAre(HasSubstr("its pressure of 7 Pa stretches it by about")));
  EXPECT_THAT(warnings(tube(1)), IsEmpty());
}

}  // namespace
}  // namespace geocloth::test
