// SPDX-License-Identifier: GPL-3.0-or-later
// The fast path of the cpu gives the bits of the plain one, which runs the shaders' own text pass by pass: on sheets,
// cut cloth and masked charts, with everything that a scene can have, for any number of threads.

#include <array>
#include <chrono>
#include <cstring>
#include <random>

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "solver_fixture.h"
#include "support/vector_targets.h"

namespace geocloth {
namespace {

using test::make_sheet;

/// A scene as the solver's user sets it up.
struct Case {
  const char* name;
  ClothAsset asset;
  Material material;
  SolverSettings settings;
  std::vector<Collider> colliders;
  std::optional<Wind> wind;
  const char* pinned = "corners";
  bool on_parent = false;
  float pin_frequency = 0;
  float pin_distance = 0;       ///< [m]
  bool every_pin = false;       ///< on most of the points, of every kind
  float pressure = 0;           ///< [Pa]
  float collider_step = 0.01F;  ///< [m] of all colliders in a frame
};

struct State {
  std::vector<Vec3> positions, velocities, normals;
  SolverStatistics statistics;
};

/// Runs of pins of any length, of kinds that change within them; they move from frame to frame.
std::vector<Pin> pins_of_every_kind(const ClothAsset& asset, uint32_t frame) {
  std::mt19937 random(11);
  const Vec3 way = static_cast<float>(frame) * Vec3{0.004F, 0.01F, -0.006F};
  std::vector<Pin> pins;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    const uint32_t kind = random() % 16;
    const bool in_a_gap = p / 37 % 3 == 0 && kind < 4;
    if (!asset.valid(p) || in_a_gap) continue;
    Pin pin{.pixel = p, .target = asset.rest_position[p] + way};
    if (kind == 5) {  // held
      pins.push_back(pin);
      continue;
    }
    if (kind % 3 == 0) pin.frequency = 2 + static_cast<float>(kind);
    if (kind % 3 != 0 || kind > 8) pin.max_distance = 0.005F * static_cast<float>(1 + kind % 5);
    if (kind % 2 == 0) pin.backstop = Backstop{{0.6F, 0, 0.8F}, 0.002F, kind > 6 ? 0.5F : 0.02F};
    pins.push_back(pin);
  }
  return pins;
}

State state_after(const Case& c, bool plain, uint32_t threads, uint32_t frames) {
  SolverSettings settings = c.settings;
  settings.backend = Backend::cpu;
  if (plain) settings.path = SolverPath::plain;
  settings.threads = threads;
  settings.check_copies = settings.timings = threads != 2;
  Solver solver(std::vector{test::describe(c.asset, c.material)}, settings);
  solver.set_pins(0, test::pins_at_rest(c.asset, c.pinned));
  if (c.wind) solver.set_wind(*c.wind);
  solver.set_pressure(0, c.pressure);
  for (uint32_t f = 0; f < frames; ++f) {
    const float t = 0.02F * static_cast<float>(f);
    const Transform parent{{t, 0, -t}, quat_from_euler_deg({0, 90 * t, 0}), 1};
    if (c.on_parent && f > 2 && f < 10) solver.set_parent(0, parent, {0.5F, 1, 0});  // stands still before and after
    std::vector<Collider> colliders = c.colliders;
    for (Collider& collider : colliders) collider.pose.translate = {0, 0, c.collider_step * static_cast<float>(f)};
    solver.set_colliders(colliders);
    if (c.every_pin) {
      std::vector<Pin> pins = pins_of_every_kind(c.asset, f);
      if (c.on_parent)
        for (Pin& pin : pins)
          if (pin.pixel % 7 < 5) pin.target = apply(parent, c.asset.rest_position[pin.pixel]);
      solver.set_pins(0, pins);
    }
    // Halfway one corner is let go and the other is pulled.
    if (f == frames / 2 && !c.every_pin) {
      std::vector<Pin> pins = test::pins_at_rest(c.asset, c.pinned, {0, 0.05F, 0.02F});
      pins.resize((pins.size() + 1) / 2);
      for (size_t k = 0; k < pins.size(); k += 2) {  // others are still held
        pins[k].frequency = c.pin_frequency;
        pins[k].max_distance = c.pin_distance;
      }
      solver.set_pins(0, pins);
    }
    solver.step();
  }
  State state;
  solver.read_positions(0, state.positions);
  solver.read_velocities(0, state.velocities);
  solver.read_normals(0, state.normals);
  state.statistics = solver.statistics();
  return state;
}

/// Number of values whose bits differ; negative and positive zero do.
size_t differences(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  size_t count = a.size() == b.size() ? 0 : 1;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    count += static_cast<size_t>(std::memcmp(&a[i], &b[i], sizeof(Vec3)) != 0);
  return count;
}

/// Takes pixels away at random, with their springs and triangles: charts with ragged outlines, holes and islands.
ClothAsset with_holes(ClothAsset asset, double share) {
  std::mt19937 random(7);
  std::vector<bool> kept(asset.pixel_count());
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    const bool pinned = p < asset.width || asset.binding[0].pixel[0] == p;
    kept[p] = asset.valid(p) && (pinned || static_cast<double>(random()) > share * 4294967295.0);
  }
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!kept[p]) {
      asset.chart[p] = kNoChart;
      asset.rest_position[p] = {};
      asset.area[p] = 0;
      asset.spring_mask[p] = asset.cell[p] = 0;
      continue;
    }
    for (uint32_t s = 0; s < kSpringCount; ++s) {
      if ((asset.spring_mask[p] & (1U << s)) == 0) continue;
      const int64_t q = int64_t{p} + kSpringOffset[s][0] + int64_t{asset.width} * kSpringOffset[s][1];
      if (!kept[static_cast<size_t>(q)]) asset.spring_mask[p] &= static_cast<uint8_t>(~(1U << s));
    }
    if (asset.cell[p] == 0) continue;
    for (const uint32_t q : {p + 1, p + asset.width, p + asset.width + 1})
      if (!kept[q]) asset.cell[p] = 0;
  }
  // The source mesh is bound to the pixels of the first row, which are all kept.
  for (Binding& binding : asset.binding) binding = {.pixel = {0, 1, 2}, .weight = {1, 0, 0}, .offset = {}};
  for (uint32_t k = 0; k < asset.width; ++k) asset.binding[k].pixel = {k, k > 0 ? k - 1 : 1, k > 1 ? k - 2 : 2};
  return asset;
}

