// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of a scene that an animation deforms: what collides with cloth, and what pins ride on.

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "geocloth/solver/scene.h"
#include "solver_fixture.h"
#include "support/ball_surface.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Scene with_body(const std::string& keys) {
  return parse_scene(
      R"({"version":1,"cloths":[{"asset":"a.glb"}],"colliders":[{"shape":"mesh","file":"b.glb")" + keys + "}]}",
      "folder/scene.json");
}

TEST(SceneBodies, AnAnimationIsNamedOrNumberedOrToldInFull) {
  const auto plays = [](const std::string& animation) {
    return with_body(R"(,"animation":)" + animation).colliders.at(0).mesh.value().animation.value();
  };
  EXPECT_EQ(plays(R"("Walk")").clip, "Walk");
  EXPECT_EQ(plays("2").clip, "2");
  EXPECT_EQ(plays("{}").clip, "");
  const BodyAnimation all = plays(R"({"clip":1,"start":0.5,"speed":2,"loop":true})");
  EXPECT_EQ(all.clip, "1");
  EXPECT_EQ(all.start, 0.5);
  EXPECT_EQ(all.speed, 2);
  EXPECT_TRUE(all.loop);
  EXPECT_FALSE(plays("0").loop);
  EXPECT_FALSE(with_body("").colliders.at(0).mesh.value().animation);
  EXPECT_EQ(with_body(R"(,"parts":"-Cape")").colliders.at(0).mesh.value().parts, "-Cape");
  EXPECT_EQ(with_body(R"(,"parts":3)").colliders.at(0).mesh.value().parts, "3");
  EXPECT_EQ(with_body(R"(,"spacing":0.01)").colliders.at(0).field_spacing, 0.01F);
}

TEST(SceneBodies, APointCacheMayMoveThem) {
  const auto plays = [](const std::string& animation) {
    return with_body(R"(,"animation":)" + animation).colliders.at(0).mesh.value().animation.value();
  };
  const BodyAnimation walk = plays(R"("walk.PC2")");
  EXPECT_EQ(walk.cache, std::filesystem::path("folder/walk.PC2"));
  EXPECT_EQ(walk.clip, "");
  EXPECT_FALSE(walk.rate);
  EXPECT_EQ(walk.scene_rate, 60);
  const BodyAnimation all =
      plays(R"({"file":"c/walk.mdd","rate":24,"transform":{"scale":0.01},"start":1,"speed":2,"loop":true})");
  EXPECT_EQ(all.cache, std::filesystem::path("folder/c/walk.mdd"));
  EXPECT_EQ(all.rate, 24);
  EXPECT_EQ(all.cache_transform.scale, 0.01F);
  EXPECT_EQ(all.start, 1);
  EXPECT_EQ(all.speed, 2);
  EXPECT_TRUE(all.loop);
  EXPECT_EQ(plays(R"("pc2")").clip, "pc2");
}

