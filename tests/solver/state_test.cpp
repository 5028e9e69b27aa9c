// SPDX-License-Identifier: GPL-3.0-or-later
// A solver goes back to a state that was saved and comes to the same bits again. Where anything is left out of it,
// games that roll back drift apart from each other, and replays show something else than what was played.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/machine.h"
#include "support/running_slab.h"

namespace geocloth {
namespace {

using test::make_sheet;
using Bytes = std::vector<std::byte>;

/// What a user sees of all cloths.
struct Sight {
  std::vector<std::vector<Vec3>> arrays;
  std::vector<bool> asleep;
  std::vector<CutResult> gone;  ///< springs and cells of the assets
  bool operator==(const Sight&) const = default;
};

Sight look(Solver& solver) {
  Sight sight;
  for (uint32_t c = 0; c < solver.cloth_count(); ++c) {
    sight.arrays.push_back(test::positions_of(solver, c));
    sight.arrays.push_back(test::velocities_of(solver, c));
    solver.read_normals(c, sight.arrays.emplace_back());
    sight.asleep.push_back(solver.asleep(c));
    const ClothAsset& asset = *solver.asset(c);
    const auto ones = [](const std::vector<uint8_t>& bits) {
      return static_cast<uint64_t>(std::count_if(bits.begin(), bits.end(), [](uint8_t b) { return b != 0; }));
    };
    sight.gone.push_back({ones(asset.spring_mask), ones(asset.cell), asset.splits.rows()});
  }
  return sight;
}

struct Scene {
  std::vector<ClothDesc> cloths;
  SolverSettings settings = {};
  std::function<void(Solver&, int)> before_frame = [](Solver&, int) {};
  int frames = 8, saved_at = 4;
  std::vector<Collider> bodies = {};  ///< of triangles, which are not saved
};

class State : public test::MachineTest<> {
 protected:
  Solver make_for(const Scene& scene) { return make(scene.cloths, scene.settings); }

  static void go_to(Solver& solver, const Scene& scene, int from, int to, std::vector<Sight>* seen = nullptr) {
    for (int f = from; f < to; ++f) {
      scene.before_frame(solver, f);
      solver.step();
      if (seen != nullptr) seen->push_back(look(solver));
    }
  }

  /// Plays a scene through, then back from where it was saved, there and in a solver that has seen nothing of it. Once
  /// it is saved before a frame is told anything, once after that.
  void comes_back(const Scene& scene) {
    for (const bool told : {false, true}) {
      if (machine().slow() && !told) continue;
      SCOPED_TRACE(told ? "told" : "not told");
      Solver solver = make_for(scene), other = make_for(scene);
      go_to(solver, scene, 0, scene.saved_at);
      if (told) scene.before_frame(solver, scene.saved_at);
      const Bytes state = solver.save();
      const auto go_on = [&](Solver& from) {
        std::vector<Sight> seen{look(from)};
        Scene rest = scene;
        rest.before_frame = [&](Solver& s, int f) {
          if (!told || f > scene.saved_at) scene.before_frame(s, f);
        };
        go_to(from, rest, scene.saved_at, scene.frames, &seen);
        return seen;
      };
      const std::vector<Sight> wanted = go_on(solver);
      ASSERT_FALSE(wanted.front() == wanted.back()) << "nothing moves";
      for (Solver* back : {&solver, &other}) {
        const char* const name = back == &solver ? "the same solver" : "another solver";
        if (!scene.bodies.empty()) back->set_colliders(scene.bodies);
        back->restore(state);
        EXPECT_EQ(back->save(), state) << name;
        expect_same(go_on(*back), wanted, name);
      }
      if (machine().slow()) continue;
      Solver never = make_for(scene);
      go_to(never, scene, 0, scene.saved_at);
      if (told) scene.before_frame(never, scene.saved_at);
      expect_same(go_on(never), wanted, "a solver that was never saved");
    }
  }

