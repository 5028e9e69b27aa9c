// SPDX-License-Identifier: GPL-3.0-or-later
// The vulkan backend does what the cpu backend does, pass by pass and all together: both compile the same text from
// shaders/lib, so on a device with exact square roots and divisions (lavapipe) every bit agrees; elsewhere the
// positions agree to a thousandth of the cloth's size.
#include <cmath>
#include <ostream>

#include "support/pressing_arms.h"
#include "support/vulkan_play.h"

namespace geocloth {
namespace {

using test::cloth_of;
using test::hanging;
using test::kCut;
using test::kUncut;
using test::largest_distance;
using test::Outcome;
using test::pins_of_top;
using test::play;
using test::Play;
using test::settings_of;
using test::SheetOptions;
using test::VulkanBackendTest;

TEST_F(VulkanBackendTest, PredictionOfAFreeFallAgrees) {
  expect_same_as_cpu({.cloths = {cloth_of(kUncut)}, .settings = settings_of(3)});
}

TEST_F(VulkanBackendTest, SpringsAndPinsOfAHangingSheetAgree) {
  expect_same_as_cpu(hanging(kUncut));
}

TEST_F(VulkanBackendTest, OneRowOfPixelsIsEnough) {
  const SheetOptions strip{.nx = 2, .ny = 17, .width = 0.05F};
  expect_same_as_cpu(hanging(strip));
}

TEST_F(VulkanBackendTest, StitchedCopiesOfACutSheetAgreeAndStayTogether) {
  Play scene = hanging(kCut);
  scene.settings.check_copies = true;
  const Outcome outcome = expect_same_as_cpu(scene);
  EXPECT_LE(outcome.statistics.copy_gap, 1e-6);
}

TEST_F(VulkanBackendTest, BendingAcrossSeamsAgrees) {
  Material stiff;
  stiff.bend_warp = stiff.bend_weft = 1e-3F;
  SheetOptions flat = kCut;
  flat.horizontal = true;
  expect_same_as_cpu(hanging(flat, stiff));
}

TEST_F(VulkanBackendTest, BendingOnTheBiasAgreesOnEveryPath) {
  Material sheet;
  sheet.bend_warp = sheet.bend_weft = sheet.bend_bias = 1e-3F;
  SheetOptions flat = kCut;
  flat.horizontal = true;
  for (const SolverPath path : {SolverPath::plain, SolverPath::tiled, SolverPath::tiny}) {
    Play scene = hanging(flat, sheet);
    scene.settings.path = path;
    expect_same_as_cpu(scene);
  }
}

TEST_F(VulkanBackendTest, SeveralRelaxationStepsAccumulateTheSameMultipliers) {
  Play scene = hanging(kCut);
  scene.settings.relaxation_steps = 3;
  expect_same_as_cpu(scene);
}

TEST_F(VulkanBackendTest, SeedParametersAgree) {
  Material seed;
  seed.stiffness = 0.5F;
  seed.bend_stiffness = 0.2F;
  seed.verlet_damping = 0.98F;
  expect_same_as_cpu(hanging(kCut, seed));
}

TEST_F(VulkanBackendTest, LongRangeAttachmentsAgreeAndHoldTheLength) {
  Material limited;
  limited.stretch_warp = limited.stretch_weft = 20.F;
  limited.max_stretch = 0.01F;
  Play scene = hanging(kCut, limited);
  scene.frames = 30;
  const Outcome outcome = expect_same_as_cpu(scene);
  float lowest = 0;
  for (const Vec3& p : outcome.positions[0]) lowest = std::min(lowest, p.y);
  EXPECT_GE(lowest, 0.5F - 1.02F);
}

TEST_F(VulkanBackendTest, GravityThatStraysAgreesOnEveryPath) {
  for (const SolverPath path : {SolverPath::plain, SolverPath::tiled, SolverPath::tiny}) {
    SCOPED_TRACE(to_string(path));
    Play scene = hanging(kCut);
    scene.cloths.push_back(cloth_of(kUncut));
    scene.settings.path = path;
    scene.settings.imperfection = 0.01F;
    const Outcome strays = expect_same_as_cpu(scene);
    scene.settings.imperfection = 0;
    EXPECT_GT(length(strays.positions[1].back() - expect_same_as_cpu(scene).positions[1].back()), 0);
  }
}

TEST_F(VulkanBackendTest, PinsThatMoveAndChangeAgree) {
  Play scene = hanging(kCut);
  scene.frames = 9;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    const float angle = 0.3F * static_cast<float>(frame);
    std::vector<Pin> pins = pins_of_top(kCut, *asset, {0.05F * std::sin(angle), 0, 0.1F * angle});
    if (frame >= 3) pins.resize(4);                          // some are let go,
    if (frame >= 6) pins = {{sheet_pixel(kCut, 6, 5), {}}};  // then another one is taken
    if (frame < 8) solver.set_pins(0, pins);                 // and in the last frame it is held where it was
  };
  expect_same_as_cpu(scene);
}

// What was measured of a fall, before its cloth was held, counted on the cpu once more when it was let go: the place
// that positions are kept relative to moved in another frame, and bits parted.
TEST_F(VulkanBackendTest, ClothThatIsHeldInItsFallAndLetGoAgrees) {
  Material undamped;
  undamped.damping = 0;
  Play scene = hanging({.nx = 8, .ny = 8, .width = 0.35F, .height = 0.35F}, undamped);
  scene.settings.substeps = 4;
  scene.frames = 70;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 0 || frame == 62) solver.set_pins(0, {});
    if (frame != 60) return;
    std::vector<Vec3> at;
    solver.read_positions(0, at);
    std::vector<Pin> pins;
    for (uint32_t p = 0; p < asset->pixel_count(); ++p)
      if (asset->valid(p)) pins.push_back({.pixel = p, .target = at[p]});
    solver.set_pins(0, pins);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanBackendTest, WindWithGustsDragAndLiftAgrees) {
  Play scene = hanging(kCut);
  scene.frames = 10;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) solver.set_pins(0, pins_of_top(kCut, *asset));
    solver.set_wind({.velocity = {1, 0.5F, -6 + 0.1F * static_cast<float>(frame)},
                     .turbulence = 0.5F,
                     .frequency = 2,
                     .drag = 1.2F,
                     .lift = 0.4F});
    if (frame == 5) solver.set_gravity({0, -3, 0});
  };
  expect_same_as_cpu(scene);
}