TEST(SceneBodies, WhatIsWrongWithThemIsSaid) {
  const auto said = [](const std::string& text) -> std::string {
    try {
      static_cast<void>(parse_scene(text, "scene.json"));
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  const auto animation = [&](const std::string& is) {
    return said(
        R"({"version":1,"cloths":[{"asset":"a.glb"}],"colliders":[{"shape":"mesh","file":"b.glb","animation":)" + is +
        "}]}");
  };
  EXPECT_THAT(animation("true"), HasSubstr("colliders[0].animation"));
  EXPECT_THAT(animation("-1"), HasSubstr("colliders[0].animation"));
  EXPECT_THAT(animation(R"({"clip":[]})"), HasSubstr("colliders[0].animation.clip"));
  EXPECT_THAT(animation(R"({"start":-1})"), HasSubstr("colliders[0].animation.start"));
  EXPECT_THAT(animation(R"({"speed":0})"), HasSubstr("colliders[0].animation.speed"));
  EXPECT_THAT(animation(R"({"lop":true})"), HasSubstr("nearest known one is \"loop\""));
  EXPECT_THAT(animation(R"({"file":"walk.abc"})"), HasSubstr("colliders[0].animation.file: must name a point cache"));
  EXPECT_THAT(animation(R"({"file":"a.pc2","clip":0})"), HasSubstr("colliders[0].animation.clip: is an animation of"));
  EXPECT_THAT(animation(R"({"file":"a.pc2","rate":0})"), HasSubstr("colliders[0].animation.rate: must be from"));
  EXPECT_THAT(animation(R"({"clip":0,"rate":24})"), HasSubstr("colliders[0].animation.rate: is for a point cache"));
  EXPECT_THAT(animation(R"({"transform":{}})"), HasSubstr("colliders[0].animation.transform: is for a point cache"));
  EXPECT_THAT(animation(R"(0,"spacing":0)"), HasSubstr("colliders[0].spacing: must be from"));
  const auto cloth = [&](const std::string& keys, const std::string& rest = "") {
    return said(R"({"version":1,"cloths":[{"asset":"a.glb")" + keys + "}]" + rest + "}");
  };
  const std::string rides = R"(,"pins":[{"where":{"top":0},"follow":"skin"}])";
  const std::string skin = R"(,"skin":{"file":"b.glb","animation":0})";
  EXPECT_EQ(cloth(rides + skin), "nothing");
  EXPECT_THAT(cloth(rides), HasSubstr("cloths[0].pins[0].follow: its cloth has no \"skin\""));
  EXPECT_THAT(cloth(R"(,"skin":{"file":"b.glb"})"), HasSubstr("cloths[0].skin: the key \"animation\" is missing"));
  EXPECT_THAT(cloth(R"(,"skin":{"file":"","animation":0})"), HasSubstr("cloths[0].skin.file: must name a mesh file"));
  EXPECT_THAT(cloth(skin, R"(,"colliders":[{"name":"skin","shape":"sphere","center":[0,0,0],"radius":1}])"),
              HasSubstr("the name \"skin\" is taken"));
}

/// A box with the corner (-1, -1, -1) and (1, 1, 1) that swings and grows: its upper corners go up by half a metre a
/// second and turn about y.
MovingBody swaying_box(const SceneMesh&) {
  MovingBody body;
  for (const auto& t : {std::array{0, 2, 1},
                        {1, 2, 3},
                        {4, 5, 6},
                        {5, 7, 6},
                        {0, 1, 4},
                        {1, 5, 4},
                        {2, 6, 3},
                        {3, 6, 7},
                        {0, 4, 2},
                        {2, 4, 6},
                        {1, 3, 5},
                        {3, 7, 5}}) {
    body.triangle.push_back({static_cast<uint32_t>(t[0]), static_cast<uint32_t>(t[1]), static_cast<uint32_t>(t[2])});
  }
  body.positions_at = [](double time) {
    std::vector<Vec3> position;
    for (int i = 0; i < 8; ++i) {
      const auto side = [&](int bit) { return (i >> bit & 1) != 0 ? 1.F : -1.F; };
      const Vec3 corner{side(0), side(1), side(2)};
      const auto t = static_cast<float>(time);
      const Vec3 turned = rotate(quat_from_euler_deg({0, 90 * t, 0}), corner) + Vec3{0, 0.5F * t, 0};
      position.push_back(corner.y > 0 ? turned : corner);
    }
    return position;
  };
  return body;
}

class PlayingBodies : public ::testing::Test {
 protected:
  void SetUp() override { write_asset(test::make_sheet(sheet_), folder_ / "sheet.glb"); }

  Simulation play(const std::string& cloth, const std::string& rest, const BodyReader& bodies) {
    const std::string text =
        R"({"version":1,"frame_rate":60,"substeps":4,"cloths":[{"asset":"sheet.glb")" + cloth + "}]" + rest + "}";
    return {parse_scene(text, folder_ / "scene.json"), test::cpu_settings(), bodies};
  }
  [[nodiscard]] Vec3 point(Simulation& simulation, uint32_t i, uint32_t j) const {
    return test::positions_of(simulation.solver())[test::sheet_pixel(sheet_, i, j)];
  }

  test::SheetOptions sheet_{.nx = 9, .ny = 9};
  test::TemporaryFolder folder_;
};

TEST_F(PlayingBodies, TheirFieldsAreAsFineAsTheSceneSays) {
  for (const char* animation : {"", R"("animation":0,)"}) {
    Simulation simulation =
        play("", std::string(R"(,"colliders":[{"shape":"mesh","file":"box.glb",)") + animation + R"("spacing":0.125}])",
             {.surface =
                  [](const SceneMesh&) {
                    return test::ball_surface({0, -2, 0}, 1);
                  },
              .moving = swaying_box});
    for (int f = 0; f < 2; ++f) {
      const Collider body = simulation.colliders().at(0);
      EXPECT_EQ(std::get<MeshSolid>(body.shape).field->spacing, 0.125F) << animation;
      simulation.step();
    }
  }
}

// The sheet's upper edge is above the box: it rides on the box's upper side, and turns with it.
TEST_F(PlayingBodies, PinsRideOnTheSurfaceOfABodyThatDeforms) {
  const std::string box = R"(,"colliders":[{"name":"box","shape":"mesh","file":"box.glb","animation":0,
      "motion":[{"time":0},{"time":1,"translate":[0,0,2]}]}])";
  Simulation simulation = play(R"(,"transform":{"translate":[0,1,0]},
      "pins":[{"where":{"top":0},"follow":"box"}])",
                               box, {.moving = swaying_box});
  const Vec3 left = point(simulation, 0, 0), right = point(simulation, 8, 0);
  ASSERT_EQ(left, (Vec3{-0.5F, 1.5F, 0}));
  for (int f = 0; f < 30; ++f) simulation.step();
  const Quat turn = quat_from_euler_deg({0, 45, 0});
  EXPECT_LT(length(point(simulation, 0, 0) - rotate(turn, left) - Vec3{0, 0.25F, 1}), 1e-5F);
  EXPECT_LT(length(point(simulation, 8, 0) - rotate(turn, right) - Vec3{0, 0.25F, 1}), 1e-5F);
  // The body that is drawn is the one that collides.
  const Collider body = simulation.colliders().at(0);
  EXPECT_NEAR(signed_distance(body, {0, 2.25F, 1}), 1, 0.05);
  EXPECT_NEAR(signed_distance(body, {0, 0.95F, 1}), -0.3, 0.05);
}

