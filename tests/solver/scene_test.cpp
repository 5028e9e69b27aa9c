// SPDX-License-Identifier: GPL-3.0-or-later
// A scene file says what it means or why it does not work: which key, where, and what would be right.

#include "geocloth/solver/scene.h"

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <numeric>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "geocloth/asset/asset_file.h"
#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/temporary_folder.h"

namespace geocloth {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kFull = R"({ "version": 1, "frame_rate": 30, "frames": 10, "substeps": 8, "relaxation_steps": 2,
  "gravity": [0, -1, 0],
  "cloths": [ { "asset": "shirt.glb",
    "material": { "areal_density": 0.3, "stretch_warp": 500, "stretch_weft": 400, "shear": 30, "bend_warp": 2e-5,
                  "bend_weft": 1e-5, "damping": 0.5, "thickness": 0.004, "friction": 0.2, "max_speed": 9,
                  "max_stretch": 0.05, "stiffness": 0.9, "bend_stiffness": 0.1, "verlet_damping": 0.99 },
    "transform": { "translate": [0, 1, 0], "rotate_deg": [0, 90, 0], "scale": 2 },
    "inertia_scale": [1, 1, 1], "gravity_scale": -0.5, "wind_scale": 0.25, "motion": [ { "time": 0, "translate": [0, 0, 0], "rotate_deg": [0, 0, 0] } ],
    "pins": [ { "where": { "top": 0.02 }, "follow": "cloth" }, { "where": { "boundary": 1 }, "follow": "world" },
              { "where": { "boundary": "highest" }, "follow": "ball", "motion": [ { "time": 1, "translate": [0, 1, 0] } ] },
              { "where": { "box": [[0, 0, 0], [1, 1, 1]] } }, { "where": { "sphere": { "center": [0, 0, 0], "radius": 1 } } },
              { "where": { "vertices": [1, 2] } }, { "where": { "vertex_group": "hem" } },
              { "where": { "material": "denim" } } ],
    "fabrics": [ { "where": { "top": 0.1 }, "width": 0.2, "material": { "bend_warp": 1e-3, "motion": [ { "time": 1 } ] } } ],
    "cuts": [], "self_collision": false } ],
  "colliders": [ { "shape": "plane", "point": [0, 0, 0], "normal": [0, 2, 0] },
    { "name": "ball", "shape": "sphere", "center": [0, 1, 0], "radius": 0.2, "friction": 0.7,
      "motion": [ { "time": 0, "translate": [0, 0, 0] }, { "time": 2, "translate": [1, 0, 0], "rotate_deg": [0, 180, 0] } ] },
    { "shape": "capsule", "a": [0, 0, 0], "b": [0, 1, 0], "radius": 0.2, "radius_b": 0.1 },
    { "shape": "box", "center": [0, 1, 0], "half_extents": [1, 2, 3], "rotate_deg": [0, 0, 45] },
    { "shape": "ellipsoid", "center": [0, 1, 0], "radii": [1, 2, 3], "rotate_deg": [0, 0, 45] } ],
  "wind": { "velocity": [1, 0, 0], "turbulence": 0.3, "frequency": 2, "drag": 1.5, "lift": 0.1 } })";

TEST(Scene, EveryKeyIsRead) {
  const Scene scene = parse_scene(kFull, "folder/scene.json");
  EXPECT_EQ(scene.frame_rate, 30);
  EXPECT_EQ(scene.frames, 10U);
  EXPECT_EQ(scene.substeps, 8U);
  EXPECT_EQ(scene.relaxation_steps, 2U);
  EXPECT_EQ(scene.gravity, (Vec3{0, -1, 0}));
  ASSERT_EQ(scene.cloths.size(), 1U);
  const SceneCloth& cloth = scene.cloths[0];
  EXPECT_EQ(cloth.asset, std::filesystem::path("folder/shirt.glb"));
  EXPECT_EQ(cloth.gravity_scale, -0.5F);
  EXPECT_EQ(cloth.wind_scale, 0.25F);
  EXPECT_EQ(gravity_of(scene, cloth), (Vec3{0, 0.5F, 0}));
  EXPECT_EQ(cloth.material.areal_density, 0.3F);
  EXPECT_EQ(cloth.material.verlet_damping, 0.99F);
  EXPECT_EQ(cloth.transform.scale, 2);
  ASSERT_EQ(cloth.fabrics.size(), 1U);
  EXPECT_EQ(cloth.fabrics[0].width, 0.2F);
  EXPECT_EQ(cloth.fabrics[0].material.bend_warp, 1e-3F);
  EXPECT_EQ(cloth.fabrics[0].material.shear, 30);
  ASSERT_EQ(cloth.pins.size(), 8U);
  EXPECT_EQ(std::get<WhereMaterial>(cloth.pins[7].where).name, "denim");
  EXPECT_EQ(cloth.pins[2].follow, "ball");
  EXPECT_EQ(std::get<WhereBoundary>(cloth.pins[1].where).index, 1U);
  EXPECT_FALSE(std::get<WhereBoundary>(cloth.pins[2].where).index);
  ASSERT_EQ(scene.colliders.size(), 5U);
  EXPECT_EQ(std::get<Plane>(scene.colliders[0].collider.shape).normal, (Vec3{0, 1, 0}));
  EXPECT_EQ(std::get<Capsule>(scene.colliders[2].collider.shape).radius_b, 0.1F);
  ASSERT_TRUE(scene.wind);
  EXPECT_EQ(scene.wind->drag, 1.5F);
}

TEST(Scene, ColliderTurnsAboutItsOwnCentre) {
  const Scene scene = parse_scene(kFull, "scene.json");
  EXPECT_NEAR(signed_distance(collider_at(scene.colliders[1], 2), {1, 1, 0}), -0.2, 1e-6);
  EXPECT_NEAR(signed_distance(collider_at(scene.colliders[1], 1), {0.5F, 1, 0}), -0.2, 1e-6);
}

// An arm turns at its shoulder, not about its middle.
TEST(Scene, WhatHasAPivotTurnsAboutIt) {
  const Scene scene = parse_scene(
      R"({"version":1,"cloths":[{"asset":"a.glb"}],"colliders":[
      {"shape":"capsule","a":[1,2,0],"b":[3,2,0],"radius":0.5,"pivot":[1,2,0],
       "motion":[{"time":0},{"time":1,"translate":[0,0,1],"rotate_deg":[0,0,90]}]}]})",
      "s.json");
  const auto distance = [&](double time, const Vec3& point) {
    return signed_distance(collider_at(scene.colliders[0], time), point);
  };
  EXPECT_NEAR(distance(0, {3, 2, 0}), -0.5, 1e-5);
  EXPECT_NEAR(distance(1, {1, 2, 1}), -0.5, 1e-5);
  EXPECT_NEAR(distance(1, {1, 4, 1}), -0.5, 1e-5);
  const float half = std::sqrt(2.F);
  EXPECT_NEAR(distance(0.5, {1 + half, 2 + half, 0.5F}), -0.5, 1e-5);
}

constexpr const char* kTurning = R"({ "version": 1, "cloths": [ { "asset": "a.glb" } ], "colliders": [
    { "shape": "box", "center": [0, 1, 0], "half_extents": [0.5, 0.1, 0.1], "motion": [ KEYS ] } ] })";

/// Where a turning box has the middle of its right-hand side (+x) at a time, relative to its centre.
Vec3 right_side_at(const std::string& keys, double time) {
  const Scene scene = parse_scene(std::string(kTurning).replace(std::string(kTurning).find("KEYS"), 4, keys), "s.json");
  return apply(collider_at(scene.colliders[0], time).pose, {0.5F, 1, 0}) - Vec3{0, 1, 0};
}

// Who writes 0 to 360 wants a turn: by the short way the box stood still.
TEST(Scene, WholeTurnsAreTurned) {
  const float d = std::sqrt(0.125F);
  const std::string turn = R"({ "time": 1 }, { "time": 3, "rotate_deg": [0, 360, 0] })";
  EXPECT_LT(length(right_side_at(turn, 1.5) - Vec3{0, 0, -0.5F}), 1e-6F);
  EXPECT_LT(length(right_side_at(turn, 2) - Vec3{-0.5F, 0, 0}), 1e-6F);
  EXPECT_LT(length(right_side_at(turn, 2.5) - Vec3{0, 0, 0.5F}), 1e-6F);
  const std::string back = R"({ "time": 0, "rotate_deg": [0, 0, 90] }, { "time": 2, "rotate_deg": [0, 0, -630] })";
  EXPECT_LT(length(right_side_at(back, 0.25) - Vec3{0.5F, 0, 0}), 1e-6F);
  EXPECT_LT(length(right_side_at(back, 0.375) - Vec3{d, -d, 0}), 1e-6F);
  EXPECT_LT(length(right_side_at(back, 1) - Vec3{0, 0.5F, 0}), 1e-6F);
  // Half a turn goes the way it is written.
  EXPECT_LT(right_side_at(R"({ "time": 0 }, { "time": 1, "rotate_deg": [0, 180, 0] })", 0.5).z, -0.499F);
  EXPECT_GT(right_side_at(R"({ "time": 0 }, { "time": 1, "rotate_deg": [0, -180, 0] })", 0.5).z, 0.499F);
}

