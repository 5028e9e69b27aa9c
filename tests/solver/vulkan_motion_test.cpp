// SPDX-License-Identifier: GPL-3.0-or-later
// What a scene may hold besides springs and simple colliders, on both backends: soft pins, moving parents, hulls and
// bodies, triangles that hold what is thinner than a pixel, steps that change and steps that are tiny.
#include <cmath>

#include "geocloth/solver/solid.h"
#include "support/ball_surface.h"
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
using test::Play;
using test::settings_of;
using test::SheetOptions;
using VulkanMotionTest = test::VulkanBackendTest;

TEST_F(VulkanMotionTest, SoftPinsThatMoveAgree) {
  Play scene = hanging(kCut);
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    std::vector<Pin> pins = pins_of_top(kCut, *asset, {0, 0, 0.02F * static_cast<float>(frame)});
    for (size_t k = 0; k < pins.size(); ++k) pins[k].frequency = k % 3 == 0 ? 0.F : 4.F;
    solver.set_pins(0, pins);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanMotionTest, PinsWithADistanceAgree) {
  Play scene = hanging(kCut);
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    std::vector<Pin> pins = pins_of_top(kCut, *asset, {0, 0, 0.02F * static_cast<float>(frame)});
    for (size_t k = 0; k < pins.size(); ++k) {
      pins[k].max_distance = k % 2 == 0 ? 0.01F : 0.F;
      pins[k].frequency = k % 3 == 0 ? 2.F : 0.F;
    }
    solver.set_pins(0, pins);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanMotionTest, BackstopsThatTurnAgree) {
  Play scene = hanging(kCut);
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    std::vector<Pin> pins = pins_of_top(kCut, *asset, {0, 0, 0.02F * static_cast<float>(frame)});
    const Vec3 outward = rotate(quat_from_euler_deg({10 * static_cast<float>(frame), 0, 0}), {0, 1, 0});
    for (Pin& pin : pins) {
      pin.max_distance = 0.02F;
      pin.backstop = Backstop{outward, 0.003F, 0.05F};
    }
    solver.set_pins(0, pins);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanMotionTest, PressureAgreesAlsoOverSeams) {
  Play scene = hanging(kCut);
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) solver.set_pins(0, pins_of_top(kCut, *asset));
    solver.set_pressure(0, frame < 4 ? 3.F : -2.F);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanMotionTest, AParentThatTurnsWithInertiaAndWindAgrees) {
  Play scene = hanging(kCut);
  scene.frames = 8;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    const float t = static_cast<float>(frame);
    const Transform pose{{0.02F * t, 0.1F, -0.01F * t}, quat_from_euler_deg({t, 6 * t, 0}), 1};
    solver.set_parent(0, pose, {0.3F, 0.6F, 1}, frame == 5);
    std::vector<Pin> pins = pins_of_top(kCut, *asset);
    for (Pin& pin : pins) pin.target = apply(pose, pin.target);
    solver.set_pins(0, pins);
    solver.set_wind({.velocity = {2, 0, 1}, .turbulence = 0.5F, .frequency = 2, .drag = 1, .lift = 0.3F});
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanMotionTest, PinsThatRideOnAParentThatTurnsAgree) {
  Play scene = hanging(kCut);
  scene.frames = 8;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    const float t = static_cast<float>(frame);
    const Transform pose{{0.02F * t, 0.1F, -0.01F * t}, quat_from_euler_deg({5 * t, 15 * t, 0}), 1};
    solver.set_parent(0, pose, {0.3F, 0.6F, 0});
    std::vector<Pin> pins = pins_of_top(kCut, *asset);
    for (size_t k = 0; k < pins.size(); ++k) {
      if (k % 5 != 0) pins[k].target = apply(pose, pins[k].target);
      if (k % 3 == 0) pins[k].frequency = 4;
      if (k % 4 == 0) pins[k].max_distance = 0.01F;
    }
    solver.set_pins(0, pins);
  };
  expect_same_as_cpu(scene);
}

/// A sheet falls on a collider that comes up and turns.
Play falls_on(const ColliderShape& shape, float lift) {
  SheetOptions options = kCut;
  options.horizontal = true;
  options.center = {0, 0.25F, 0};
  Play scene{.cloths = {cloth_of(options)}, .settings = settings_of(6), .frames = 16};
  scene.settings.check_copies = true;
  scene.before_frame = [shape, lift](Solver& solver, uint32_t frame) {
    const float t = static_cast<float>(frame) / 60.F;
    solver.set_colliders(std::vector<Collider>{
        {.name = "it",
         .shape = shape,
         .friction = 0.4F,
         .pose = {.translate = {0.1F * t, lift * t, 0}, .rotate = quat_from_euler_deg({10 * t, 60 * t, 0})}}});
  };
  return scene;
}