// A waistband that turned on a walking body was flung from it: it turned about where the body had begun.
TEST_F(PlayingBodies, PinsTurnAboutWhereTheBodyHasTakenThem) {
  const auto walking_box = [](const SceneMesh& mesh) {
    MovingBody body = swaying_box(mesh);
    body.positions_at = [first = body.positions_at(0)](double time) {
      std::vector<Vec3> position = first;
      for (Vec3& p : position) p.z += 2 * static_cast<float>(time);
      return position;
    };
    return body;
  };
  const Vec3 left{-0.5F, 1.5F, 0}, half_way{0, 1.5F, 0};
  for (const auto& [pivot, center] : {std::pair{"", half_way}, std::pair{R"("pivot":[-0.5,1.5,0],)", left}}) {
    Simulation simulation =
        play(std::string(R"(,"transform":{"translate":[0,1,0]},"pins":[{"where":{"top":0},)") + pivot +
                 R"("follow":"box","motion":[{"time":0},{"time":0.5,"rotate_deg":[0,90,0]}]}])",
             R"(,"colliders":[{"name":"box","shape":"mesh","file":"box.glb","animation":0}])", {.moving = walking_box});
    for (int f = 0; f < 30; ++f) simulation.step();
    const Quat turn = quat_from_euler_deg({0, 90, 0});
    EXPECT_LT(length(point(simulation, 0, 0) - (center + rotate(turn, left - center) + Vec3{0, 0, 1})), 1e-5F) << pivot;
  }
}

// A garment of a character moves as its rig says where it is held, whatever else is near.
TEST_F(PlayingBodies, PinsRideOnTheSkinOfTheirCloth) {
  const std::string skin = R"(,"transform":{"translate":[0,1,0]},"skin":{"file":"box.glb","animation":0,
      "transform":{"translate":[0,-1,0]}},"pins":[{"where":{"top":0},"follow":"skin"}],
      "motion":[{"time":0,"translate":[3,0,0]},{"time":1,"translate":[3,0,2]}])";
  Simulation simulation = play(skin, "", {.moving = swaying_box});
  EXPECT_TRUE(simulation.colliders().empty());
  const Vec3 left = point(simulation, 0, 0);
  ASSERT_LT(length(left - Vec3{2.5F, 1.5F, 0}), 1e-6F);
  for (int f = 0; f < 30; ++f) simulation.step();
  const Vec3 expected = rotate(quat_from_euler_deg({0, 45, 0}), left - Vec3{3, 0, 0}) + Vec3{3, 0.25F, 1};
  EXPECT_LT(length(point(simulation, 0, 0) - expected), 1e-5F);
}