// A drill makes hundreds of turns between two keys; its rim must not tremble.
TEST(Scene, ManyTurnsAreEven) {
  const std::string keys = R"({ "time": 0 }, { "time": 100, "rotate_deg": [0, 72000, 0] })";
  for (int f = 0; f < 600; ++f) {
    const double angle = f * 12 * std::numbers::pi / 180;
    const Vec3 place{static_cast<float>(0.5 * std::cos(angle)), 0, static_cast<float>(-0.5 * std::sin(angle))};
    ASSERT_LT(length(right_side_at(keys, 90 + f / 60.0) - place), 1e-6F) << f;
  }
}

// Exported angles jump from 180 to -180 between two frames: nothing turns back there.
TEST(Scene, BakedAnglesMayJump) {
  const std::string keys =
      R"({ "time": 0, "rotate_deg": [0, 179, 0] }, { "time": 0.0416667, "rotate_deg": [0, -179, 0] })";
  EXPECT_LT(length(right_side_at(keys, 0.0208333) - Vec3{-0.5F, 0, 0}), 1e-5F);
}

// In doubles 0.3 - 0.2 is less than 0.1: one pair of even keys was taken for baked ones, and turned back.
TEST(Scene, KeysATenthOfASecondApartAreNotBaked) {
  const std::string keys = R"({ "time": 0.2, "rotate_deg": [0, 540, 0] }, { "time": 0.3, "rotate_deg": [0, 810, 0] })";
  EXPECT_LT(length(right_side_at(keys, 0.2 + 1.0 / 30) - Vec3{0, 0, 0.5F}), 1e-5F);  // 630 degrees
}

TEST(Scene, PresetsAreNamed) {
  const Scene scene = parse_scene(R"({"version":1,"cloths":[{"asset":"a.glb","material":"denim"}]})", "s.json");
  EXPECT_EQ(scene.cloths[0].material.areal_density, find_material_preset("denim")->material.areal_density);
  EXPECT_FALSE(scene.wind);
  for (const MaterialPreset& preset : material_presets()) EXPECT_FALSE(preset.source.empty());
}

// Two characters, each with a body, and a floor for both; a third cloth meets nothing.
TEST(Scene, ClothsMeetTheCollidersThatTheyName) {
  const Scene scene = parse_scene(R"({ "version": 1, "cloths": [ { "asset": "a.glb", "ignores": ["body 2"] },
      { "asset": "b.glb", "collides_with": ["floor", "body 2"] }, { "asset": "c.glb", "collides_with": [] } ],
    "colliders": [ { "shape": "sphere", "name": "body 1", "center": [0, 0, 0], "radius": 1 },
      { "shape": "sphere", "name": "body 2", "center": [0, 0, 0], "radius": 1 },
      { "shape": "plane", "name": "floor", "point": [0, 0, 0], "normal": [0, 1, 0] },
      { "shape": "sphere", "center": [0, 0, 0], "radius": 1 } ] })",
                                  "scene.json");
  const std::vector<std::vector<bool>> expected{
      {true, false, true, true}, {false, true, true, false}, {false, false, false, false}};
  for (size_t c = 0; c < expected.size(); ++c)
    for (size_t i = 0; i < scene.colliders.size(); ++i)
      EXPECT_EQ((scene.cloths[c].meets & scene.colliders[i].collider.groups) != 0, expected[c][i]) << c << " " << i;
  const Scene plain = parse_scene(kFull, "scene.json");
  EXPECT_EQ(plain.cloths[0].meets, ~0U);
}

TEST(Scene, AsManyGroupsAsThereAreBits) {
  const auto characters = [](int count) {
    std::string cloths, colliders;
    for (int i = 0; i < count; ++i) {
      const std::string comma = i > 0 ? "," : "", name = "body " + std::to_string(i);
      cloths += comma + R"({ "asset": "a.glb", "collides_with": [")" + name + "\"] }";
      colliders += comma + R"({ "shape": "sphere", "name": ")" + name + R"(", "center": [0, 0, 0], "radius": 1 })";
    }
    return R"({ "version": 1, "cloths": [)" + cloths + R"(], "colliders": [)" + colliders + "] }";
  };
  EXPECT_EQ(parse_scene(characters(32), "scene.json").cloths[31].meets, 1U << 31U);
  try {
    static_cast<void>(parse_scene(characters(33), "scene.json"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::limit);
    EXPECT_THAT(error.what(), HasSubstr("scene.json: colliders: the cloths part these into more than 32 groups"));
  }
}

TEST(Scene, WindIsLinearBetweenItsKeys) {
  const Scene scene =
      parse_scene(R"({"version":1,"cloths":[{"asset":"a.glb"}],"wind":{"velocity":[1,2,3],"turbulence":0.5,
      "drag":2,"motion":[{"time":1},{"time":3,"velocity":[5,2,3],"turbulence":0.1},{"time":4,"velocity":[0,0,0]}]}})",
                  "s.json");
  ASSERT_EQ(scene.wind_motion.size(), 3U);
  for (const double early : {0.0, 1.0}) EXPECT_EQ(wind_at(scene, early), *scene.wind);
  EXPECT_EQ(wind_at(scene, 2).velocity, (Vec3{3, 2, 3}));
  EXPECT_FLOAT_EQ(wind_at(scene, 2).turbulence, 0.3F);
  EXPECT_EQ(wind_at(scene, 2).drag, 2);
  EXPECT_EQ(wind_at(scene, 3).turbulence, 0.1F);
  EXPECT_EQ(wind_at(scene, 9).velocity, Vec3{});
  EXPECT_EQ(wind_at(scene, 9).turbulence, 0.5F);
}

TEST(Scene, AFabricIsTheClothsMaterialButForWhatItSays) {
  const Scene scene = parse_scene(
      R"({"version":1,"cloths":[{"asset":"a.glb","material":"denim","fabrics":[
      {"where":{"top":0.1},"material":{"bend_warp":1,"motion":[{"time":0},{"time":2,"bend_warp":100}]}},
      {"where":{"boundary":0},"material":"cotton"}]}]})",
      "s.json");
  const std::vector<SceneFabric>& fabrics = scene.cloths[0].fabrics;
  ASSERT_EQ(fabrics.size(), 2U);
  Material stiff = find_material_preset("denim")->material;
  stiff.bend_warp = 1;
  EXPECT_TRUE(fabrics[0].material == stiff);
  stiff.bend_warp = 10;
  EXPECT_TRUE(material_at(fabrics[0], 1) == stiff);
  EXPECT_TRUE(material_at(fabrics[1], 1) == find_material_preset("cotton")->material);
  EXPECT_TRUE(std::holds_alternative<WhereBoundary>(fabrics[1].where));
}

// A sail of nylon that gets wet and stiff, and is a preset in the end; what a key does not say is as outside.
TEST(Scene, AMaterialIsInProportionBetweenItsKeys) {
  const Scene scene = parse_scene(
      R"({"version":1,"cloths":[{"asset":"a.glb","material":{"preset":"jet_set","bend_bias":0,"friction":0.5,
      "motion":[{"time":1},{"time":3,"stretch_warp":100,"shear":0},{"time":4,"preset":"denim","max_stretch":0.1}]}}]})",
      "s.json");
  const SceneCloth& cloth = scene.cloths[0];
  const Material jet_set = find_material_preset("jet_set")->material;
  Material dry = jet_set, denim = find_material_preset("denim")->material;
  dry.bend_bias = 0;
  dry.friction = 0.5F;
  denim.max_stretch = 0.1F;
  EXPECT_TRUE(cloth.material == dry);
  for (const double early : {0.0, 1.0}) EXPECT_TRUE(material_at(cloth, early) == dry) << early;
  EXPECT_TRUE(material_at(cloth, 4) == denim);
  EXPECT_TRUE(material_at(cloth, 9) == denim);
  EXPECT_FLOAT_EQ(material_at(cloth, 2).stretch_warp, std::sqrt(100 * dry.stretch_warp));
  EXPECT_FLOAT_EQ(material_at(cloth, 2).shear, 0.5F * dry.shear);
  EXPECT_EQ(material_at(cloth, 2).stretch_weft, dry.stretch_weft);
  EXPECT_EQ(material_at(cloth, 3.9).max_stretch, dry.max_stretch) << "automatic until the end";
  EXPECT_EQ(material_at(cloth, 3.9).bend_bias, 0);
  SceneCloth steady;
  steady.material = denim;
  EXPECT_TRUE(material_at(steady, 2) == denim);
}

// What lies between two materials is one that the solver takes: stiffness that comes out of nothing begins as none.
TEST(Materials, BetweenTwoThereIsNoneThatIsRefused) {
  Material none, some;
  none.shear = none.bend_warp = none.bend_weft = none.bend_bias = 0;
  some.shear = 2e-9F;
  some.bend_warp = 2e-12F;
  some.max_speed = 3;
  EXPECT_EQ(mix(none, some, 0.25F).shear, 0);
  EXPECT_EQ(mix(none, some, 0.25F).bend_warp, 0);
  EXPECT_FLOAT_EQ(mix(none, some, 0.75F).bend_warp, 1.5e-12F);
  EXPECT_EQ(mix(none, some, 0.75F).max_speed, 0) << "no limit is not a low one";
  EXPECT_TRUE(mix(none, some, 1) == some);
  EXPECT_TRUE(mix(none, some, 2) == some);
  EXPECT_TRUE(mix(none, some, -1) == none);
  EXPECT_TRUE(mix(none, some, std::numeric_limits<float>::quiet_NaN()) == none);
}

