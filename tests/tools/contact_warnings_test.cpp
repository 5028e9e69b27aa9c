// SPDX-License-Identifier: GPL-3.0-or-later
// What `simulate` says where cloth and colliders do not go together: a garment that begins inside its wearer flies off,
// and a wearer that shows through the garment is what everybody sees first.
#include <regex>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sliding_tetrahedron.h"
#include "support/run_program.h"
#include "support/temporary_folder.h"

namespace geocloth::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A level square of 0.6 m about the origin, in few triangles: 0.15 m, the grid's springs are a tenth of that.
std::string coarse_square() {
  constexpr int kSide = 5;
  std::string obj;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) obj += fmt::format("v {} 0 {}\n", 0.15 * i - 0.3, 0.15 * j - 0.3);
  for (int j = 0; j + 1 < kSide; ++j)
    for (int i = 0; i + 1 < kSide; ++i) {
      const int v = j * kSide + i + 1;
      obj += fmt::format("f {} {} {} {}\n", v, v + kSide, v + kSide + 1, v + 1);
    }
  return obj;
}

class ContactWarnings : public testing::Test {
 protected:
  ContactWarnings() {
    const std::string mesh = folder_.write("square.obj", coarse_square());
    const ProgramResult made =
        run_program({"convert", mesh, "-o", folder_ / "square.glb", "--resolution", "40", "--quiet"});
    EXPECT_EQ(made.status, 0) << made.err;
  }

  struct Run {
    std::vector<std::string> warnings;
    double drawn_penetration = 0, penetration = 0;
    std::string err;
  };