// A body that bends: each point begins where its own triangle has come to, and is held there.
TEST_F(PlayingBodies, ClothBeginsAsItsSkinStands) {
  const auto bent = [](const SceneMesh& mesh) {
    MovingBody body = swaying_box(mesh);
    body.as_opened = body.positions_at(0);
    body.positions_at = [from = body.positions_at](double time) { return from(time + 0.5); };
    return body;
  };
  // The sheet lies on the box's front side.
  const std::string skin = R"(,"skin":{"file":"box.glb","animation":0,"transform":{"translate":[0,0,-1]}},
      "pins":[{"where":{"top":1},"follow":"skin"}])";
  Simulation simulation = play(skin, "", {.moving = bent});
  const std::vector<Vec3> front = swaying_box({}).positions_at(0.5);
  const auto corner = [&](size_t k) { return front[k] - Vec3{0, 0, 1}; };
  const std::vector<Vec3> begins = test::positions_of(simulation.solver());
  for (uint32_t j = 0; j < sheet_.ny; ++j) {
    for (uint32_t i = 0; i < sheet_.nx; ++i) {
      const uint32_t pixel = test::sheet_pixel(sheet_, i, j);
      const Vec3 p = simulation.cloths()[0].asset->rest_position[pixel];
      const float x = 0.5F * (p.x + 1), y = 0.5F * (p.y + 1);
      const Vec3 expected = x + y <= 1
                                ? corner(4) + x * (corner(5) - corner(4)) + y * (corner(6) - corner(4))
                                : corner(7) + (1 - x) * (corner(6) - corner(7)) + (1 - y) * (corner(5) - corner(7));
      EXPECT_LT(length(begins[pixel] - expected), 1e-5F) << i << ' ' << j;
      EXPECT_GT(length(begins[pixel] - p), 0.02F);
    }
  }
  EXPECT_LT(simulation.farthest_from_skin(0), 1e-5F);
  simulation.step();  // the skin goes on by a sixtieth of a second
  const std::vector<Vec3> next = test::positions_of(simulation.solver());
  for (size_t k = 0; k < next.size(); ++k) EXPECT_LT(length(next[k] - begins[k]), 0.06F) << k;
}

TEST_F(PlayingBodies, ClothOfASkinThatStandsAsTheFileOpensStaysWhereItIs) {
  const auto still = [](const SceneMesh& mesh) {
    MovingBody body = swaying_box(mesh);
    body.as_opened = body.positions_at(0);
    return body;
  };
  const std::string skin = R"(,"skin":{"file":"box.glb","animation":0},"pins":[{"where":{"top":0},"follow":"skin"}])";
  Simulation simulation = play(skin, "", {.moving = still});
  const std::vector<Vec3> begins = test::positions_of(simulation.solver());
  EXPECT_EQ(begins, simulation.cloths()[0].asset->rest_position);
}