 private:
  static void expect_same(const std::vector<Sight>& seen, const std::vector<Sight>& wanted, const char* what) {
    ASSERT_EQ(seen.size(), wanted.size());
    for (size_t f = 0; f < seen.size(); ++f) ASSERT_TRUE(seen[f] == wanted[f]) << what << ", frame " << f;
  }
};

ClothDesc sheet(const test::SheetOptions& options, const Material& material = {}) {
  return test::describe(make_sheet(options), material);
}

const test::SheetOptions kSheet{.nx = 13, .ny = 11, .charts_x = 2, .charts_y = 2, .jitter = 0.2F};

/// Held ones and soft ones, on their way.
std::vector<Pin> swinging_pins(const ClothAsset& asset, int frame) {
  std::vector<Pin> pins = test::pins_at_rest(asset, "top", {0.02F * static_cast<float>(frame), 0, 0});
  pins.back().frequency = 6;
  pins.front().max_distance = 0.01F;
  const float turn = 0.1F * static_cast<float>(frame);
  pins.front().backstop = Backstop{{std::sin(turn), std::cos(turn), 0}, 0.002F};
  return pins;
}

Collider ball(float x, float z, const char* name = "ball") {
  return {name, Sphere{{0, 0, 0}, 0.15F}, 0.3F, {{x, 0, z}, {}, 1}};
}

/// Without bends, of another mass.
Material limp() {
  Material material;
  material.bend_warp = material.bend_weft = 0;
  material.areal_density = 0.1F;
  return material;
}

/// All that a frame may be told, at once.
Scene busy() {
  Scene scene;
  Material stiff;
  stiff.bend_warp = stiff.bend_weft = 1e-4F;
  scene.cloths = {sheet(kSheet), sheet({.nx = 12, .ny = 12, .horizontal = true}, stiff), sheet(kSheet)};
  scene.cloths[1].transform.translate = {0, 0.52F, 0};
  scene.cloths[1].inter_collision = InterCollision{};
  scene.cloths[1].self_collision = SelfCollision{};
  scene.cloths[2].transform.translate = {0.03F, 0.8F, 0};
  scene.cloths[2].transform.rotate = quat_from_euler_deg({70, 20, 0});
  scene.cloths[2].inter_collision = InterCollision{};
  scene.settings.substeps = 3;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, int f) {
    const auto t = static_cast<float>(f);
    solver.set_pins(0, swinging_pins(*asset, f));
    solver.set_wind({.velocity = {2, 0, 3}, .turbulence = 0.6F, .frequency = 2, .lift = 0.4F});
    solver.set_parent(2, {{0.01F * t, 0, 0.02F * t}, quat_from_euler_deg({0, 3 * t, 0}), 1}, {0.5F, 1, 0.2F});
    std::vector<Collider> all{ball(0.02F * t, 0.3F - 0.03F * t), {"box", Box{{0, -0.4F, 0}, {0.3F, 0.1F, 0.3F}, {}}}};
    if (f % 3 == 1) all.insert(all.begin(), {"", Capsule{{2, 0, 0}, {3, 0, 0}, 0.1F, 0.2F}, 0.1F, {}});
    if (f > 6)
      all.push_back({"hull", convex_hull(std::vector<Vec3>{{0, 1, 0}, {0, 1.2F, 0}, {0.2F, 1, 0}, {0, 1, 0.2F}})});
    all.back().groups = 2;
    solver.set_colliders(all);
    if (f == 5) solver.set_gravity({0, -9, 1});
    if (f % 4 == 2) solver.set_pressure(2, 0.5F * t);
    if (f == 3) solver.set_meets(1, 2);
    if (f == 4) solver.set_material(2, limp());
  };
  return scene;
}

class StateOnEveryPath : public State {};

TEST_P(State, PinsParentsCollidersGustsAndClothsThatMeet) {
  comes_back(busy());
}

TEST_P(StateOnEveryPath, AClothByItself) {
  Scene scene = busy();
  scene.cloths.resize(1);
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, int f) {
    solver.set_pins(0, swinging_pins(*asset, f));
    solver.set_colliders(std::vector{ball(0, 0.26F - 0.04F * static_cast<float>(f))});
  };
  comes_back(scene);
}