TEST(Scene, SewingIsAsItIsSaidOrWithinTheFirstSecond) {
  const auto sewing_of = [](const std::string& key) {
    return parse_scene("{\"version\":1,\"cloths\":[{\"asset\":\"a.glb\"" + key + "}]}", "s.json").cloths[0].sewing;
  };
  EXPECT_EQ(sewing_of("").value().duration, 1);
  EXPECT_EQ(sewing_of(", \"sewing\": true").value().start, 0);
  EXPECT_FALSE(sewing_of(", \"sewing\": false"));
  const SceneSewing told = sewing_of(R"(, "sewing": {"start": 0.5, "duration": 0, "weightless": false})").value();
  EXPECT_EQ(told.start, 0.5);
  EXPECT_EQ(told.duration, 0);
  EXPECT_FALSE(told.weightless);
}

TEST(Scene, APressureIsLinearBetweenItsKeys) {
  const Scene scene = parse_scene(R"({"version":1,"cloths":[{"asset":"a.glb","pressure":[{"time":1,"pressure":2},
      {"time":2,"pressure":-4}]}]})",
                                  "s.json");
  const SceneCloth& cloth = scene.cloths[0];
  EXPECT_EQ(pressure_at(cloth, 0), 2);
  EXPECT_EQ(pressure_at(cloth, 1.5), -1);
  EXPECT_EQ(pressure_at(cloth, 5), -4);
}

struct BadScene {
  const char* name;
  const char* find;  ///< in the full scene
  const char* replace;
  const char* message;  ///< part of what must be said
};

class BadScenes : public ::testing::TestWithParam<BadScene> {};

TEST_P(BadScenes, NameTheirPathAndTheRemedy) {
  std::string text = kFull;
  const size_t at = text.find(GetParam().find);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().find).size(), GetParam().replace);
  try {
    const Scene scene = parse_scene(text, "scene.json");
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("scene.json"), HasSubstr(GetParam().message)));
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_EQ(message.find("scene.json"), message.rfind("scene.json")) << message;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, BadScenes,
    ::testing::Values(
        BadScene{"UnknownKey", "\"substeps\"", "\"substep\"",
                 "unknown key \"substep\"; the nearest known one is \"substeps\""},
        BadScene{"UnknownMaterialKey", "\"areal_density\"", "\"density\"",
                 "cloths[0].material: unknown key \"density\""},
        BadScene{"WrongType", "\"frames\": 10", "\"frames\": \"10\"", "frames: must be a number, not string"},
        BadScene{"NotWhole", "\"frames\": 10", "\"frames\": 1.5", "frames: must be a whole number"},
        BadScene{"TooMany", "\"substeps\": 8", "\"substeps\": 257", "substeps: must be a whole number from 1 to 256"},
        BadScene{"ShortVector", "\"gravity\": [0, -1, 0]", "\"gravity\": [0, -1]", "gravity: must be three numbers"},
        BadScene{"HugeGravity", "\"gravity\": [0, -1, 0]", "\"gravity\": [0, -1e30, 0]", "gravity"},
        BadScene{"NoAsset", "\"asset\": \"shirt.glb\",", "", "cloths[0]: the key \"asset\" is missing"},
        BadScene{"NegativeRadius", "\"radius\": 0.2, \"friction\": 0.7", "\"radius\": -0.2", "radius is -0.2"},
        BadScene{"NegativeDensity", "\"areal_density\": 0.3", "\"areal_density\": 0", "areal_density is 0"},
        BadScene{"ShareAboveOne", "\"stiffness\": 0.9", "\"stiffness\": 1.5", "stiffness: must be from 0"},
        BadScene{"NoDirection", "\"normal\": [0, 2, 0]", "\"normal\": [0, 0, 0]",
                 "colliders[0].normal: must have a direction"},
        BadScene{"UnknownShape", "\"shape\": \"box\"", "\"shape\": \"bx\"", "the nearest is \"box\", all are plane"},
        BadScene{"TwoSelectors", "{ \"top\": 0.02 }", "{ \"top\": 0.02, \"boundary\": 0 }", "exactly one of"},
        BadScene{"NoSuchFollow", "\"follow\": \"ball\"", "\"follow\": \"bell\"",
                 "the nearest is \"ball\", all are cloth, world, ball"},
        BadScene{"NameTwice", "\"shape\": \"capsule\"", "\"name\": \"ball\", \"shape\": \"capsule\"",
                 "the name \"ball\" is taken"},
        BadScene{"TimeGoesBack", "\"time\": 2", "\"time\": -2", "must be later than the key before"},
        BadScene{"Version", "\"version\": 1", "\"version\": 2", "only version 1"},
        BadScene{"SelfCollision", "\"self_collision\": false", "\"self_collision\": 1", "self_collision: must be"},
        BadScene{"InterCollision", "\"self_collision\": false", "\"inter_collision\": 1", "inter_collision: must be"},
        BadScene{"IgnoresNobody", "\"self_collision\": false", "\"ignores\": [\"bell\"]",
                 "cloths[0].ignores[0]: there is no collider \"bell\"; the nearest is \"ball\""},
        BadScene{"IgnoresAndCollides", "\"self_collision\": false", R"("ignores": ["ball"], "collides_with": [])",
                 "cloths[0].ignores: and \"collides_with\" say the same"},
        BadScene{"IgnoresANumber", "\"self_collision\": false", "\"ignores\": [1]", "cloths[0].ignores[0]: must be"},
        BadScene{"SelfDistance", "\"self_collision\": false", "\"self_collision\": { \"distance\": 0 }",
                 "self_collision: distance"},
        BadScene{"NegativeSelfDistance", "\"self_collision\": false", "\"self_collision\": { \"distance\": -0.01 }",
                 "self_collision.distance: must be above 0"},
        BadScene{"BeginningOfAKey", "\"rotate_deg\"", "\"rotate\"", "the nearest known one is \"rotate_deg\""},
        BadScene{"CutWithoutTime", "\"cuts\": []", "\"cuts\": [{}]", "cuts[0]: the key \"time\" is missing"},
        BadScene{"CutTooEarly", "\"cuts\": []", "\"cuts\": [{ \"time\": -1, \"triangle\": [] }]",
                 "cuts[0].time: must be from 0"},
        BadScene{"CutOfTwoCorners", "\"cuts\": []", "\"cuts\": [{ \"time\": 1, \"triangle\": [[0, 0, 0], [1, 0, 0]] }]",
                 "cuts[0].triangle: must be three corners"},
        BadScene{"CutWithoutArea", "\"cuts\": []",
                 "\"cuts\": [{ \"time\": 1, \"triangle\": [[0, 0, 0], [1, 0, 0], [2, 0, 0]] }]",
                 "cuts[0]: the triangle has no area"},
        BadScene{"Inertia", "\"inertia_scale\": [1, 1, 1]", "\"inertia_scale\": [0, 2, 1]", "between 0 and 1"},
        BadScene{"GravityScale", "\"gravity_scale\": -0.5", "\"gravity_scale\": 101",
                 "cloths[0].gravity_scale: gravity_scale is 101; it must be between -100 and 100"},
        BadScene{"WindScale", "\"wind_scale\": 0.25", "\"wind_scale\": -1",
                 "cloths[0].wind_scale: wind_scale is -1; it must be between 0 and 100"},
        BadScene{"Convex", "\"shape\": \"box\"", "\"shape\": \"convex\"", "center"},
        BadScene{"HullOfANumber",
                 "\"shape\": \"box\", \"center\": [0, 1, 0], \"half_extents\": [1, 2, 3], \"rotate_deg\": [0, 0, 45]",
                 "\"shape\": \"convex\", \"points\": [1]", "points[0]: must be an array, not number"},
        BadScene{"NameThatEndsEarly", "shirt.glb", "shirt.glb\\u0000.obj", "asset: must not hold a zero character"},
        BadScene{"NaN", "\"frames\": 10", "\"frames\": NaN", "not valid JSON"},
        BadScene{"Infinite", "\"frame_rate\": 30", "\"frame_rate\": 1e999", "not valid JSON"},
        BadScene{"TwiceTheSameKey", "\"frames\": 10", "\"frames\": 10, \"frames\": 11", "appears twice"},
        BadScene{"Truncated", "\"wind\":", "\"wind\"", "not valid JSON"},
        BadScene{"UnknownPreset", "\"areal_density\": 0.3", "\"preset\": \"coton\"",
                 "no material preset \"coton\"; the nearest is \"cotton\""},
        BadScene{"MisspeltBeginning", "\"stretch_warp\"", "\"streach\"", "nearest known one is \"stretch_warp\""},
        BadScene{"PartOfAKey", "\"areal_density\"", "\"density\"", "nearest known one is \"areal_density\""},
        // No name is better than one that has nothing to do with it.
        BadScene{"ShapeFarFromAll", "\"shape\": \"capsule\"", "\"shape\": \"cylinder\"",
                 "no shape \"cylinder\"; all are plane, sphere, capsule, box"},
        BadScene{
            "KeyFarFromAll", "\"half_extents\"", "\"size\"",
            "unknown key \"size\"; known are name, shape, friction, motion, pivot, center, half_extents, rotate_deg"},
        BadScene{"PresetFarFromAll", "\"areal_density\": 0.3", "\"preset\": \"silk\"", "preset \"silk\"; all are "},
        BadScene{"ScaleOfAMesh",
                 "\"shape\": \"box\", \"center\": [0, 1, 0], \"half_extents\": [1, 2, 3], \"rotate_deg\": [0, 0, 45]",
                 "\"shape\": \"mesh\", \"file\": \"a.obj\", \"scale\": 2",
                 "colliders[3]: \"scale\" belongs into \"transform\""},
        BadScene{"RotationOfACloth", "\"inertia_scale\": [1, 1, 1]", "\"rotate_deg\": [1, 1, 1]",
                 "cloths[0]: \"rotate_deg\" belongs into \"transform\""},
        BadScene{"WindKeyWithoutTime", "\"drag\": 1.5", "\"motion\": [{}]",
                 "wind.motion[0]: the key \"time\" is missing"},
        BadScene{"WindTimeGoesBack", "\"drag\": 1.5", "\"motion\": [{\"time\": 1}, {\"time\": 1}]",
                 "wind.motion[1].time: must be later than the key before"},
        BadScene{"WindKeyOfAPose", "\"drag\": 1.5", "\"motion\": [{\"time\": 1, \"translate\": [0, 0, 0]}]",
                 "wind.motion[0]: unknown key \"translate\"; known are time, velocity, turbulence"},
        BadScene{"WindKeyTooFast", "\"drag\": 1.5", "\"motion\": [{\"time\": 1, \"velocity\": [0, 1e9, 0]}]",
                 "wind.motion[0]: velocity"},
        BadScene{"WindKeyBelowZero", "\"drag\": 1.5", "\"motion\": [{\"time\": 1, \"turbulence\": -1}]",
                 "wind.motion[0]: turbulence"},
        BadScene{"TearsAtRest", "\"transform\"", "\"tear\": 1, \"transform\"",
                 "cloths[0].tear: the stretch that it tears at is 1; it must be"},
        BadScene{"SewingBackwards", "\"transform\"", "\"sewing\": { \"duration\": -1 }, \"transform\"",
                 "cloths[0].sewing.duration: must be from"},
        BadScene{"PressureOutOfRange", "\"transform\"", "\"pressure\": 1e7, \"transform\"",
                 "cloths[0].pressure: must be from -1000000.0 to 1000000.0"},
        BadScene{"PressureKeyOutOfRange", "\"transform\"",
                 "\"pressure\": [{ \"time\": 0, \"pressure\": 1e7 }], \"transform\"",
                 "cloths[0].pressure[0].pressure: must be from"},
        BadScene{"PressureKeyWithoutPressure", "\"transform\"", "\"pressure\": [{ \"time\": 0 }], \"transform\"",
                 "cloths[0].pressure[0]: the key \"pressure\" is missing"},
        BadScene{"MaterialKeyOutOfRange", "\"areal_density\": 0.3", R"("motion": [{ "time": 0, "areal_density": -1 }])",
                 "cloths[0].material.motion[0]: areal_density is -1"},
        BadScene{"MaterialKeyWithoutTime", "\"areal_density\": 0.3", R"("motion": [{ "areal_density": 1 }])",
                 "cloths[0].material.motion[0]: the key \"time\" is missing"},
        BadScene{"MaterialTimeGoesBack", "\"areal_density\": 0.3", R"("motion": [{ "time": 1 }, { "time": 0 }])",
                 "cloths[0].material.motion[1].time: must be later than the key before"},
        BadScene{"MaterialKeyMisspelt", "\"areal_density\": 0.3", R"("motion": [{ "time": 1, "densty": 1 }])",
                 "cloths[0].material.motion[0]: unknown key \"densty\"; known are preset, time"},
        BadScene{"PivotOfNothing", R"("where": { "vertices": [1, 2] })", R"("where": { "top": 1 }, "pivot": [0, 0, 0])",
                 "cloths[0].pins[5].pivot: is what a \"motion\" turns about; there is none"},
        BadScene{"FabricNowhere", R"("where": { "top": 0.1 }, "width")", "\"width\"",
                 "cloths[0].fabrics[0]: the key \"where\" is missing"},
        BadScene{"FabricOfNothing", R"(, "material": { "bend_warp": 1e-3, "motion": [ { "time": 1 } ] })", "",
                 "cloths[0].fabrics[0]: the key \"material\" is missing"},
        BadScene{"FabricOfNegativeWidth", "\"width\": 0.2", "\"width\": -0.2",
                 "cloths[0].fabrics[0].width: must be from"},
        BadScene{"FabricWithFriction", "\"bend_warp\": 1e-3", "\"friction\": 1",
                 "cloths[0].fabrics[0].material.friction: is of the whole cloth"},
        BadScene{"FabricKeyWithThickness", "[ { \"time\": 1 } ]", R"([ { "time": 1, "thickness": 0.01 } ])",
                 "cloths[0].fabrics[0].material.motion[0].thickness: is of the whole cloth"},
        BadScene{"UnknownClothKey", "\"transform\"", "\"material_\": 1, \"transform\"",
                 "nearest known one is \"material\""}),
    [](const auto& scene) { return scene.param.name; });