Material stiff() {
  Material material;
  material.stiffness = 0.9F;
  material.bend_stiffness = 0.4F;
  material.verlet_damping = 0.995F;
  return material;
}
Material attached() {
  Material material;
  material.max_stretch = 0.02F;
  return material;
}
/// Every projection removes all of its spring's error, and attachments are taut.
Material hung() {
  Material material;
  material.stiffness = material.bend_stiffness = 1;
  material.max_stretch = 0.002F;
  return material;
}
/// As stiff in bending at 45 degrees as along warp and weft.
Material without_grain() {
  Material material;
  material.bend_warp = material.bend_weft = material.bend_bias = 2e-5F;
  return material;
}
/// So rigid beside its springs that a fourth point takes up where a bend turns within the sheet.
Material rigid() {
  Material material = attached();
  material.bend_warp = material.bend_weft = 0.05F;
  return material;
}
std::vector<Collider> all_shapes() {
  return {
      {"floor", Plane{{0, -0.45F, 0}, {0.6F, 0.8F, 0}}, 0.4F, {}},
      {"ball", Sphere{{0, -0.1F, -0.1F}, 0.15F}, 0.3F, {}},
      {"arm", Capsule{{-0.4F, 0.1F, 0.05F}, {-0.2F, -0.2F, 0.1F}, 0.08F, 0.05F}, 0.3F, {}},
      {"box", Box{{0.3F, -0.2F, 0.05F}, {0.1F, 0.05F, 0.1F}, {}}, 0, {}},
      {"egg", Ellipsoid{{0.3F, 0.3F, 0.1F}, {0.1F, 0.05F, 0.08F}, {}}, 1, {}},
      {"stone",
       convex_hull(std::vector<Vec3>{{-0.1F, 0.2F, -0.1F}, {0.1F, 0.2F, -0.1F}, {0, 0.4F, -0.1F}, {0, 0.3F, 0.05F}}),
       0.5F,
       {}}};
}