/// A sheet lying above a collider that comes up, moves and turns.
Play over_collider(const ColliderShape& shape, uint32_t frames) {
  SheetOptions options = kCut;
  options.horizontal = true;
  options.center = {0, 0.25F, 0};
  Play scene{.cloths = {cloth_of(options)}, .settings = settings_of(6), .frames = frames};
  scene.settings.check_copies = true;
  scene.before_frame = [shape](Solver& solver, uint32_t frame) {
    const float t = static_cast<float>(frame) / 60.F;
    const Collider collider{.name = "it",
                            .shape = shape,
                            .friction = 0.4F,
                            .pose = {.translate = {0.2F * t, 0.3F * t, -0.1F * t},
                                     .rotate = quat_from_euler_deg({20 * t, 90 * t, 10 * t})}};
    solver.set_colliders(std::vector{collider});
  };
  return scene;
}

struct NamedShape {
  const char* name;
  ColliderShape shape;
};
void PrintTo(const NamedShape& shape, std::ostream* out) {
  *out << shape.name;
}

class VulkanColliderTest : public VulkanBackendTest, public testing::WithParamInterface<NamedShape> {};

TEST_P(VulkanColliderTest, ContactAgreesAndNothingSinksIn) {
  const Outcome outcome = expect_same_as_cpu(over_collider(GetParam().shape, 24));
  EXPECT_LE(outcome.statistics.penetration, double{Material{}.thickness});
  EXPECT_LE(outcome.statistics.copy_gap, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(
    EveryShape, VulkanColliderTest,
    testing::Values(NamedShape{"plane", Plane{{0, 0.1F, 0}, {0, 1, 0}}}, NamedShape{"sphere", Sphere{{}, 0.2F}},
                    NamedShape{"capsule", Capsule{{-0.3F, 0, 0}, {0.3F, 0.05F, 0}, 0.1F, 0.1F}},
                    NamedShape{"tapered", Capsule{{-0.3F, 0, 0}, {0.3F, 0, 0}, 0.2F, 0.08F}},
                    NamedShape{"box", Box{{}, {0.2F, 0.15F, 0.25F}, quat_from_euler_deg({0, 30, 5})}},
                    NamedShape{"ellipsoid", Ellipsoid{{}, {0.3F, 0.15F, 0.2F}, quat_from_euler_deg({10, 0, 0})}}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(VulkanBackendTest, SheetOverAMovingSphereAgreesAfterSixtyFrames) {
  const Outcome outcome = expect_same_as_cpu(over_collider(Sphere{{}, 0.2F}, 60));
  EXPECT_LE(outcome.statistics.penetration, double{Material{}.thickness});
}

TEST_F(VulkanBackendTest, ClothThatIsDeepInTheCleftOfTwoSolidsAgreesOnEveryPath) {
  SheetOptions options = kCut;
  options.horizontal = true;
  options.width = 0.1F;
  for (const SolverPath path : {SolverPath::plain, SolverPath::tiled, SolverPath::tiny}) {
    Play scene{.cloths = {cloth_of(options)}, .settings = settings_of(4), .frames = 3};
    scene.settings.path = path;
    scene.settings.check_copies = true;
    scene.before_frame = [](Solver& solver, uint32_t) {
      solver.set_colliders(std::vector<Collider>{{"below", Plane{{}, {0.0349F, 0.99939F, 0}}, 0.3F, {}},
                                                 {"above", Plane{{}, {0.0349F, -0.99939F, 0}}, 0.3F, {}}});
    };
    const Outcome outcome = expect_same_as_cpu(scene);
    EXPECT_LE(outcome.statistics.penetration, double{Material{}.thickness});
  }
}

TEST_F(VulkanBackendTest, ManyCollidersOfChangingNumberAgree) {
  Play scene = over_collider(Sphere{{}, 0.2F}, 12);
  scene.before_frame = [](Solver& solver, uint32_t frame) {
    std::vector<Collider> colliders;
    for (uint32_t i = 0; i < 1 + 7 * (frame / 3); ++i)
      colliders.push_back(
          {.name = std::to_string(i), .shape = Sphere{{-0.5F + 0.04F * static_cast<float>(i), 0.2F, 0}, 0.03F}});
    solver.set_colliders(colliders, frame % 4 == 2);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanBackendTest, ClothBetweenOverlappingCollidersAgrees) {
  Play scene{.cloths = {test::tube_about_a_trunk()}, .settings = settings_of(8), .frames = 60};
  scene.settings.check_copies = true;
  scene.before_frame = [](Solver& solver, uint32_t frame) {
    solver.set_colliders(test::pressing_arms(static_cast<float>(frame) / 60));
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanBackendTest, SeveralClothsOfDifferentShapeStepTogether) {
  Material other;
  other.stretch_warp = 200;
  other.max_speed = 2;
  Play scene{.cloths = {cloth_of(kUncut), cloth_of(kCut, other), cloth_of({.nx = 30, .ny = 5, .width = 0.9F})},
             .settings = settings_of(4),
             .frames = 8};
  scene.cloths[1].transform = {.translate = {0, 2, 0}, .rotate = quat_from_euler_deg({0, 45, 0}), .scale = 0.5F};
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 2) solver.set_pins(0, pins_of_top(kUncut, *asset));
  };
  expect_same_as_cpu(scene);
}

/// A fast ball gives one of two cloths more substeps than the other has, which runs before it: pins of the first frame
/// would not hold.
TEST_F(VulkanBackendTest, PinsHoldFromTheFirstFrameOnWhereClothsHaveSubstepsOfTheirOwn) {
  Play scene{.cloths = {cloth_of(kUncut), cloth_of(kUncut)}, .settings = settings_of(3), .frames = 3};
  scene.cloths[0].transform.translate = {20, 0, 0};
  scene.before_frame = [asset = scene.cloths[1].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) solver.set_pins(1, pins_of_top(kUncut, *asset));
    const auto place = [&](float z) { solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, 0, z}, 0.1F}}}); };
    if (frame == 0) place(0.9F);
    place(0.6F - 0.3F * static_cast<float>(frame));
  };
  expect_same_as_cpu(scene);
}