// What is told between two frames: pins set anew, a parent that jumps, a state that is written where it has jumped to.
TEST_P(State, WhatTheNextFrameIsToldIsSavedToo) {
  Scene scene;
  scene.cloths = {sheet({.nx = 9, .ny = 9, .charts_x = 2})};
  scene.settings.substeps = 4;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, int f) {
    const auto t = static_cast<float>(f);
    const Vec3 at{f < 4 ? 0 : 2.F, 0, 0};
    solver.set_parent(0, {at, quat_from_euler_deg({0, 5 * t, 0}), 1}, {0.5F, 0.5F, 0.5F}, f == 4);
    solver.set_pins(0, test::pins_at_rest(*asset, f % 2 == 0 ? "top" : "corners", at + Vec3{0, 0, 0.02F * t}));
    solver.set_colliders(std::vector{ball(at.x, 0.26F - 0.04F * t)}, f == 0);
    if (f != 6) return;
    std::vector<Vec3> x = asset->rest_position;
    for (Vec3& p : x) p += {3, 0, 0};
    solver.set_parent(0, {{3, 0, 0}, {}, 1}, {1, 1, 1}, true);
    solver.write_state(0, x, std::vector<Vec3>(x.size(), Vec3{0, 1, 0}));
    solver.set_pins(0, test::pins_at_rest(*asset, "top", {3, 0, 0}));
  };
  scene.frames = 9;
  for (scene.saved_at = machine().slow() ? 6 : 3; scene.saved_at < 7; ++scene.saved_at) {
    SCOPED_TRACE(scene.saved_at);
    comes_back(scene);
  }
}

TEST_P(State, ClothThatWasPulledApartDrawsItselfTogether) {
  Scene scene;
  scene.cloths = {sheet({.nx = 9, .ny = 9})};
  scene.settings.substeps = 4;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, int f) {
    std::vector<Pin> pins = test::pins_at_rest(*asset, "corners");
    if (f < 3) pins.back().target.x += 0.2F;
    solver.set_pins(0, pins);
  };
  scene.frames = machine().slow() ? 12 : 40;
  scene.saved_at = 6;
  comes_back(scene);
}

TEST_P(State, SelfCollisionKeepsItsNeighbours) {
  Scene scene;
  scene.cloths = {sheet({.nx = 16, .ny = 16, .width = 0.4F, .height = 0.4F, .charts_x = 2, .center = {0, 0.13F, 0}})};
  scene.cloths[0].transform.rotate = quat_from_euler_deg({4, 0, 3});
  scene.cloths[0].self_collision = SelfCollision{};
  scene.settings.substeps = 4;
  scene.before_frame = [](Solver& solver, int) {
    solver.set_colliders(std::vector<Collider>{{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, 0.3F, {}}});
  };
  scene.frames = machine().slow() ? 17 : 20;
  for (scene.saved_at = 14; scene.saved_at < (machine().slow() ? 15 : 17); ++scene.saved_at) comes_back(scene);
}

TEST_P(State, TinyStepsKeepWhatRoundingTakes) {
  for (const bool keep_momentum : {false, true}) {
    Scene scene = busy();
    scene.cloths.resize(1);
    scene.settings.frame_time = 0.001;
    scene.settings.substeps = 8;
    scene.settings.keep_momentum = keep_momentum;
    scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, int f) {
      if (f == 0) solver.set_pins(0, test::pins_at_rest(*asset, "top"));
    };
    comes_back(scene);
  }
}

TEST_P(State, StepsThatGoOverIntoOthersAndSeveralRelaxationSteps) {
  Scene scene = busy();
  scene.settings.relaxation_steps = 2;
  scene.before_frame = [before = scene.before_frame](Solver& solver, int f) {
    before(solver, f);
    if (f == 2) solver.set_time_step(1.0 / 30, 6);
    if (f == 5) solver.set_time_step(1.0 / 50, 5);
  };
  comes_back(scene);
}