TEST(Scene, NoPrefixOfAFileCrashesTheReader) {
  const std::string text = kFull;
  for (size_t length = 0; length < text.size(); ++length) {
    EXPECT_THROW(static_cast<void>(parse_scene(text.substr(0, length), "scene.json")), Error) << length;
  }
}

TEST(Scene, FilesThatAreNone) {
  EXPECT_THROW(static_cast<void>(read_scene("/no/such/file.json")), Error);
  EXPECT_THROW(static_cast<void>(read_scene(std::filesystem::temp_directory_path())), Error);
}

/// Writes a sheet as an asset and gives a scene that plays it.
class Playing : public ::testing::Test {
 protected:
  void SetUp() override { write_asset(test::make_sheet(sheet_), folder_ / "sheet.glb"); }

  Simulation play(const std::string& cloth, const std::string& rest = "") {
    const std::string text = R"({"version":1,"substeps":8,"cloths":[{"asset":"sheet.glb")" + cloth + "}]" + rest + "}";
    return {parse_scene(text, folder_ / "scene.json"), test::cpu_settings()};
  }
  [[nodiscard]] Vec3 point(Simulation& simulation, uint32_t i, uint32_t j) const {
    return test::positions_of(simulation.solver())[test::sheet_pixel(sheet_, i, j)];
  }

  test::SheetOptions sheet_{.nx = 9, .ny = 9, .charts_x = 2};
  test::TemporaryFolder folder_;
};

TEST_F(Playing, EverySelectorTakesItsPointsWithAllCopies) {
  const ClothAsset asset = test::make_sheet(sheet_);
  const auto count = [&](const Where& where) { return select_pixels(asset, {}, where).size(); };
  EXPECT_EQ(count(WhereTop{0.01F}), 10U);  // 9 points, one of them twice
  EXPECT_EQ(count(WhereBoundary{.index = 0U}), 34U);
  EXPECT_EQ(count(WhereBoundary{}), 34U);
  EXPECT_EQ(count(WhereBox{{-0.01F, -1, -1}, {0.01F, 1, 1}}), 18U);
  EXPECT_EQ(count(WhereSphere{{0, 0, 0}, 0.01F}), 2U);
  EXPECT_EQ(count(WhereVertices{{0, 8}}), 2U);
  EXPECT_EQ(count(WhereVertexGroup{"bottom"}), 10U);
  ClothAsset painted = asset;
  painted.source.material.resize(2);
  painted.source.material[0].name = "denim";
  painted.source.material[1].name = "silk";
  painted.source.part = {{"a", 1, 0, 16}, {"b", 0, 16, 112}};  // the first of eight rows of triangles is of silk
  EXPECT_EQ(select_pixels(painted, {}, WhereMaterial{"silk"}).size(), 20U);
  EXPECT_EQ(select_pixels(painted, {}, WhereMaterial{"denim"}).size(), 80U);
  EXPECT_THROW(static_cast<void>(select_pixels(painted, {}, WhereMaterial{"wool"})), Error);
  EXPECT_THROW(count(WhereBox{{5, 5, 5}, {6, 6, 6}}), Error);
  EXPECT_THROW(count(WhereBoundary{.index = 1U}), Error);
  EXPECT_THROW(count(WhereVertices{{81}}), Error);
  EXPECT_THROW(count(WhereVertexGroup{"collar"}), Error);
}

// Two corners that turn about one point stay as far apart as they were.
TEST_F(Playing, PinsOfOnePivotTurnTogether) {
  const std::string turning = R"(,"pivot":[0,0,0],"motion":[{"time":0},{"time":0.5,"rotate_deg":[0,0,90]}]})";
  Simulation simulation =
      play(R"(,"pins":[{"where":{"vertices":[0]})" + turning + R"(,{"where":{"vertices":[8]})" + turning + "]");
  const Vec3 left = point(simulation, 0, 0), right = point(simulation, 8, 0);
  for (int f = 0; f < 30; ++f) simulation.step();
  const auto turned = [](const Vec3& p) { return Vec3{-p.y, p.x, p.z}; };
  EXPECT_LT(length(point(simulation, 0, 0) - turned(left)), 1e-5F);
  EXPECT_LT(length(point(simulation, 8, 0) - turned(right)), 1e-5F);
}