/// A sheet with wind, a ball, attachments, and pins that come and go on a moving parent.
Play busy(const SheetOptions& sheet, const Material& material) {
  Play scene{.cloths = {cloth_of(sheet, material)}, .settings = settings_of(3)};
  scene.settings.check_copies = true;
  scene.frames = 5;
  scene.before_frame = [sheet, asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    std::vector<Pin> pins = pins_of_top(sheet, *asset, {0.02F * static_cast<float>(frame), 0, 0});
    if (frame == 2) pins.resize(sheet.nx / 3);
    pins[3].frequency = 5;  // drawn along softly
    solver.set_pins(0, pins);
    solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, -0.1F, 0.1F}, 0.15F}, 0.3F, {}}});
    if (frame == 1) solver.set_wind({.velocity = {1, 0, -5}, .turbulence = 0.5F, .lift = 0.2F});
    if (frame >= 2) solver.set_parent(0, {{0.01F * static_cast<float>(frame), 0, 0}, {}, 1}, {0.5F, 1, 1});
  };
  return scene;
}

Material limited(bool springs) {
  Material material;
  material.max_stretch = 0.01F;
  if (springs) material.stiffness = material.bend_stiffness = 0.8F;
  return material;
}

/// Wider and higher than a tile, so that what happens in a border matters.
TEST_F(VulkanBackendTest, TilesGiveWhatThePassesGive) {
  for (const uint32_t charts : {1U, 2U}) {
    SCOPED_TRACE(charts);
    Play scene = busy({.nx = 61, .ny = 43, .charts_x = charts, .gap = charts, .jitter = 0.3F}, limited(charts == 2));
    scene.settings.path = SolverPath::tiled;
    EXPECT_EQ(expect_same_as_cpu(scene).statistics.path, "tiled");
  }
}