TEST_P(State, SleepersSleepOnAndFallAsleepInTheSameFrame) {
  Scene scene;
  Material material;
  material.damping = 25;
  scene.cloths = std::vector<ClothDesc>(2, sheet({.nx = 8, .ny = 8}, material));
  scene.cloths[1].transform.translate = {2, 0, 0};
  scene.settings.substeps = 2;
  scene.settings.sleep_speed = 0.05F;
  scene.settings.sleep_time = 0.1F;
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, int f) {
    for (uint32_t c = 0; c < 2; ++c)
      solver.set_pins(c, test::pins_at_rest(*asset, "top", {2.F * static_cast<float>(c), 0, 0}));
    solver.set_colliders(std::vector{ball(0.5F, 1 - 0.02F * static_cast<float>(std::max(0, f - 50)))});
  };
  scene.frames = 90;
  Solver solver = make_for(scene);
  int asleep = 0;
  while (asleep < 80 && !solver.asleep(0)) go_to(solver, scene, asleep, asleep + 1), ++asleep;
  ASSERT_LT(asleep, 45);
  for (const int at : {asleep - 1, asleep - 3, asleep, 48, 80}) {
    SCOPED_TRACE(at);
    if (machine().slow() && at != asleep - 1) continue;
    if (machine().slow()) scene.frames = asleep + 2;
    scene.saved_at = at;
    comes_back(scene);
  }
}

TEST_P(State, WhatCarriesAClothIsKnown) {
  Scene scene;
  scene.cloths = {sheet(test::sheet_on_slab(), test::cloth_on_slab())};
  scene.settings = test::eight_substeps();
  scene.before_frame = [](Solver& solver, int f) {
    solver.set_colliders(std::vector{test::slab(4 * test::kFrame * static_cast<float>(f))}, f == 0);
  };
  scene.frames = machine().slow() ? 20 : 60;
  scene.saved_at = scene.frames - 4;
  comes_back(scene);
}

TEST_P(State, WhereClothWasSeenWhenAColliderWasFastIsKnown) {
  Scene scene;
  scene.cloths = {sheet({.nx = 9, .ny = 9})};
  scene.settings.substeps = 2;
  scene.before_frame = [](Solver& solver, int f) {
    solver.set_colliders(std::vector{ball(0, 0.3F * static_cast<float>(f) - 4)});
  };
  scene.frames = 14;
  for (const int at : {4, 9, 12}) {
    SCOPED_TRACE(at);
    if (machine().slow() && at != 9) continue;
    scene.saved_at = at;
    comes_back(scene);
  }
}

TEST_P(State, FarFromWhereItBeganAndAfterAJump) {
  Scene scene = busy();
  scene.before_frame = [asset = scene.cloths[0].asset](Solver& solver, int f) {
    const Vec3 away{9.F * static_cast<float>(f), 0, 0};
    solver.set_pins(0, test::pins_at_rest(*asset, "top", away));
    solver.set_parent(2, {away + Vec3{0, 40, 0}, {}, 1}, {1, 1, 1}, f == 4 || f == 6);
    solver.set_colliders(std::vector{ball(9.F * static_cast<float>(std::min(f, 2)), 0)});  // where free cloth is seen
  };
  comes_back(scene);
}

std::array<Vec3, 3> level_cut(float y) {
  return {Vec3{-3, y, -2}, Vec3{3, y, -2}, Vec3{0, y, 4}};
}

// Saved before a cut, between two, and after them.
TEST_P(State, CutsAreUndoneAndMadeAgain) {
  Scene scene = busy();
  scene.cloths[0].self_collision = SelfCollision{};
  scene.before_frame = [before = scene.before_frame](Solver& solver, int f) {
    before(solver, f);
    uint64_t severed = 1;
    if (f == 3) severed = solver.cut(0, level_cut(0.13F)).springs;
    if (f == 5) severed = solver.cut(2, {Vec3{0, -3, -3}, Vec3{0, -3, 3}, Vec3{0, 6, 0}}).springs;
    EXPECT_GT(severed, 0U);
  };
  for (const int at : {4, 2, 6}) {
    SCOPED_TRACE(at);
    if (machine().slow() && at != 4) continue;
    scene.saved_at = at;
    comes_back(scene);
  }
}