  Run simulate(const std::string& cloth, const std::string& colliders, int substeps = 16) {
    const std::string scene = folder_.write(
        "scene.json", fmt::format(R"({{"version":1,"frames":30,"substeps":{},"cloths":[{{"asset":"square.glb",{}}}],)"
                                  R"("colliders":[{}]}})",
                                  substeps, cloth, colliders));
    const ProgramResult result =
        run_program({"simulate", scene, "--backend", "cpu", "--report", folder_ / "r.json", "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    const nlohmann::json report = nlohmann::json::parse(read_text(folder_ / "r.json"));
    return {report["warnings"], report["drawn_penetration"], report["penetration"], result.err};
  }

  TemporaryFolder folder_;
};

constexpr const char* kBall = R"({"name":"ball","shape":"sphere","center":[0.02,-0.21,0.03],"radius":0.2})";

TEST_F(ContactWarnings, TellThatAColliderShowsThroughAndTheThicknessThatCoversIt) {
  const Run thin = simulate(R"("material":{"thickness":0.002})", kBall);
  EXPECT_GT(thin.drawn_penetration, 0.004);  // 0.15 m over a ball of 0.2 m sag by 14 mm
  EXPECT_LE(thin.penetration, 1e-4);         // the points do not
  ASSERT_THAT(thin.warnings, ElementsAre(AllOf(HasSubstr("cloths[0] (square.glb)"), HasSubstr("collider \"ball\""),
                                               HasSubstr("shows through"))));
  EXPECT_THAT(thin.err, HasSubstr(thin.warnings[0]));
  std::smatch advised;
  ASSERT_TRUE(std::regex_search(thin.warnings[0], advised, std::regex("\"thickness\": ([0-9.]+)"))) << thin.err;
  const Run thick = simulate(fmt::format(R"("material":{{"thickness":{}}})", advised[1].str()), kBall);
  EXPECT_THAT(thick.warnings, IsEmpty());
}

TEST_F(ContactWarnings, TellThatAGarmentBeginsInsideACollider) {
  const std::string cloth = R"("material":"cotton")";
  const Run buried = simulate(cloth, R"({"shape":"box","center":[0,0,0],"half_extents":[0.2,0.1,0.2]})");
  ASSERT_THAT(buried.warnings, ElementsAre(AllOf(HasSubstr("begin inside colliders[0]"), HasSubstr("0.1 m deep"))));
  // A quarter of a spacing is no more than the thickness puts right.
  const Run touching = simulate(cloth, R"({"shape":"box","center":[0,-0.098,0],"half_extents":[0.5,0.1,0.5]})");
  EXPECT_THAT(touching.warnings, IsEmpty());
}

/// Two squares, the second one upright amid the first, or held so that it goes through it.
TEST_F(ContactWarnings, TellThatClothsLieOrGetThroughEachOther) {
  const std::string meets = R"("inter_collision":true,"pins":[{"where":{"top":1})";
  const auto second = [&](const char* pose, const char* pin) {
    return fmt::format(R"({0},"follow":"world"}}]}},{{"asset":"square.glb","transform":{{{1}}},{0}{2}}}])", meets, pose,
                       pin);
  };
  const Run tangled = simulate(second(R"("rotate_deg":[90,0,0])", ""), "");
  ASSERT_THAT(tangled.warnings, ElementsAre(HasSubstr("cut through each other, which it does not draw apart")));
  const Run apart = simulate(second(R"("translate":[0,0.3,0])", ""), "");
  EXPECT_THAT(apart.warnings, IsEmpty());
  const Run driven =
      simulate(second(R"("translate":[0,0.5,0],"rotate_deg":[90,0,0])",
                      R"(,"motion":[{"time":0,"translate":[0,0,0]},{"time":0.1,"translate":[0,-0.5,0]}])"),
               "");
  EXPECT_THAT(driven.warnings, ElementsAre(HasSubstr("they got through each other")));
  const Run once = simulate(R"("self_collision":true,"pins":[{"where":{"top":1}}])", "");
  EXPECT_THAT(once.warnings, IsEmpty()) << "one that lies flat";
}

/// Garments are made for the pose that the file opens with.
TEST_F(ContactWarnings, TellThatAnAnimationMayBeginInAnotherPose) {
  folder_.write("body.gltf", kSlidingTetrahedron);
  const auto body = [](const char* animation) {
    return fmt::format(R"({{"shape":"mesh","file":"body.gltf","transform":{{"translate":[-0.2,-0.2,-0.2]}}{}}})",
                       animation);
  };
  const std::string cloth = R"("material":"cotton")";
  const auto says = [](const testing::Matcher<const std::string&>& what) {
    return Contains(AllOf(HasSubstr("begin inside colliders[0]"), what));
  };
  EXPECT_THAT(simulate(cloth, body(R"(,"animation":0)")).warnings, says(HasSubstr("the animation a \"start\"")));
  EXPECT_THAT(simulate(cloth, body(R"(,"animation":{"start":0.2})")).warnings, says(Not(HasSubstr("\"start\""))));
}

/// Two fifths of a dress began inside its wearer, by less than two spacings, and nothing was said.
TEST_F(ContactWarnings, TellThatMuchOfAGarmentBeginsInsideACollider) {
  const std::string cloth = R"("material":"cotton")";
  const Run half = simulate(cloth, R"({"shape":"box","center":[0.3,-0.095,0],"half_extents":[0.3,0.1,0.5]})");
  EXPECT_THAT(half.warnings,
              Contains(AllOf(HasSubstr("begin inside colliders[0], up to 0.005 m"), HasSubstr("may stretch"))));
  const Run spot = simulate(cloth, R"({"shape":"box","center":[0,-0.095,0],"half_extents":[0.04,0.1,0.04]})");
  EXPECT_THAT(spot.warnings, Not(Contains(HasSubstr("begin inside"))));
}

/// A thickness was advised where a ball had torn the cloth open and gone.
TEST_F(ContactWarnings, TellThatAColliderWentThrough) {
  const Run torn = simulate(R"("material":"cotton","pins":[{"where":{"boundary":0}}])",
                            R"({"name":"ball","shape":"sphere","center":[0.02,-0.3,0.03],"radius":0.2,)"
                            R"("motion":[{"time":0},{"time":0.2,"translate":[0,1.5,0]}]})",
                            1);
  EXPECT_THAT(torn.warnings, ElementsAre(AllOf(HasSubstr("collider \"ball\" went through it"),
                                               HasSubstr("more \"substeps\""), Not(HasSubstr("thickness")))));
}

TEST_F(ContactWarnings, LeaveOutWhatPinsHoldAndFlatGround) {
  const Run pinned = simulate(R"("material":"cotton","pins":[{"where":{"box":[[-1,-1,-1],[1,1,1]]}}])",
                              R"({"shape":"box","center":[0,0,0],"half_extents":[0.2,0.1,0.2]})");
  EXPECT_THAT(pinned.warnings, IsEmpty());
  const Run ground = simulate(R"("material":"cotton")", R"({"shape":"plane","point":[0,-0.05,0],"normal":[0,1,0]})");
  EXPECT_THAT(ground.warnings, IsEmpty());
  EXPECT_EQ(ground.drawn_penetration, 0);
}

}  // namespace
}  // namespace geocloth::test