/// A body of eight triangles.
MeshSolid octahedron(float radius) {
  const float r = radius;
  const std::vector<Vec3> points{{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  const std::vector<std::array<uint32_t, 3>> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                                   {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return {std::make_shared<const DistanceField>(make_distance_field({points, faces}, 8'000))};
}
/// Thinner than the spacing of the sheets here, so that cells meet colliders too.
std::vector<Collider> body_and_wire() {
  return {{"body", octahedron(0.2F), 0.3F, {}},
          {"wire", Capsule{{-0.5F, -0.2F, -0.02F}, {0.5F, -0.1F, -0.02F}, 0.003F}, 0.3F, {}},
          {"needle", Ellipsoid{{0.2F, 0.2F, 0.02F}, {0.1F, 0.004F, 0.004F}, {}}, 0.3F, {}},
          {"plate", Box{{-0.2F, 0.3F, -0.03F}, {0.15F, 0.05F, 0.004F}, quat_from_euler_deg({60, 10, 0})}, 0.3F, {}},
          {"tack",
           convex_hull(std::vector<Vec3>{
               {0.3F, -0.3F, 0.02F}, {0.35F, -0.3F, -0.2F}, {0.27F, -0.26F, -0.2F}, {0.28F, -0.35F, -0.2F}}),
           0.3F,
           {}}};
}

SolverSettings few_substeps(uint32_t relaxation_steps = 1) {
  SolverSettings settings;
  settings.substeps = 5;
  settings.relaxation_steps = relaxation_steps;
  return settings;
}

std::vector<Case> cases() {
  const Wind breeze{{1, 0, 2}, 0.3F, 1, 1, 0.2F};
  std::vector<Case> list;
  list.push_back({"curvature", make_sheet({.nx = 61, .ny = 47, .jitter = 0.2F}), {}, few_substeps(), {}, {}});
  list.push_back({"bending on the bias",
                  make_sheet({.nx = 45, .ny = 37, .charts_x = 2}),
                  without_grain(),
                  few_substeps(),
                  all_shapes(),
                  {}});
  list.push_back({"springs over two pixels", make_sheet({.nx = 64, .ny = 33}), stiff(), few_substeps(), {}, {}});
  list.push_back({"ball",
                  make_sheet({.nx = 70, .ny = 50, .horizontal = true}),
                  attached(),
                  few_substeps(),
                  {{"ball", Sphere{{0, -0.2F, 0}, 0.2F}, 0.3F, {}}},
                  {},
                  "top"});
  list.push_back({"all colliders", make_sheet({.nx = 53, .ny = 55}), attached(), few_substeps(), all_shapes(), breeze});
  // Four degrees apart: half of the sheet begins deep in both.
  list.push_back({"cleft",
                  make_sheet({.nx = 45, .ny = 20, .width = 0.1F, .charts_x = 2, .horizontal = true}),
                  attached(),
                  few_substeps(),
                  {{"below", Plane{{}, {0.0349F, 0.99939F, 0}}, 0.3F, {}},
                   {"above", Plane{{}, {0.0349F, -0.99939F, 0}}, 0.3F, {}},
                   {"ball", Sphere{{0.1F, 0, 0.3F}, 0.1F}, 0.3F, {}}},
                  {}});
  list.back().collider_step = 0.001F;
  list.push_back({"wind", make_sheet({.nx = 80, .ny = 20}), {}, few_substeps(), {}, breeze, "top"});
  list.push_back({"seams", make_sheet({.nx = 60, .ny = 45, .charts_x = 3, .charts_y = 2, .gap = 3}), attached(),
                  few_substeps(), all_shapes(), breeze});
  list.push_back({"rigid cloth with seams that lines turn at",
                  make_sheet({.nx = 50, .ny = 40, .charts_x = 3, .charts_y = 2, .jitter = 0.3F}),
                  rigid(),
                  few_substeps(),
                  all_shapes(),
                  {}});
  list.push_back(
      {"holes", with_holes(make_sheet({.nx = 90, .ny = 40}), 0.15), attached(), few_substeps(), all_shapes(), breeze});
  list.push_back({"islands", with_holes(make_sheet({.nx = 77, .ny = 40}), 0.6), stiff(), few_substeps(), {}, breeze});
  list.push_back({"relaxation", make_sheet({.nx = 60, .ny = 30, .charts_x = 2}), attached(), few_substeps(3), {}, {}});
  list.push_back({"relaxation of springs", make_sheet({.nx = 60, .ny = 30}), stiff(), few_substeps(3), {}, {}});
  list.push_back({"relaxation of bends", make_sheet({.nx = 61, .ny = 90}), attached(), few_substeps(2), {}, breeze});
  list.push_back({"speed limit", make_sheet({.nx = 60, .ny = 30}), attached(), few_substeps(), all_shapes(), {}});
  list.back().material.max_speed = 1;
  list.push_back({"moving parent", make_sheet({.nx = 60, .ny = 30, .charts_x = 2}), attached(), few_substeps(),
                  all_shapes(), breeze});
  list.back().on_parent = true;
  list.push_back({"moving parent and a ball",
                  make_sheet({.nx = 60, .ny = 30, .charts_x = 2}),
                  attached(),
                  few_substeps(),
                  {{"ball", Sphere{{0, -0.1F, 0.1F}, 0.15F}, 0.3F, {}}},
                  breeze,
                  "top"});
  list.back().on_parent = true;
  list.back().pin_frequency = 5;
  list.push_back({"pressure",
                  make_sheet({.nx = 60, .ny = 30, .charts_x = 2, .charts_y = 2}),
                  attached(),
                  few_substeps(),
                  {},
                  breeze,
                  "top"});
  list.back().pressure = 3;
  list.push_back({"pins with a distance", make_sheet({.nx = 60, .ny = 30, .charts_x = 2}), attached(), few_substeps(),
                  all_shapes(), breeze, "top"});
  list.back().pin_distance = 0.01F;
  for (const uint32_t charts : {1U, 3U}) {
    list.push_back({"pins of every kind", make_sheet({.nx = 85, .ny = 40, .charts_x = charts, .jitter = 0.2F}),
                    attached(), few_substeps(), all_shapes(), breeze});
    list.back().every_pin = true;
    list.push_back(list.back());
    list.back().name = "pins of every kind, many of which ride on a moving parent";
    list.back().on_parent = true;
  }
  list.push_back({"body and thin colliders", make_sheet({.nx = 33, .ny = 20, .charts_x = 2}), attached(),
                  few_substeps(), body_and_wire(), breeze, "top"});
  list.push_back({"thin colliders and holes", with_holes(make_sheet({.nx = 53, .ny = 15}), 0.15), attached(),
                  few_substeps(), body_and_wire(), breeze, "top"});
  list.push_back({"fast colliders",
                  make_sheet({.nx = 35, .ny = 16, .charts_x = 2}),
                  attached(),
                  few_substeps(),
                  all_shapes(),
                  {},
                  "top"});
  list.back().collider_step = 0.15F;
  list.push_back({"speed limit on a moving parent", make_sheet({.nx = 35, .ny = 16, .charts_x = 2}), attached(),
                  few_substeps(), body_and_wire(), breeze, "top"});
  list.back().on_parent = true;
  list.back().settings.imperfection = 0.01F;
  list.back().material.max_speed = 1;
  list.push_back({"gravity that strays",
                  make_sheet({.nx = 61, .ny = 23, .charts_x = 2}),
                  attached(),
                  few_substeps(),
                  {},
                  {},
                  "top"});
  list.back().settings.imperfection = 0.01F;
  list.push_back({"soft pins", make_sheet({.nx = 60, .ny = 30}), attached(), few_substeps(), {}, {}, "top"});
  list.back().pin_frequency = 3;
  list.push_back({"bands of rows", make_sheet({.nx = 40, .ny = 150, .charts_x = 2, .charts_y = 2, .gap = 2}),
                  attached(), few_substeps(), all_shapes(), breeze});
  list.back().on_parent = true;
  list.back().pin_frequency = 3;
  list.push_back(
      {"bands of springs", make_sheet({.nx = 40, .ny = 170, .charts_x = 2}), stiff(), few_substeps(), {}, {}});
  list.push_back({"one substep", make_sheet({.nx = 60, .ny = 30}), stiff(), few_substeps(), {}, {}});
  list.back().settings.substeps = 1;
  for (const uint32_t n : {33U, 48U, 53U, 64U, 97U, 100U})  // rows end anywhere in a vector
    list.push_back({"hung", make_sheet({.nx = n, .ny = 31}), hung(), few_substeps(), {}, {}, "top"});
  for (const uint32_t n : {2U, 3U, 5U, 15U, 16U, 17U, 28U, 29U, 52U}) {
    list.push_back({"narrow", make_sheet({.nx = n, .ny = 9}), attached(), few_substeps(), {}, {}});
    list.push_back({"low", make_sheet({.nx = 52, .ny = n}), attached(), few_substeps(), {}, breeze});
  }
  return list;
}

void expect_same(const State& fast, const State& plain, const std::string& where) {
  EXPECT_EQ(differences(fast.positions, plain.positions), 0U) << where;
  EXPECT_EQ(differences(fast.velocities, plain.velocities), 0U) << where;
  EXPECT_EQ(differences(fast.normals, plain.normals), 0U) << where;
}

/// Steps below 1/5000 s, in which constraints act on offsets.
std::vector<Case> cases_in_tiny_steps() {
  std::vector<Case> list = cases();
  for (Case& c : list) {
    c.settings.frame_time = c.settings.substeps / 6000.0;
    c.collider_step /= 20;
  }
  return list;
}

constexpr uint32_t kFrames = 16;

class Lists : public testing::TestWithParam<bool> {
 public:
  static std::vector<Case> list() { return GetParam() ? cases_in_tiny_steps() : cases(); }
};

TEST_P(Lists, HaveTheBitsOfThePlainPathForAnyNumberOfThreadsAndAnyInstructions) {
  for (const Case& c : list()) {
    const State plain = state_after(c, true, 1, kFrames);
    ASSERT_TRUE(test::all_finite(plain.positions)) << c.name;
    for (const uint32_t threads : {1U, 2U, 5U}) {
      const State fast = state_after(c, false, threads, kFrames);
      const std::string where =
          std::string(c.name) + ", width " + std::to_string(c.asset.width) + ", threads " + std::to_string(threads);
      expect_same(fast, plain, where);
      if (threads == 2) continue;  // nothing is measured there
      EXPECT_EQ(fast.statistics.penetration, plain.statistics.penetration) << where;
      EXPECT_EQ(fast.statistics.copy_gap, plain.statistics.copy_gap) << where;
      ASSERT_EQ(fast.statistics.passes.size(), plain.statistics.passes.size()) << where;
      for (size_t k = 0; k < fast.statistics.passes.size(); ++k) {
        EXPECT_EQ(fast.statistics.passes[k].pass, plain.statistics.passes[k].pass) << where;
      }
    }
    for (const int64_t target : test::vector_targets()) {
      const test::VectorTarget chosen(target);
      const State fast = state_after(c, false, 1, kFrames);
      EXPECT_EQ(fast.statistics.path, std::string("sweep ") + hwy::TargetName(target));
      expect_same(fast, plain, std::string(c.name) + " with " + hwy::TargetName(target));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sweep, Lists, testing::Bool(),
                         [](const auto& tiny) { return std::string(tiny.param ? "TinySteps" : "Steps"); });

/// Threads share out whole cloths when there are enough, and substeps of one cloth when there are not.
// Measured cloth once went on one thread, and a report on eight was that of one.
TEST(Sweep, PassesTakeTheTimeOfTheFramesOnAnyNumberOfThreads) {
  for (const uint32_t charts : {1U, 2U}) {
    const ClothAsset asset = test::make_sheet({.nx = 64, .ny = 64, .charts_x = charts});
    for (const uint32_t threads : {1U, 3U}) {
      SolverSettings settings = test::cpu_settings();
      settings.threads = threads;
      settings.timings = true;
      Solver solver(std::vector{test::describe(asset)}, settings);
      solver.set_pins(0, test::pins_at_rest(asset, "top"));
      const auto start = std::chrono::steady_clock::now();
      for (int frame = 0; frame < 20; ++frame) solver.step();
      const double all = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      double passes = 0;
      for (const PassTiming& pass : solver.statistics().passes) passes += pass.seconds;
      EXPECT_LE(passes, all) << threads;
      EXPECT_GE(passes, 0.1 * all) << threads;
    }
  }
}

TEST(Sweep, ClothsSideBySideDoNotDependOnThreads) {
  const Case c{"crowd", make_sheet({.nx = 40, .ny = 30}), attached(), few_substeps(), {}, {}};
  const auto run = [&](uint32_t threads, bool plain) {
    SolverSettings settings = c.settings;
    settings.backend = Backend::cpu;
    settings.threads = threads;
    if (plain) settings.path = SolverPath::plain;
    std::vector<ClothDesc> cloths(5, test::describe(c.asset, c.material));
    for (size_t i = 0; i < cloths.size(); ++i) cloths[i].transform.translate.x = 2 * static_cast<float>(i);
    Solver solver(cloths, settings);
    for (uint32_t i = 0; i < 5; ++i) {
      solver.set_pins(i, test::pins_at_rest(c.asset, "top", {2 * static_cast<float>(i), 0, 0}));
    }
    test::run(solver, 5);
    std::vector<Vec3> all;
    for (uint32_t i = 0; i < 5; ++i) {
      const std::vector<Vec3> one = test::positions_of(solver, i);
      all.insert(all.end(), one.begin(), one.end());
    }
    return all;
  };
  const std::vector<Vec3> plain = run(1, true);
  for (const uint32_t threads : {1U, 2U, 16U}) EXPECT_EQ(differences(run(threads, false), plain), 0U) << threads;
}

/// Cloths that are alike work by one plan. One that is pinned elsewhere, cut or made of something else must not take
/// the others along, and those that become alike later may share again.
TEST(Sweep, ClothsOfACrowdGoTheirOwnWaysOnceTheyDiffer) {
  const ClothAsset asset = make_sheet({.nx = 60, .ny = 30, .charts_x = 2});
  constexpr uint32_t kCount = 6, kOther = 1, kCut = 3, kStiff = 4;
  const auto run = [&](SolverPath path, uint32_t relaxation_steps) {
    SolverSettings settings = few_substeps();
    settings.backend = Backend::cpu;
    settings.path = path;
    settings.relaxation_steps = relaxation_steps;
    std::vector<ClothDesc> cloths(kCount, test::describe(asset, attached()));
    cloths[kStiff].material.stretch_warp *= 2;
    Solver solver(cloths, settings);
    for (uint32_t i = 0; i < kCount; ++i) solver.set_pins(i, test::pins_at_rest(asset, "top"));
    test::run(solver, 2);
    solver.set_pins(kOther, test::pins_at_rest(asset, "corners"));
    solver.cut(kCut, {{{-1, 0, -1}, {0.2F, 0, -1}, {0, 0, 2}}});
    test::run(solver, 2);
    solver.set_pins(kOther, test::pins_at_rest(asset, "top"));
    test::run(solver, 2);
    std::vector<std::vector<Vec3>> all;
    for (uint32_t i = 0; i < kCount; ++i) all.push_back(test::positions_of(solver, i));
    return all;
  };
  for (const uint32_t relaxation_steps : {1U, 2U}) {
    const auto plain = run(SolverPath::plain, relaxation_steps), fast = run(SolverPath::automatic, relaxation_steps);
    for (uint32_t i = 0; i < kCount; ++i) {
      EXPECT_EQ(differences(fast[i], plain[i]), 0U) << "cloth " << i << ", relaxation steps " << relaxation_steps;
      const bool differs = i == kOther || i == kCut || i == kStiff;
      EXPECT_EQ(differences(fast[i], fast[0]) != 0, differs) << "cloth " << i;
    }
  }
}

}  // namespace
}  // namespace geocloth