// What is thrown flies as fast as the hand was, at every frame rate: the last bit of a motion that ends within a frame
// once was a whole frame's way.
TEST(Scene, ThrownClothIsAsFastAsItsPinsWere) {
  const test::TemporaryFolder folder;
  write_asset(test::make_sheet({.nx = 5, .ny = 5}), folder / "sheet.glb");
  for (const int rate : {24, 25, 30, 60, 90, 120}) {
    const std::string text =
        R"({"version":1,"substeps":8,"gravity":[0,0,0],"frame_rate":)" + std::to_string(rate) +
        R"(,"cloths":[{"asset":"sheet.glb","material":{"damping":0},"pins":[{"where":{"top":1},"until":0.49,
                             "motion":[{"time":0},{"time":0.49,"translate":[1,0,0]}]}]}]})";
    Simulation simulation(parse_scene(text, folder / "scene.json"), test::cpu_settings());
    while (simulation.time() < 0.6) simulation.step();
    const std::vector<Vec3> before = test::positions_of(simulation.solver());
    simulation.step();
    const std::vector<Vec3> after = test::positions_of(simulation.solver());
    EXPECT_NEAR(static_cast<float>(rate) * (after[12].x - before[12].x), 1 / 0.49F, 0.02F) << rate;
  }
}

// A hem is a boundary and what lies within a hand of it, in metres of the scene.
TEST_F(Playing, AFabricIsWhatItsPlaceSaysOrABandAlongIt) {
  const auto scene = [&](const std::string& width, const std::string& material = R"({"areal_density":0.8})") {
    return play(R"(,"transform":{"scale":2},"fabrics":[{"where":{"vertex_group":"bottom"})" + width +
                R"(,"material":)" + material + "}]");
  };
  const auto points = [&](const std::string& width) { return scene(width).cloths()[0].fabrics[0].pixels.size(); };
  EXPECT_EQ(points(R"(,"width":0.26)"), 20U);  // two rows of 9 points, one of them twice
  EXPECT_EQ(points(R"(,"width":0.51)"), 30U);
  for (const auto* narrow : {"", R"(,"width":0.1)"}) {
    try {
      static_cast<void>(scene(narrow));
      ADD_FAILURE() << "a row of points has no cells";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("cloths[0].fabrics[0].where: the corners of no cell")) << narrow;
    }
  }
  Simulation simulation = scene(R"(,"width":0.26)", R"({"motion":[{"time":0},{"time":0.02,"areal_density":0.8}]})");
  simulation.step();
  EXPECT_TRUE(simulation.solver().fabric(0, 0) == simulation.cloths()[0].fabrics[0].material);
  EXPECT_GT(simulation.solver().fabric(0, 0).areal_density, 0.5F);
  simulation.step();
  EXPECT_EQ(simulation.solver().fabric(0, 0).areal_density, 0.8F);
  EXPECT_EQ(simulation.solver().material(0).areal_density, Material{}.areal_density);
}

// Garments of games have triangles twenty pixels long: cloth hung through between the points at its vertices.
TEST(SelectPixels, OfAGroupTakesWhatLiesBetweenItsVertices) {
  constexpr uint32_t kSide = 17;
  const test::SheetOptions options{.nx = kSide, .ny = kSide};
  ClothAsset asset = make_sheet(options);
  const auto corner = [&](uint32_t i, uint32_t j) {
    return test::sheet_pixel(options, i * (kSide - 1), j * (kSide - 1));
  };
  const std::array<uint32_t, 4> pixel{corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)};
  asset.source = {};
  asset.source.source_vertex_count = 4;
  asset.source.triangle = {{0, 1, 2}, {1, 3, 2}};
  asset.source.source_vertex = {0, 1, 2, 3};
  asset.binding.clear();
  for (const uint32_t p : pixel) {
    asset.source.position.push_back(asset.rest_position[p]);
    asset.binding.push_back({{p, p, p}, {1, 0, 0}, {}});
  }
  const auto count = [&](const std::vector<uint32_t>& vertices) {
    asset.vertex_groups = {{"painted", vertices}};
    return select_pixels(asset, {}, WhereVertexGroup{"painted"}).size();
  };
  EXPECT_EQ(count({0}), 1U);
  EXPECT_EQ(count({0, 3}), 2U);  // no edge joins them
  EXPECT_EQ(count({0, 1}), kSide);
  EXPECT_EQ(count({0, 1, 2}), kSide * (kSide + 1) / 2);
  EXPECT_EQ(count({0, 1, 2, 3}), kSide * kSide);
  EXPECT_EQ(select_pixels(asset, {}, WhereVertices{{0, 1}}).size(), 2U);  // a list means what it names
}

// Rounding leaves points of a row on both sides of a face that it lies on: the upper edge of a sheet that is turned
// hung by one of its 9 points.
TEST_F(Playing, RowsOnTheFaceOfASelectorAreTakenWhole) {
  const ClothAsset asset = test::make_sheet({.nx = 9, .ny = 9});
  for (const float degrees : {90.F, -90.F}) {
    const Transform turned{{0.3F, 0.7F, 0.1F}, quat_from_euler_deg({0, 0, degrees}), 1.7F};
    const auto count = [&](const Where& where) { return select_pixels(asset, turned, where).size(); };
    const auto column = [&](uint32_t i) { return apply(turned, asset.rest_position[i]).y; };
    EXPECT_EQ(count(WhereTop{0}), 9U) << degrees;
    EXPECT_EQ(count(WhereTop{0.25F}), 27U) << degrees;
    const auto [low, high] = std::minmax({column(0), column(2)});
    EXPECT_EQ(count(WhereBox{{-9, low, -9}, {9, high, 9}}), 27U) << degrees;
    const Vec3 corner = apply(turned, asset.rest_position[0]), end = apply(turned, asset.rest_position[8]);
    EXPECT_EQ(count(WhereSphere{corner, length(end - corner)}), 58U) << degrees;
  }
}

// Held by their boundary, which goes all around, flags and capes did not move.
TEST_F(Playing, SheetsHangByTheirTopOrOneEnd) {
  const ClothAsset asset = test::make_sheet({.nx = 9, .ny = 9});
  const auto rows = [&](const Vec3& degrees, auto&& is_held) {
    const std::vector<uint32_t> held = select_pixels(asset, {{}, quat_from_euler_deg(degrees), 1}, WhereHanger{});
    EXPECT_EQ(held.size(), 9U);
    for (const uint32_t p : held) EXPECT_TRUE(is_held(asset.rest_position[p])) << p;
  };
  rows({0, 0, 0}, [](const Vec3& x) { return x.y > 0.49F; });
  rows({0, 0, 90}, [](const Vec3& x) { return x.x > 0.49F; });
  rows({20, 0, 0}, [](const Vec3& x) { return x.y > 0.49F; });
  rows({90, 0, 0}, [](const Vec3& x) { return x.x < -0.49F; });
  const ClothAsset long_sheet = test::make_sheet({.nx = 5, .ny = 9, .width = 0.5F});
  const Transform level{{}, quat_from_euler_deg({90, 0, 0}), 1};
  EXPECT_EQ(select_pixels(long_sheet, level, WhereHanger{}).size(), 5U);
}

// Hats and tents fell through their only boundary and turned inside out.
TEST_F(Playing, AHatHangsByItsTop) {
  ClothAsset hat = test::make_sheet({.nx = 9, .ny = 9});
  for (Vec3& p : hat.rest_position) {
    const float out = std::max(std::abs(p.x), std::abs(p.y));
    p = {p.x, 0.6F - out, p.y};
  }
  const std::vector<uint32_t> held = select_pixels(hat, {}, WhereHanger{});
  EXPECT_THAT(held, testing::ElementsAre(test::sheet_pixel({.nx = 9, .ny = 9}, 4, 4)));
  const Transform upside_down{{}, quat_from_euler_deg({180, 0, 0}), 1};
  EXPECT_EQ(select_pixels(hat, upside_down, WhereHanger{}), select_pixels(hat, upside_down, WhereBoundary{}));
}

TEST_F(Playing, HangersHoldTubesByTheirUpperEnd) {
  const ClothAsset tube = test::make_tube({});
  EXPECT_EQ(select_pixels(tube, {}, WhereHanger{}), select_pixels(tube, {}, WhereBoundary{}));
}

TEST_F(Playing, DefaultPinHoldsEveryPart) {
  // Two sheets in one image: the charts of a cut sheet without their seam.
  ClothAsset asset = test::make_sheet({.nx = 9, .ny = 9, .charts_x = 2});
  asset.splits = {};
  asset.seam_bends.clear();
  EXPECT_EQ(select_pixels(asset, {}, WhereBoundary{}).size(), 24U);
  EXPECT_EQ(select_pixels(asset, {}, WhereHanger{}).size(), 10U);
}

TEST_F(Playing, HighestBoundaryOfATubeIsItsUpperEnd) {
  const ClothAsset tube = test::make_tube({});
  for (const uint32_t p : select_pixels(tube, {}, WhereBoundary{})) EXPECT_LT(p, tube.width);
  Transform upside_down;
  upside_down.rotate = quat_from_euler_deg({180, 0, 0});
  for (const uint32_t p : select_pixels(tube, upside_down, WhereBoundary{})) {
    EXPECT_GE(p, tube.width * (tube.height - 1));
  }
}

TEST_F(Playing, APinThatSelectsNothingIsNamedByItsPath) {
  try {
    play(R"(,"pins":[{"where":{"top":0.1}},{"where":{"boundary":7}}])");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("scene.json: cloths[0].pins[1].where"), HasSubstr("boundary 7")));
  }
}