TEST_F(VulkanBackendTest, AWorkGroupForEachClothGivesWhatThePassesGive) {
  Play scene = busy({.nx = 13, .ny = 11, .charts_x = 3, .charts_y = 2, .jitter = 0.3F}, limited(false));
  scene.cloths.push_back(cloth_of({.nx = 41, .ny = 20}, limited(true)));
  scene.settings.path = SolverPath::tiny;
  scene.settings.relaxation_steps = 2;
  EXPECT_EQ(expect_same_as_cpu(scene).statistics.path, "tiny");
}

// llvmpipe ends loops that go round too often in one dispatch, without a word: half of the frame's work was left out.
TEST_F(VulkanBackendTest, AWorkGroupHasTimeForAFrameOfManySubsteps) {
  Play scene = over_collider(Sphere{{}, 0.3F}, 1);
  scene.cloths = {cloth_of({.nx = 40, .ny = 25, .horizontal = true, .center = {0, 0.31F, 0}}, limited(false))};
  scene.settings.substeps = 32;
  scene.settings.path = SolverPath::tiny;
  EXPECT_EQ(expect_same_as_cpu(scene).statistics.path, "tiny");
}

TEST_F(VulkanBackendTest, WhatDoesNotFitAPathGoesThePlainWay) {
  Play scene = busy({.nx = 70, .ny = 70}, limited(false));  // more than 48 KiB of points
  scene.cloths.push_back(cloth_of(kUncut));
  scene.settings.path = SolverPath::tiny;
  const std::string path = make_solver(scene.cloths, scene.settings).statistics().path;
  EXPECT_TRUE(path == "plain, tiny" || path == "tiny") << path;
  scene.settings.path = SolverPath::tiled;
  scene.settings.relaxation_steps = 2;
  EXPECT_EQ(make_solver(scene.cloths, scene.settings).statistics().path, "plain");
}

TEST_F(VulkanBackendTest, FarFromTheWorldsOriginNothingIsLost) {
  Play scene = hanging(kCut);
  scene.cloths[0].transform.translate = {1000, 200, -3000};
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) solver.set_pins(0, pins_of_top(kCut, *asset, {1000, 200, -3000}));
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanBackendTest, TwoRunsGiveTheSameBits) {
  const Play scene = over_collider(Sphere{{}, 0.2F}, 10);
  const Outcome first = play(make_solver(scene.cloths, scene.settings), scene);
  const Outcome second = play(make_solver(scene.cloths, scene.settings), scene);
  const ClothAsset& asset = *scene.cloths[0].asset;
  EXPECT_EQ(hash_state(asset, first.positions[0]), hash_state(asset, second.positions[0]));
}

TEST_F(VulkanBackendTest, TheStartIsTheRestShapeWithItsNormals) {
  const ClothDesc cloth = cloth_of(kCut);
  Solver solver = make_solver(std::vector{cloth}, settings_of(4));
  std::vector<Vec3> positions, normals, expected;
  solver.read_positions(0, positions);
  solver.read_normals(0, normals);
  EXPECT_LE(largest_distance(positions, cloth.asset->rest_position), 1e-6);
  compute_normals(*cloth.asset, cloth.asset->rest_position, expected);
  EXPECT_LE(largest_distance(normals, expected), 1e-5);
}