/// Of a cube.
Collider body(float size) {
  TriangleSurface cube;
  for (uint32_t i = 0; i < 8; ++i) {
    const auto side = [&](uint32_t bit) { return (i & bit) != 0 ? size : -size; };
    cube.position.push_back({side(1), side(2), side(4)});
  }
  for (const auto& [a, b, c, d] : std::vector<std::array<uint32_t, 4>>{
           {0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    cube.triangle.push_back({a, b, c});
    cube.triangle.push_back({a, c, d});
  }
  return {"body", MeshSolid{std::make_shared<const DistanceField>(make_distance_field(cube, 8000))}, 0.3F, {}};
}

TEST_P(State, BodiesOfTrianglesHaveToBeThere) {
  Scene scene;
  scene.cloths = {sheet(kSheet)};
  scene.settings.substeps = 4;
  const Collider cube = body(0.1F);
  scene.before_frame = [cube](Solver& solver, int f) {
    Collider moved = cube;
    moved.pose.translate = {0, 0.02F * static_cast<float>(f) - 0.8F, 0};
    solver.set_colliders(std::vector{moved});
  };
  scene.bodies = {ball(9, 9), cube};
  comes_back(scene);

  Solver solver = make_for(scene), other = make_for(scene);
  go_to(solver, scene, 0, 2);
  const Bytes state = solver.save();
  other.set_colliders(std::vector{body(0.2F)});
  try {
    other.restore(state);
    FAIL() << "another body";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_data);
    EXPECT_THAT(error.what(), testing::HasSubstr("colliders[0] \"body\" is a body of triangles"));
  }
}

/// @return what is said
std::string refusal(Solver& solver, std::span<const std::byte> state) {
  try {
    solver.restore(state);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_data) << error.what();
    // Once: what was refused below a check was begun with it twice.
    EXPECT_EQ(std::string(error.what()).rfind("saved state: "), 0U) << error.what();
    return error.what();
  }
  return "";
}

TEST_P(State, OfOthersIsRefusedAndLeavesTheSolverAsItIs) {
  Scene scene = busy();
  Solver solver = make_for(scene);
  go_to(solver, scene, 0, 3);
  const Bytes before = solver.save();
  const auto refused = [&](const Scene& other, const char* why) {
    const Bytes state = make_for(other).save();
    EXPECT_THAT(refusal(solver, state), testing::HasSubstr(why));
    EXPECT_EQ(solver.save(), before) << why;
  };
  const auto changed = [&](const std::function<void(Scene&)>& change) {
    Scene other = scene;
    change(other);
    return other;
  };
  refused(changed([](Scene& s) { s.cloths.pop_back(); }), "it has 2 cloths, the solver has 3");
  refused(changed([](Scene& s) { s.cloths[2] = sheet({.nx = 5, .ny = 5}); }), "cloth 2 was made with another asset");
  refused(changed([](Scene& s) { s.cloths[0].transform.scale = 2; }), "cloth 0 was made with another asset");
  refused(changed([](Scene& s) { s.cloths[1].self_collision.reset(); }), "cloth 1 was made with another asset");
  refused(changed([](Scene& s) { s.settings.relaxation_steps = 3; }), "relaxation_steps");
  refused(changed([](Scene& s) { s.settings.sleep_speed = 1; }), "sleep_speed");
  refused(changed([](Scene& s) { s.settings.keep_momentum = true; }), "keep_momentum");
  refused(changed([](Scene& s) { s.settings.imperfection = 1e-6F; }), "imperfection");
  EXPECT_THAT(refusal(solver, {}), testing::HasSubstr("it ends after 0 bytes"));
  Bytes bytes = before;
  bytes[0] = std::byte{0};
  EXPECT_THAT(refusal(solver, bytes), testing::HasSubstr("it does not begin as one"));
  bytes = before;
  bytes[4] = std::byte{200};
  EXPECT_THAT(refusal(solver, bytes), testing::HasSubstr("it has version 200, this library reads version 11"));
  bytes = before;
  bytes.push_back({});
  EXPECT_THAT(refusal(solver, bytes), testing::HasSubstr("1 bytes too many"));
  EXPECT_EQ(solver.save(), before);
}