TEST_F(VulkanMotionTest, AHullAndABodyAgreeAndNothingSinksIn) {
  const Convex hull = convex_hull(
      std::vector<Vec3>{{-0.2F, 0, -0.2F}, {0.2F, 0, -0.2F}, {0.2F, 0, 0.2F}, {-0.2F, 0, 0.2F}, {0, 0.2F, 0.05F}});
  const MeshSolid body{
      std::make_shared<const DistanceField>(make_distance_field(test::ball_surface({}, 0.2F, 16, 8), 8'000))};
  for (const ColliderShape& shape : {ColliderShape{hull}, ColliderShape{body}}) {
    const Outcome outcome = expect_same_as_cpu(falls_on(shape, 0.5F));
    EXPECT_LE(outcome.statistics.penetration, double{Material{}.thickness});
  }
}

/// Which swells, goes along and turns, as a pose of its own takes it further.
TEST_F(VulkanMotionTest, ABodyThatDeformsAgrees) {
  Play scene = falls_on(Sphere{}, 0);
  scene.before_frame = [rest = test::ball_surface({}, 0.2F, 16, 8)](Solver& solver, uint32_t frame) {
    const auto at = [&](float t) {
      TriangleSurface surface = rest;
      const Transform pose{{0.004F * t, 0, 0.002F * t}, quat_from_euler_deg({0, t, 0.5F * t}), 1};
      for (Vec3& p : surface.position) p = apply(pose, (1 + 0.01F * t) * p);
      return surface;
    };
    const auto t = static_cast<float>(frame);
    const MeshSolid body{std::make_shared<const DistanceField>(make_deforming_field(at(t), at(t - 1).position, 0.03F))};
    const Transform pose{{0, 0.004F * t, 0}, quat_from_euler_deg({0.5F * t, 0, 0}), 1};
    solver.set_colliders(std::vector<Collider>{{"it", body, 0.4F, pose}});
  };
  const Outcome outcome = expect_same_as_cpu(scene);
  EXPECT_LE(outcome.statistics.penetration, double{Material{}.thickness});
}

TEST_F(VulkanMotionTest, ARodThinnerThanAPixelIsHeldByTheTrianglesAlike) {
  const Outcome outcome = expect_same_as_cpu(falls_on(Capsule{{-1, 0, 0.03F}, {1, 0, 0.03F}, 0.01F, 0.01F}, 3));
  EXPECT_EQ(outcome.statistics.copy_gap, 0.0);
}

/// Cloths with other numbers of substeps in one frame, of which one falls freely, and pins that change in such a frame.
TEST_F(VulkanMotionTest, AFastBallBesideOtherClothsAgrees) {
  Play scene{.cloths = {cloth_of(kCut), cloth_of(kUncut), cloth_of(kUncut)}, .settings = settings_of(3), .frames = 9};
  for (uint32_t c = 0; c < 3; ++c) scene.cloths[c].transform.translate = {3.F * static_cast<float>(c), 0, 0};
  scene.settings.check_copies = true;
  scene.settings.sleep_speed = 1e-3F;
  scene.before_frame = [cloths = scene.cloths](Solver& solver, uint32_t frame) {
    for (uint32_t c = 0; c < 2; ++c) {
      std::vector<Pin> pins =
          pins_of_top(c == 0 ? kCut : kUncut, *cloths[c].asset, {3.F * static_cast<float>(c), 0, 0});
      if (frame == 5) pins.pop_back();
      solver.set_pins(c, pins);
    }
    solver.set_colliders(std::vector<Collider>{
        {"ball", Sphere{{0, 0, 0}, 0.1F}, 0.3F, {{0, 0, 0.1F * static_cast<float>(frame) - 0.5F}, {}, 1}}});
  };
  expect_same_as_cpu(scene);
}

/// The origin follows it, whole metres at a time.
TEST_F(VulkanMotionTest, AParentThatGoesFarAgrees) {
  Play scene = hanging(kCut);
  scene.frames = 10;
  scene.settings.check_copies = true;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    const Vec3 way{0.9F * static_cast<float>(frame), 0.3F * static_cast<float>(frame), 0};
    solver.set_pins(0, pins_of_top(kCut, *asset, way));
    solver.set_parent(0, {way, {}, 1}, {0.2F, 0.2F, 0.2F}, frame == 7);
  };
  EXPECT_EQ(expect_same_as_cpu(scene).statistics.copy_gap, 0.0);
}

TEST_F(VulkanMotionTest, StepsThatChangeAgree) {
  Play scene = hanging(kCut);
  scene.frames = 8;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
    if (frame == 0) solver.set_pins(0, pins_of_top(kCut, *asset));
    solver.set_time_step(frame % 2 == 0 ? 1.0 / 60 : 1.0 / 40, 3 + frame % 3);
  };
  expect_same_as_cpu(scene);
}

TEST_F(VulkanMotionTest, TinyStepsAgree) {
  for (const bool momentum : {false, true}) {
    Material stiff;
    stiff.bend_warp = stiff.bend_weft = 1e-3F;
    Play scene = hanging(kCut, stiff);
    scene.settings.substeps = 4;
    scene.settings.frame_time = 4.0 / 14400;
    scene.settings.keep_momentum = momentum;
    scene.settings.check_copies = true;
    scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, uint32_t frame) {
      std::vector<Pin> pins = pins_of_top(kCut, *asset, {0, 0, 1e-3F * static_cast<float>(frame)});
      pins.back().frequency = 10;
      solver.set_pins(0, pins);
      solver.set_colliders(std::vector<Collider>{{.name = "ball", .shape = Sphere{{0, 0, 0.1F}, 0.0999F}}});
    };
    const Outcome outcome = expect_same_as_cpu(scene);
    EXPECT_EQ(outcome.statistics.copy_gap, 0.0);
  }
}

}  // namespace
}  // namespace geocloth