TEST_F(VulkanBackendTest, AWrittenStateIsReadBackAndGoesOnFromThere) {
  Play scene = hanging(kCut);
  const ClothAsset& asset = *scene.cloths[0].asset;
  std::vector<Vec3> positions = asset.rest_position, velocities(positions.size());
  for (uint32_t i = 0; i < positions.size(); ++i) {
    if (!asset.valid(i)) continue;
    positions[i] += Vec3{0.25F, 0.5F, 0};
    velocities[i] = {0, 0, 1};
  }
  Solver solver = make_solver(scene.cloths, scene.settings);
  solver.step();
  solver.write_state(0, positions, velocities);
  std::vector<Vec3> read;
  solver.read_positions(0, read);
  EXPECT_LE(largest_distance(read, positions), 1e-6);
  solver.read_velocities(0, read);
  EXPECT_LE(largest_distance(read, velocities), 1e-2);
  solver.step();
  solver.read_positions(0, read);
  EXPECT_NEAR(read[0].z, positions[0].z + 1.F / 60, 2e-3);
}

TEST_F(VulkanBackendTest, ReadingEveryFrameChangesNothing) {
  const Play quiet = hanging(kCut);
  Play watched = quiet;
  watched.before_frame = [quiet](Solver& solver, uint32_t frame) {
    std::vector<Vec3> ignored;
    solver.read_positions(0, ignored);
    quiet.before_frame(solver, frame);
    solver.wait();
  };
  const Outcome a = play(make_solver(quiet.cloths, quiet.settings), quiet);
  const Outcome b = play(make_solver(watched.cloths, watched.settings), watched);
  EXPECT_EQ(hash_state(*quiet.cloths[0].asset, a.positions[0]), hash_state(*quiet.cloths[0].asset, b.positions[0]));
}

TEST_F(VulkanBackendTest, TimingsNameThePassesAndChangeNothing) {
  Play scene = hanging(kCut);
  const Outcome plain = play(make_solver(scene.cloths, scene.settings), scene);
  scene.settings.timings = true;
  const Outcome timed = play(make_solver(scene.cloths, scene.settings), scene);
  EXPECT_EQ(hash_state(*scene.cloths[0].asset, plain.positions[0]),
            hash_state(*scene.cloths[0].asset, timed.positions[0]));
  EXPECT_THAT(plain.statistics.passes, testing::IsEmpty());
  std::vector<std::string> names;
  for (const PassTiming& timing : timed.statistics.passes) {
    names.push_back(timing.pass);
    EXPECT_GT(timing.seconds, 0);
    EXPECT_LT(timing.seconds, 60);
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"predict", "pins", "structural", "shear", "stitch", "normals"}));
  EXPECT_EQ(timed.statistics.backend, "vulkan");
  EXPECT_EQ(timed.statistics.path, "plain");
  EXPECT_THAT(timed.statistics.device, testing::Not(testing::IsEmpty()));

  scene.settings.path = SolverPath::tiled;
  const Outcome tiled = play(make_solver(scene.cloths, scene.settings), scene);
  EXPECT_EQ(hash_state(*scene.cloths[0].asset, plain.positions[0]),
            hash_state(*scene.cloths[0].asset, tiled.positions[0]));
  names.clear();
  for (const PassTiming& timing : tiled.statistics.passes) names.push_back(timing.pass);
  EXPECT_THAT(names, testing::IsSupersetOf({"predict+pins+shear", "curvature+structural", "stitch", "normals"}));
}

// What is submitted without waiting in between, too.
TEST_F(VulkanBackendTest, ASheetWithoutContactAgreesToTheTenThousandthAfterASecondAndTwice) {
  for (const SheetOptions& sheet : {kUncut, kCut}) {
    Play scene = hanging(sheet);
    scene.frames = 60;
    const ClothAsset& asset = *scene.cloths[0].asset;
    const Outcome first = expect_same_as_cpu(scene, 1e-4);
    const Outcome second = play(make_solver(scene.cloths, scene.settings), scene);
    EXPECT_EQ(hash_state(asset, first.positions[0]), hash_state(asset, second.positions[0]));
  }
}

}  // namespace
}  // namespace geocloth