TEST_F(Playing, WhatTheSolverRefusesIsNamedByItsPath) {
  for (const std::string key : {"self_collision", "inter_collision"}) {
    try {
      play("},{\"asset\":\"sheet.glb\",\"" + key + R"(":{"distance":5})");
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_data);
      EXPECT_THAT(error.what(), HasSubstr("scene.json: cloths[1]: " + key + ": distance is 5"));
    }
  }
}

TEST_F(Playing, PinsFollowWhatTheySay) {
  Simulation simulation = play(R"(,"transform":{"translate":[0,2,0]},
    "motion":[{"time":0,"translate":[0,0,0]},{"time":1,"translate":[0,0,1]}],
    "pins":[{"where":{"vertices":[0]},"follow":"cloth"},{"where":{"vertices":[8]},"follow":"world"},
            {"where":{"vertices":[72]},"follow":"ball"},
            {"where":{"vertices":[80]},"follow":"world","motion":[{"time":0},{"time":1,"translate":[0.5,0,0]}]}])",
                               R"(,"colliders":[{"name":"ball","shape":"sphere","center":[0,-5,0],"radius":0.1,
    "motion":[{"time":0},{"time":1,"translate":[0,1,0]}]}])");
  for (int f = 0; f < 30; ++f) simulation.step();
  EXPECT_LT(length(point(simulation, 0, 0) - Vec3{-0.5F, 2.5F, 0.5F}), 1e-6F);
  EXPECT_LT(length(point(simulation, 8, 0) - Vec3{0.5F, 2.5F, 0}), 1e-6F);
  EXPECT_LT(length(point(simulation, 0, 8) - Vec3{-0.5F, 2, 0}), 1e-6F);
  EXPECT_LT(length(point(simulation, 8, 8) - Vec3{0.75F, 1.5F, 0}), 1e-6F);
}

TEST_F(Playing, EachClothFallsByItsShareOfGravity) {
  Simulation simulation =
      play(R"(,"material":{"damping":0},"gravity_scale":0.5},{"asset":"sheet.glb","material":{"damping":0}},
    {"asset":"sheet.glb","material":{"damping":0},"gravity_scale":-1)");
  const auto heights = [&] {
    std::array<float, 3> height{};
    std::vector<Vec3> position;
    for (uint32_t c = 0; c < 3; ++c) {
      simulation.solver().read_positions(c, position);
      height.at(c) = position[0].y;
    }
    return height;
  };
  const std::array<float, 3> before = heights();
  for (int f = 0; f < 30; ++f) simulation.step();
  const std::array<float, 3> after = heights();
  std::array<float, 3> fallen{};
  for (size_t c = 0; c < 3; ++c) fallen.at(c) = before.at(c) - after.at(c);
  EXPECT_NEAR(fallen[1], 0.5 * 9.81 * 0.5 * 0.5, 0.01);
  EXPECT_NEAR(fallen[0], 0.5F * fallen[1], 1e-4F) << "half the weight falls half as far";
  EXPECT_NEAR(fallen[2], -fallen[1], 1e-4F) << "what is lifted rises as others fall";
}

TEST_F(Playing, AHeavierClothHangsAsUnderAsMuchMoreGravity) {
  const auto hung = [&](const std::string& scale, const std::string& gravity) {
    Simulation simulation =
        play(R"(,"pins":[{"where":{"top":0.02}}],"gravity_scale":)" + scale, R"(,"gravity":[0,)" + gravity + ",0]");
    for (int f = 0; f < 30; ++f) simulation.step();
    std::vector<Vec3> position;
    simulation.solver().read_positions(0, position);
    return position;
  };
  EXPECT_EQ(hung("8", "-4"), hung("1", "-32")) << "its attachments give way alike";
  EXPECT_NE(hung("8", "-4"), hung("1", "-4"));
}

TEST_F(Playing, APinTurnsWithWhatItFollows) {
  Simulation simulation = play(R"(,"pins":[{"where":{"vertices":[8]},"follow":"ball"},{"where":{"vertices":[0,72]},
      "motion":[{"time":0},{"time":1,"rotate_deg":[0,0,-360]}]}])",
                               R"(,"colliders":[{"name":"ball","shape":"sphere","center":[0,-5,0],"radius":0.1,
    "motion":[{"time":0},{"time":1,"rotate_deg":[0,720,0]}]}])");
  const auto look = [&](const Vec3& on_ball, const Vec3& first) {
    for (int f = 0; f < 15; ++f) simulation.step();
    EXPECT_LT(length(point(simulation, 8, 0) - on_ball), 1e-6F);
    EXPECT_LT(length(point(simulation, 0, 0) - first), 1e-6F);
    EXPECT_LT(length(point(simulation, 0, 8) - (Vec3{-1, 0, 0} - first)), 1e-6F);
  };
  look({-0.5F, 0.5F, 0}, {0, 0, 0});         // half a turn and a quarter of one
  look({0.5F, 0.5F, 0}, {-0.5F, -0.5F, 0});  // a turn and half a one
}

TEST_F(Playing, PointsAreFreeWithinADistanceThatGrowsAlongTheCloth) {
  // Of a sheet whose upper edge is held the rows are 1/8 m from each other. The held pin counts, in either order.
  const std::string held = R"({"where":{"vertex_group":"top"}})";
  const std::string free = R"({"where":{"top":1},"follow":"world","max_distance":{"least":0.01,"per_metre":0.2}})";
  for (const std::string& pins : {held + "," + free, free + "," + held}) {
    Simulation simulation = play(R"(,"pins":[)" + pins + "]", R"(,"wind":{"velocity":[0,0,12],"turbulence":0.5})");
    std::vector<float> most(9);
    for (int f = 0; f < 60; ++f) {
      simulation.step();
      for (uint32_t j = 0; j < 9; ++j) {
        for (uint32_t i = 0; i < 9; ++i) {
          const Vec3 rest = simulation.cloths()[0].asset->rest_position[test::sheet_pixel(sheet_, i, j)];
          most[j] = std::max(most[j], length(point(simulation, i, j) - rest));
        }
      }
    }
    EXPECT_EQ(most[0], 0);
    for (uint32_t j = 1; j < 9; ++j) {
      const float allowed = 0.01F + 0.2F * static_cast<float>(j) / 8;
      EXPECT_LT(most[j], allowed + 2e-3F) << j;
      EXPECT_GT(most[j], 0.8F * allowed) << "row " << j << " is held back";
    }
    EXPECT_EQ(simulation.held_pixels(0).size(), 10U);
  }
}