// A skirt's skin goes backwards into the legs' way; what the cloth may not get behind turns with it.
TEST_F(PlayingBodies, ClothStaysInFrontOfItsSkin) {
  constexpr float kAside = 0.1F;  // [m] at most, and that much lower by the ball's curvature
  const auto turning = [](const SceneMesh& mesh) {
    MovingBody body = swaying_box(mesh);
    body.positions_at = [at_rest = body.positions_at(0)](double time) {
      std::vector<Vec3> position = at_rest;
      for (Vec3& p : position) p = rotate(quat_from_euler_deg({0, 90 * static_cast<float>(time), 0}), p);
      return position;
    };
    return body;
  };
  // The sheet lies on the box's front side; it is blown backwards.
  const auto deepest = [&](const std::string& backstop) {
    const std::string skin = R"(,"transform":{"translate":[0,0,1]},"skin":{"file":"box.glb","animation":0,
        "transform":{"translate":[0,0,-1]}},"pins":[{"where":{"top":1},"follow":"skin","max_distance":0.1)" +
                             backstop + "}]";
    Simulation simulation = play(skin, R"(,"gravity":[0,0,-20])", {.moving = turning});
    float depth = 0, shallowest = 1;
    for (int f = 1; f <= 30; ++f) {
      simulation.step();
      const Vec3 normal = rotate(quat_from_euler_deg({0, 1.5F * static_cast<float>(f), 0}), {0, 0, 1});
      for (const Vec3& p : test::positions_of(simulation.solver())) {
        depth = std::max(depth, 1 - dot(p, normal));
        if (f == 30) shallowest = std::min(shallowest, 1 - dot(p, normal));
      }
    }
    return std::pair(depth, shallowest);
  };
  EXPECT_GT(deepest("").first, 0.09F);
  EXPECT_LT(deepest(R"(,"backstop":0.02)").first, 0.02F + kAside * kAside / (2 * 0.5F) + 2e-3F);
  EXPECT_GT(deepest(R"(,"backstop":0.02)").second, 0) << "nothing was blown backwards: the test shows nothing";
  EXPECT_NEAR(deepest(R"(,"backstop":{"distance":0.05,"radius":100})").first, 0.05F, 2e-3F);
}

TEST_F(PlayingBodies, ABackstopWantsASurfaceAndADistance) {
  const auto said = [&](const std::string& pin) -> std::string {
    try {
      play(R"(,"pins":[{"where":{"top":1})" + pin + "}]", "", {.moving = swaying_box});
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(said(R"(,"backstop":0.01)"), HasSubstr("cloths[0].pins[0].backstop: is for points that are free"));
  EXPECT_THAT(said(R"(,"max_distance":0.1,"backstop":0.01)"),
              HasSubstr("cloths[0].pins[0].backstop: has no surface to be behind"));
  EXPECT_THAT(said(R"(,"max_distance":0.1,"backstop":-0.01)"), HasSubstr("cloths[0].pins[0].backstop: must be from 0"));
  EXPECT_THAT(said(R"(,"max_distance":0.1,"backstop":{"distance":0,"radius":0})"),
              HasSubstr("cloths[0].pins[0].backstop.radius"));
  const auto back = [&](const std::string& backstop) {
    return said(R"(,"max_distance":0.1,"backstop":{)" + backstop + "}");
  };
  EXPECT_THAT(back(R"("radius":1)"), HasSubstr("backstop: must be a number, or have distance, or painted and most"));
  EXPECT_THAT(back(R"("distance":0.1,"painted":"red","most":0.2)"), HasSubstr("backstop: must be a number, or have"));
  EXPECT_THAT(back(R"("distance":0.1,"most":0.2)"), HasSubstr("backstop.most: goes with painted"));
  EXPECT_THAT(back(R"("painted":"red","most":101)"), HasSubstr("backstop.most: must be from 0"));
}

// A coat lies close on the chest and may sink into padding at the hips: one number for all would have it pass one.
TEST_F(PlayingBodies, HowFarBehindItsSkinMayBePainted) {
  constexpr float kMost = 0.08F;  // [m]
  ClothAsset asset = test::make_sheet(sheet_);
  asset.paint.resize(asset.source.source_vertex_count);
  const auto column = [&](uint32_t v) { return static_cast<float>(v % sheet_.nx) / static_cast<float>(sheet_.nx - 1); };
  for (uint32_t v = 0; v < asset.paint.size(); ++v) asset.paint[v] = {0, static_cast<uint8_t>(255 * column(v))};
  write_asset(asset, folder_ / "sheet.glb");
  const std::string skin = R"(,"transform":{"translate":[0,0,1]},"skin":{"file":"box.glb","animation":0,
      "transform":{"translate":[0,0,-1]}},"pins":[{"where":{"top":1},"follow":"skin","max_distance":0.2,
      "backstop":{"painted":"green","most":0.08,"radius":100}}])";
  const auto still = [](const SceneMesh& mesh) {
    MovingBody body = swaying_box(mesh);
    body.positions_at = [at_rest = body.positions_at(0)](double) { return at_rest; };
    return body;
  };
  Simulation simulation = play(skin, R"(,"gravity":[0,0,-40])", {.moving = still});
  for (int f = 0; f < 60; ++f) simulation.step();
  for (uint32_t j = 0; j < sheet_.ny; ++j) {
    for (uint32_t i = 0; i < sheet_.nx; ++i) {
      const float allowed = kMost * column(i), depth = 1 - point(simulation, i, j).z;
      EXPECT_LT(depth, allowed + 2e-3F) << i << ' ' << j;
      EXPECT_GT(depth, 0.7F * allowed - 5e-3F) << i << ' ' << j;
    }
  }
}