// Saves come over networks and from disks that lie.
TEST_P(State, DamagedIsRefusedOrHarmless) {
  Scene scene;
  scene.cloths = {sheet({.nx = 7, .ny = 6, .charts_x = 2}), sheet({.nx = 6, .ny = 6})};
  for (ClothDesc& cloth : scene.cloths) {
    cloth.inter_collision = InterCollision{};
    cloth.self_collision = SelfCollision{};
  }
  scene.cloths[1].transform.translate = {0, 0, 0.05F};
  scene.settings.substeps = 2;
  Solver solver = make_for(scene);
  const std::vector<Collider> solids{
      ball(0, 0.2F), {"hull", convex_hull(std::vector<Vec3>{{0, 1, 0}, {0, 2, 0}, {1, 1, 0}, {0, 1, 1}})}};
  for (int f = 0; f < 3; ++f) {
    solver.set_pins(0, swinging_pins(*scene.cloths[0].asset, f));
    solver.set_parent(1, {{0, 0, 0.1F * static_cast<float>(f)}, {}, 1});
    solver.set_colliders(solids);
    solver.set_wind({.velocity = {1, 0, 0}});
    if (f == 1) solver.cut(0, level_cut(0.07F));
    solver.step();
  }
  const Bytes good = solver.save();
  const size_t stride = machine().slow() ? 211 : 17;
  for (size_t length = 0; length < good.size(); length += stride)
    EXPECT_NE(refusal(solver, std::span(good).first(length)), "") << length;
  std::mt19937 random(3);
  int taken = 0, refused = 0;
  const int tries = machine().slow() ? 40 : 4000;
  for (int n = 0; n < tries; ++n) {
    Bytes bad = good;
    // Most of the bytes are points; what is counted and chosen lies before and behind them.
    const size_t near_head = random() % std::min<size_t>(bad.size(), 4000);
    const size_t at = n % 2 == 0 ? near_head : random() % bad.size();
    const auto value = static_cast<uint32_t>(n % 3 == 0 ? 0xFFFFFFFFU : n % 3 == 1 ? random() : random() % 64);
    const size_t width = n % 5 == 0 ? 1 : sizeof(value);
    std::memcpy(bad.data() + std::min(at, bad.size() - width), &value, width);
    if (!refusal(solver, bad).empty()) {
      ++refused;
      continue;
    }
    ++taken;
    solver.step();
    solver.step();
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(taken, 0);
  solver.restore(good);
  EXPECT_EQ(solver.save(), good);
}

// A server on one backend and a player on the other.
TEST_P(State, GoesFromTheCpuToADevice) {
  if (machine().backend == Backend::cpu) GTEST_SKIP() << "of devices";
  const Scene scene = busy();
  Solver cpu = test::make_cpu_solver(scene.cloths, scene.settings), device = make_for(scene);
  if (device.statistics().device.find("llvmpipe") == std::string::npos) GTEST_SKIP() << "its roots are others";
  go_to(cpu, scene, 0, 4);
  const Bytes state = cpu.save();
  device.restore(state);
  EXPECT_EQ(device.save(), state);
  go_to(cpu, scene, 4, 6);
  go_to(device, scene, 4, 6);
  EXPECT_EQ(device.save(), cpu.save());
}

INSTANTIATE_TEST_SUITE_P(On, State, test::first_machine(), test::kMachineName);
INSTANTIATE_TEST_SUITE_P(On, StateOnEveryPath, test::every_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