TEST_F(Playing, OneDistanceForAllNeedsNoPinThatHolds) {
  Simulation simulation = play(R"(,"pins":[{"where":{"top":1},"max_distance":0.03}])");
  for (int f = 0; f < 60; ++f) simulation.step();
  for (uint32_t j = 0; j < 9; ++j) {
    const Vec3 rest = simulation.cloths()[0].asset->rest_position[test::sheet_pixel(sheet_, 4, j)];
    EXPECT_NEAR(point(simulation, 4, j).y, rest.y - 0.03F, 1e-3F) << j;
  }
  const auto refused = [&](const std::string& pins) {
    try {
      play(R"(,"pins":[)" + pins + "]");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(
      refused(R"({"where":{"top":0},"frequency":2},{"where":{"top":1},"max_distance":{"per_metre":0.1}})"),
      HasSubstr("scene.json: cloths[0].pins[1].max_distance: grows from the points that pins of the cloth hold"));
  EXPECT_THAT(refused(R"({"where":{"top":1},"max_distance":-0.1})"),
              HasSubstr("cloths[0].pins[0].max_distance: must be from 0.0 to 10000.0"));
  EXPECT_THAT(refused(R"({"where":{"top":1},"max_distance":{"least":0.1}})"),
              HasSubstr("cloths[0].pins[0].max_distance"));
  EXPECT_THAT(refused(R"({"where":{"top":1},"max_distance":{"per_meter":0.1}})"), HasSubstr("per_metre"));
}

// What engines' artists paint: black is held, and the lighter a place the farther it may swing.
TEST_F(Playing, PointsAreFreeAsFarAsTheirPaintSays) {
  ClothAsset asset = test::make_sheet(sheet_);
  constexpr float kMost = 0.2F;  // [m]
  asset.paint.resize(asset.source.source_vertex_count);
  for (uint32_t v = 0; v < asset.paint.size(); ++v) {
    const auto row = static_cast<uint8_t>(v / sheet_.nx);
    asset.paint[v] = {0, static_cast<uint8_t>(30 * row), 0, static_cast<uint8_t>(255 - 30 * row)};
  }
  write_asset(asset, folder_ / "sheet.glb");
  for (const std::string map : {R"("painted":"green","most":0.2)", R"("painted":"alpha","least":0.2,"most":0)"}) {
    Simulation simulation = play(R"(,"pins":[{"where":{"top":1},"follow":"world","max_distance":{)" + map + "}}]",
                                 R"(,"wind":{"velocity":[0,0,25],"turbulence":0.5})");
    std::vector<float> most(9);
    for (int f = 0; f < 60; ++f) {
      simulation.step();
      for (uint32_t j = 0; j < 9; ++j) {
        for (uint32_t i = 0; i < 9; ++i)
          most[j] =
              std::max(most[j], length(point(simulation, i, j) - asset.rest_position[test::sheet_pixel(sheet_, i, j)]));
      }
    }
    EXPECT_LT(most[0], 1e-6F) << map;
    for (uint32_t j = 1; j < 9; ++j) {
      const float allowed = kMost * 30 * static_cast<float>(j) / 255;
      EXPECT_LT(most[j], allowed + 2e-3F) << j;
      EXPECT_GT(most[j], 0.8F * allowed) << "row " << j << " is held back";
    }
  }
}

TEST_F(Playing, PaintBetweenVerticesIsInProportion) {
  ClothAsset asset = test::make_sheet({.nx = 3, .ny = 3});
  asset.paint = {{0, 255, 0, 0}, {0, 0, 51, 0}, {0, 0, 0, 0}};
  asset.source.position = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  asset.source.triangle = {{0, 1, 2}};
  asset.source.source_vertex = {2, 0, 1};  // painted are the vertices of the file
  asset.rest_position = {{0, 0, 0}, {0.25F, 0, 0.5F}, {1, 0, 0}, {0, 0, 0.5F}, {0.5F, 9, 0.5F}};
  const auto at = [&](PaintChannel channel) { return paint_at(asset, channel, std::vector<uint32_t>{0, 1, 2, 3, 4}); };
  using ::testing::ElementsAre, ::testing::FloatEq;
  EXPECT_THAT(at(PaintChannel::green), ElementsAre(0, FloatEq(0.25F), 1, 0, FloatEq(0.5F)));
  EXPECT_THAT(at(PaintChannel::blue), ElementsAre(0, FloatEq(0.1F), 0, FloatEq(0.1F), FloatEq(0.1F)));
}

// Shares of a triangle's corners are off by rounding at its edges: a distance below 0 was refused by the solver.
TEST_F(Playing, PaintIsNeverBelowBlackOrAboveWhite) {
  ClothAsset asset = test::make_sheet({.nx = 20, .ny = 10});
  const Vec3 a{0.13F, 1.27F, -0.31F}, b{1.71F, -0.37F, 0.53F};
  asset.source.position = {a, b, {0.19F, 0.23F, 2.9F}};
  asset.source.triangle = {{0, 1, 2}};
  asset.source.source_vertex = {0, 1, 2};
  asset.paint = {{0, 255}, {0, 255}, {255, 0}};
  std::vector<uint32_t> pixels(asset.pixel_count());
  std::iota(pixels.begin(), pixels.end(), 0U);
  asset.rest_position.clear();
  for (const uint32_t p : pixels) asset.rest_position.push_back(a + static_cast<float>(p) / 200 * (b - a));
  for (const float value : paint_at(asset, PaintChannel::red, pixels)) EXPECT_GE(value, 0);
  for (const float value : paint_at(asset, PaintChannel::green, pixels)) EXPECT_LE(value, 1);
}

TEST_F(Playing, PaintThatIsNotThereIsNamed) {
  const auto refused = [&](const std::string& distance) {
    try {
      play(R"(,"pins":[{"where":{"top":1},"max_distance":{)" + distance + "}}]");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string where = "cloths[0].pins[0].max_distance";
  EXPECT_THAT(
      refused(R"("painted":"red","most":1)"),
      AllOf(HasSubstr(where + ".painted: sheet: none of its vertices is painted"), HasSubstr("convert it again")));
  EXPECT_THAT(refused(R"("painted":"pink","most":1)"),
              HasSubstr(where + ".painted: must be red, green, blue or alpha"));
  EXPECT_THAT(refused(R"("painted":"red")"), HasSubstr("\"most\" is missing"));
  EXPECT_THAT(refused(R"("painted":"red","most":1,"per_metre":1)"), HasSubstr(where + ": must be a number, or have"));
  EXPECT_THAT(refused(R"("per_metre":1,"most":1)"), HasSubstr(where + ".most: goes with painted"));
  EXPECT_THAT(refused(R"("painted":"red","most":-1)"), HasSubstr(where + ".most: must be from"));
}

TEST_F(Playing, AClothThatIsDrawnTooFarTears) {
  const std::string pins = R"(,"pins":[{"where":{"vertex_group":"top"}},{"where":{"vertex_group":"bottom"},
      "motion":[{"time":0},{"time":1,"translate":[0,-0.6,0]}]}])";
  Simulation tears = play(pins + R"(,"tear":1.3)"), holds = play(pins);
  for (int f = 0; f < 60; ++f) {
    tears.step();
    holds.step();
  }
  EXPECT_GE(tears.torn(0).springs, 8U);
  EXPECT_EQ(holds.torn(0), CutResult());
  EXPECT_NE(tears.cloths()[0].asset, holds.cloths()[0].asset);
  EXPECT_LT(measure_stretch(*tears.cloths()[0].asset, 1, test::positions_of(tears.solver())).max,
            measure_stretch(*holds.cloths()[0].asset, 1, test::positions_of(holds.solver())).max);
}

TEST_F(Playing, ASewingPatternIsSewnWithoutItsWeight) {
  ClothAsset asset = test::make_sheet({.nx = 8, .ny = 8, .charts_x = 2});
  for (uint32_t r = 0; r < asset.splits.rows(); ++r)
    asset.sewing.push_back({asset.splits.pixel[2 * r], asset.splits.pixel[2 * r + 1]});
  asset.splits = {};
  asset.seam_bends.clear();
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && asset.chart[p] == 1) asset.rest_position[p].x += 0.3F;
  write_asset(asset, folder_ / "pattern.glb");
  const auto play = [&](const std::string& sewing, uint32_t frames) {
    Simulation simulation(
        parse_scene("{\"version\":1,\"cloths\":[{\"asset\":\"pattern.glb\"" + sewing + "}]}", folder_ / "s.json"),
        test::cpu_settings());
    for (uint32_t f = 0; f < frames; ++f) simulation.step();
    std::vector<Vec3> position;
    simulation.solver().read_positions(0, position);
    float gap = 0, sum = 0;
    for (const auto& [a, b] : asset.sewing) gap = std::max(gap, length(position[b] - position[a]));
    for (uint32_t p = 0; p < asset.pixel_count(); ++p)
      if (asset.valid(p)) sum += position[p].y - asset.rest_position[p].y;
    return std::pair(gap, sum / static_cast<float>(count_valid_pixels(asset)));
  };
  const auto [half, still] = play("", 30);
  EXPECT_LE(half, 0.151);  // threads only pull
  EXPECT_GT(half, 0.05);
  EXPECT_NEAR(still, 0, 1e-3);
  const auto [closed, falling] = play("", 66);
  EXPECT_LT(closed, 1e-3);
  EXPECT_NEAR(falling, -9.81 * 0.1 * 0.1 / 2, 1e-2) << "its weight is back";
  const auto [before, hanging] = play(", \"sewing\": { \"start\": 0.5, \"duration\": 0.25 }", 30);
  EXPECT_NEAR(before, 0.3, 1e-5);
  EXPECT_NEAR(hanging, 0, 1e-5);
  const auto [at_once, heavy] = play(", \"sewing\": { \"duration\": 0, \"weightless\": false }", 6);
  EXPECT_LT(at_once, 1e-2);
  EXPECT_LT(heavy, -0.03);
  const auto [apart, free] = play(", \"sewing\": false", 6);
  EXPECT_NEAR(apart, 0.3, 1e-3);
  EXPECT_LT(free, -0.03);

  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && asset.chart[p] == 1) asset.rest_position[p].x -= 0.3F;
  write_asset(asset, folder_ / "pattern.glb");
  const auto [sewn, falls] = play("", 6);
  EXPECT_LT(sewn, 1e-3);
  EXPECT_LT(falls, -0.03) << "what begins sewn waits for nothing";

  asset.sewing.clear();
  write_asset(asset, folder_ / "pattern.glb");
  EXPECT_NO_THROW(play("", 1));
  try {
    play(", \"sewing\": true", 1);
    ADD_FAILURE() << "there is nothing to sew";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("cloths[0].sewing"), HasSubstr("nothing to sew")));
  }
}

TEST_F(Playing, APressureSwellsASail) {
  Simulation sail = play(R"(,"pressure":1.5,"pins":[{"where":{"vertices":[0,8,72,80]}}])", R"(,"gravity":[0,0,0])");
  for (int f = 0; f < 30; ++f) sail.step();
  EXPECT_GT(point(sail, 4, 4).z, 0.02F);  // its normals point along +z
}

constexpr const char* kJumpingBar = R"(,"colliders":[{"name":"bar","shape":"capsule","a":[-0.5,0.52,0],"b":[0.5,0.52,0],
    "radius":0.015,"motion":[{"time":0},{"time":0.505,"translate":[3,1,0],"rotate_deg":[0,90,0],"teleport":true},
                             {"time":2,"translate":[3,1,0],"rotate_deg":[0,90,0]}]}])";

/// The pins jumped and the cloth stayed, so that it was torn.
TEST_F(Playing, AClothJumpsWithTheColliderThatHoldsIt) {
  for (const std::string soft : {"", R"(,"frequency":4)", R"(,"from":0.5)", R"(,"motion":[{"time":0},{"time":1}])"}) {
    const auto hung = [&](const std::string& bar) {
      return play(R"(,"pins":[{"where":{"vertex_group":"top"},"follow":"bar")" + soft + "}]", bar);
    };
    Simulation jumps = hung(kJumpingBar), stays = hung(R"(,"colliders":[{"name":"bar","shape":"capsule",
        "a":[-0.5,0.52,0],"b":[0.5,0.52,0],"radius":0.015}])");
    const Transform way = collider_at(jumps.scene().colliders[0], 1).pose;
    for (int f = 1; f <= 60; ++f) {
      jumps.step();
      stays.step();
      const std::vector<Vec3> x = test::positions_of(jumps.solver()), y = test::positions_of(stays.solver());
      const std::vector<Vec3> v = test::velocities_of(jumps.solver()), w = test::velocities_of(stays.solver());
      for (size_t p = 0; p < x.size(); ++p) {
        if (!jumps.cloths()[0].asset->valid(static_cast<uint32_t>(p))) continue;
        ASSERT_LT(length(x[p] - (f > 30 ? apply(way, y[p]) : y[p])), 2e-3F) << f << soft;
        ASSERT_LT(length(v[p] - (f > 30 ? rotate(way.rotate, w[p]) : w[p])), 0.05F) << f << soft;
      }
    }
  }
}