// They are taken where they are then, on the body as it is then.
TEST_F(PlayingBodies, PinsThatTakeHoldLaterRideFromThere) {
  const std::string box = R"(,"gravity":[0,0,0],"colliders":[{"name":"box","shape":"mesh","file":"box.glb",
      "animation":0}])";
  Simulation simulation = play(R"(,"transform":{"translate":[0,2.2,0]},
      "pins":[{"where":{"top":0},"follow":"box","from":0.5}])",
                               box, {.moving = swaying_box});
  for (int f = 0; f < 30; ++f) simulation.step();
  const Vec3 before = point(simulation, 0, 0);
  for (int f = 0; f < 15; ++f) simulation.step();
  const Vec3 expected = rotate(quat_from_euler_deg({0, 22.5F, 0}), before) + Vec3{0, 0.125F, 0};
  EXPECT_LT(length(point(simulation, 0, 0) - expected), 1e-5F);
}

TEST_F(PlayingBodies, BodiesThatCannotBePlayedAreRefused) {
  const std::string box = R"(,"colliders":[{"shape":"mesh","file":"box.glb","animation":0}])";
  const auto said = [&](const ReadMovingBody& moving, const std::string& cloth,
                        const std::string& rest) -> std::string {
    try {
      Simulation simulation = play(cloth, rest, {.moving = moving});
      for (int f = 0; f < 3; ++f) simulation.step();
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_EQ(said(swaying_box, "", box), "nothing");
  EXPECT_THAT(said({}, "", box), HasSubstr("scene.json: colliders[0]: this program reads no animations"));
  const std::string skin = R"(,"skin":{"file":"box.glb","animation":0})";
  EXPECT_THAT(said({}, skin, ""), HasSubstr("scene.json: cloths[0].skin: this program reads no animations"));
  const auto changed = [](const auto& change) {
    return [change](const SceneMesh& mesh) {
      MovingBody body = swaying_box(mesh);
      body.positions_at = [change, at = body.positions_at](double time) {
        std::vector<Vec3> position = at(time);
        change(position, time);
        return position;
      };
      return body;
    };
  };
  const auto nowhere = changed([](std::vector<Vec3>& p, double time) {
    if (time > 0.02) p[3].x = std::nanf("");
  });
  EXPECT_THAT(said(nowhere, "", box), AllOf(HasSubstr("colliders[0]: at 0.0333333 s: vertex 3"), HasSubstr("finite")));
  EXPECT_THAT(said(nowhere, skin, ""), HasSubstr("cloths[0].skin: at 0.0333333 s: vertex 3"));
  const auto fewer = changed([](std::vector<Vec3>& p, double time) { p.resize(time > 0 ? 5 : 8); });
  EXPECT_THAT(said(fewer, "", box), HasSubstr("the number of its vertices changes"));
  const auto short_of = changed([](std::vector<Vec3>& p, double) { p.resize(5); });
  EXPECT_THAT(said(short_of, "", box), HasSubstr("colliders[0]: a triangle refers to a vertex that does not exist"));
  const auto huge = changed([](std::vector<Vec3>& p, double time) {
    for (Vec3& x : p) x = (time > 0 ? 1e4F : 1.F) * x;
  });
  EXPECT_THAT(said(huge, "", box), HasSubstr("the body of a collider is too large for nodes"));
}

// One that a caller makes of an asset's garment cannot be taken apart.
TEST_F(PlayingBodies, PartsOfAnAssetAreRefused) {
  EXPECT_THROW(static_cast<void>(read_asset_surface({.file = folder_ / "sheet.glb", .parts = "1"})), Error);
  EXPECT_EQ(read_asset_surface({.file = folder_ / "sheet.glb"}).triangle.size(), 128U);
}

}  // namespace
}  // namespace geocloth