/// A jump in a pin's own motion was read and did nothing.
TEST_F(Playing, AClothJumpsWithItsPins) {
  constexpr const char* kJump =
      R"([{"time":0},{"time":0.505,"translate":[3,1,0],"rotate_deg":[0,90,0],"teleport":true}])";
  constexpr const char* kShift = R"([{"time":0},{"time":0.505,"translate":[3,1,0],"teleport":true}])";
  const std::string shifting = std::string(R"("motion":)") + kShift;
  const std::string bar =
      R"(,"colliders":[{"name":"bar","shape":"sphere","center":[0,9,0],"radius":0.1,)" + shifting + "}]";
  const auto pin = [](const std::string& where, const std::string& rest) {
    return R"({"where":{)" + where + "}," + rest + "}";
  };
  const std::string left = R"("vertices":[0])", right = R"("vertices":[8])";
  struct Case {
    std::string pins, still_pins;
    Transform way;
  };
  const std::string top = R"("vertex_group":"top")";
  const Transform turned{{3, 1, 0}, quat_from_euler_deg({0, 90, 0}), 1};
  for (const Case& each :
       {Case{pin(top, std::string(R"("follow":"world","motion":)") + kJump), pin(top, R"("follow":"world")"), turned},
        Case{pin(left, shifting) + "," + pin(right, shifting),
             pin(left, R"("follow":"world")") + "," + pin(right, R"("follow":"world")"),
             {{3, 1, 0}, {}, 1}},
        Case{pin(left, R"("frequency":5,"follow":"bar")") + "," + pin(right, shifting),
             pin(left, R"("frequency":5,"follow":"world")") + "," + pin(right, R"("follow":"world")"),
             {{3, 1, 0}, {}, 1}}}) {
    Simulation jumps = play(R"(,"pins":[)" + each.pins + "]", bar),
               stays = play(R"(,"pins":[)" + each.still_pins + "]");
    for (int f = 1; f <= 45; ++f) {
      jumps.step();
      stays.step();
      const std::vector<Vec3> x = test::positions_of(jumps.solver()), y = test::positions_of(stays.solver());
      for (size_t p = 0; p < x.size(); ++p) {
        if (!jumps.cloths()[0].asset->valid(static_cast<uint32_t>(p))) continue;
        // The pins turn about their own middle, half a metre up.
        const Vec3 up{0, 0.5F, 0};
        ASSERT_LT(length(x[p] - (f > 30 ? up + apply(each.way, y[p] - up) : y[p])), 5e-3F) << f << each.pins;
      }
    }
  }
}

/// Pins that part cannot both be followed; they go where they say all the same.
TEST_F(Playing, AClothDoesNotJumpWithPinsThatPart) {
  Simulation simulation = play(R"(,"pins":[{"where":{"vertices":[0]},"motion":[{"time":0},
      {"time":0.1,"translate":[0,1,0],"teleport":true}]},{"where":{"vertices":[8]},"motion":[{"time":0},
      {"time":0.1,"translate":[0,2,0],"teleport":true}]}])");
  for (int f = 0; f < 7; ++f) simulation.step();
  EXPECT_LT(length(point(simulation, 0, 0) - Vec3{-0.5F, 1.5F, 0}), 1e-5F);
  EXPECT_LT(length(point(simulation, 8, 0) - Vec3{0.5F, 2.5F, 0}), 1e-5F);
}

TEST_F(Playing, OnlyWhatHangsOnItJumpsWithACollider) {
  Simulation simulation = play(R"(,"pins":[{"where":{"vertex_group":"top"},"follow":"bar"}],
      "cuts":[{"time":0,"triangle":[[-3,0.02,-2],[3,0.02,-2],[0,0.02,4]]}])",
                               std::string(kJumpingBar) + R"(,"gravity":[0,0,0])");
  for (int f = 0; f < 31; ++f) simulation.step();
  EXPECT_LT(length(point(simulation, 4, 0) - Vec3{3, 1.5F, 0}), 0.05F);
  EXPECT_LT(length(point(simulation, 4, 8) - Vec3{0, -0.5F, 0}), 0.05F);
}

/// A cloth with a motion of its own that jumps is not taken along twice.
TEST_F(Playing, AClothJumpsOnce) {
  Simulation simulation = play(R"(,"pins":[{"where":{"vertex_group":"top"},"follow":"bar"}],
      "motion":[{"time":0},{"time":0.505,"translate":[3,1,0],"teleport":true}])",
                               R"(,"gravity":[0,0,0],"colliders":[{"name":"bar","shape":"sphere","center":[0,2,0],
      "radius":0.1,"motion":[{"time":0},{"time":0.505,"translate":[3,1,0],"teleport":true}]}])");
  for (int f = 0; f < 31; ++f) simulation.step();
  EXPECT_LT(length(point(simulation, 4, 8) - Vec3{3, 0.5F, 0}), 0.05F);
}

TEST_F(Playing, MissingAssetIsNamed) {
  try {
    Simulation simulation(parse_scene(R"({"version":1,"cloths":[{"asset":"none.glb"}]})", folder_ / "scene.json"),
                          test::cpu_settings());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_THAT(error.what(), HasSubstr("none.glb"));
  }
}

/// Of the state after half a second, in a wind.
std::vector<Vec3> blown(Simulation simulation) {
  for (int f = 0; f < 30; ++f) simulation.step();
  return test::positions_of(simulation.solver());
}

TEST_F(Playing, WindChangesWithItsKeys) {
  const auto wind = [&](const std::string& what) {
    return blown(play(R"(,"pins":[{"where":{"vertex_group":"top"}}])", R"(,"wind":{"frequency":2,)" + what + "}"));
  };
  const std::string blows = R"("velocity":[1,0,4],"turbulence":0.3)";
  const std::vector<Vec3> steady = wind(blows);
  EXPECT_EQ(wind(R"("motion":[{"time":0.1,)" + blows + R"(},{"time":0.3,)" + blows + "}]"), steady);
  EXPECT_EQ(wind(blows + R"(,"motion":[{"time":0.1},{"time":0.3}])"), steady);
  EXPECT_EQ(wind(blows + R"(,"motion":[])"), steady);
  EXPECT_EQ(wind(blows + R"(,"motion":[{"time":9,"velocity":[1,0,4]}])"), steady);
  EXPECT_NE(wind(blows + R"(,"motion":[{"time":0},{"time":0.4,"velocity":[0,0,0]}])"), steady);

  // Wind that is set by hand goes before the keys.
  Simulation simulation = play("", R"(,"gravity":[0,0,0],"wind":{"motion":[{"time":0,"velocity":[0,0,9]}]})");
  simulation.set_wind({});
  for (int f = 0; f < 10; ++f) simulation.step();
  EXPECT_EQ(point(simulation, 4, 4).z, 0);
}

// As if the caller had set them in every frame.
TEST_F(Playing, MaterialAndPressureChangeWithTheirKeys) {
  Scene scene = default_scene(folder_ / "sheet.glb");
  Material wet;
  wet.areal_density = 0.7F;
  scene.cloths[0].material_motion = {{0.05, {}}, {0.1, wet}};
  scene.cloths[0].pressure_motion = {{0, 1}, {0.1, 5}};
  Simulation keyed(scene, test::cpu_settings());
  scene.cloths[0].material_motion.clear();
  scene.cloths[0].pressure_motion.clear();
  scene.cloths[0].pressure = 1;
  Simulation told(scene, test::cpu_settings());
  for (int f = 1; f <= 10; ++f) {
    const auto t = static_cast<float>(f / 60.0);
    told.solver().set_material(0, mix({}, wet, (t - 0.05F) / 0.05F));
    told.solver().set_pressure(0, 1 + 40 * std::min(t, 0.1F));
    told.step();
    keyed.step();
    EXPECT_NEAR(keyed.solver().material(0).areal_density, told.solver().material(0).areal_density, 1e-6F) << f;
    EXPECT_TRUE(keyed.cloths()[0].material == keyed.solver().material(0)) << f;
  }
  EXPECT_TRUE(keyed.solver().material(0) == wet);
  const std::vector<Vec3> a = test::positions_of(keyed.solver()), b = test::positions_of(told.solver());
  for (size_t p = 0; p < a.size(); ++p) EXPECT_LT(length(a[p] - b[p]), 1e-5F) << p;
}

TEST_F(Playing, DefaultSceneHangsAndFalls) {
  Simulation simulation(default_scene(folder_ / "sheet.glb"), test::cpu_settings());
  simulation.step();
  EXPECT_EQ(simulation.held_pixels(0).size(), 10U);  // the upper edge, 9 points, one of them twice
  EXPECT_EQ(simulation.scene().frames, 120U);
  EXPECT_TRUE(test::all_finite(test::positions_of(simulation.solver())));
}

}  // namespace
}  // namespace geocloth
