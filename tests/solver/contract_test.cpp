// SPDX-License-Identifier: GPL-3.0-or-later
// What the solver promises besides physics: the same bits from run to run and for any number of threads, states that
// can be written and read, and a clear refusal of everything out of range.

#include <cmath>
#include <functional>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "geocloth/solver/device.h"
#include "solver_fixture.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::SheetOptions;

uint64_t hash_of_run(const ClothAsset& asset, uint32_t threads, uint32_t relaxation_steps) {
  SolverSettings settings = test::cpu_settings();
  settings.threads = threads;
  settings.substeps = 4;
  settings.relaxation_steps = relaxation_steps;
  Material material;
  material.max_stretch = 0.05F;
  Solver solver(std::vector{test::describe(asset, material)}, settings);
  solver.set_pins(0, test::pins_at_rest(asset, "corners"));
  solver.set_wind({{1, 0, 2}, 0.3F, 1, 1, 0.2F});
  for (uint32_t f = 0; f < 20; ++f) {
    solver.set_colliders(
        std::vector<Collider>{{"ball", Sphere{{0, -0.2F, 0.02F * static_cast<float>(f) - 0.2F}, 0.2F}, 0.3F, {}},
                              {"floor", Plane{{0, -0.5F, 0}, {0, 1, 0}}, 0.3F, {}}});
    solver.step();
  }
  return hash_state(asset, test::positions_of(solver));
}

TEST(Determinism, SameBitsInEveryRunAndForAnyNumberOfThreads) {
  const ClothAsset asset = make_sheet({.nx = 97, .ny = 101, .charts_x = 5, .charts_y = 3});
  for (const uint32_t relaxation_steps : {1U, 3U}) {
    const uint64_t one = hash_of_run(asset, 1, relaxation_steps);
    EXPECT_EQ(hash_of_run(asset, 1, relaxation_steps), one);
    EXPECT_EQ(hash_of_run(asset, 2, relaxation_steps), one);
    EXPECT_EQ(hash_of_run(asset, 7, relaxation_steps), one);
  }
}

TEST(State, CanBeReadAndWrittenBack) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9, .charts_x = 2});
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  test::run(solver, 5);
  const std::vector<Vec3> x = test::positions_of(solver), v = test::velocities_of(solver);
  test::run(solver, 5);
  solver.write_state(0, x, v);
  EXPECT_EQ(test::positions_of(solver), x);
  for (size_t p = 0; p < v.size(); ++p) EXPECT_LT(length(test::velocities_of(solver)[p] - v[p]), 2e-3F);
  std::vector<Vec3> normals;
  solver.read_normals(0, normals);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    EXPECT_NEAR(length(normals[p]), asset.valid(p) ? 1 : 0, 1e-5);
  }
}

TEST(State, SeveralClothsKeepToThemselves) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9});
  ClothDesc left = test::describe(asset), right = test::describe(asset);
  right.transform.translate = {5, 0, 0};
  right.material.damping = 5;
  Solver solver(std::vector{left, right}, test::cpu_settings());
  solver.set_pins(1, test::pins_at_rest(asset, "top", {5, 0, 0}));
  test::run(solver, 20);
  EXPECT_EQ(solver.cloth_count(), 2U);
  EXPECT_LT(test::positions_of(solver, 0)[0].y, 0.1F);
  EXPECT_EQ(test::positions_of(solver, 1)[0], (Vec3{4.5F, 0.5F, 0}));
  EXPECT_EQ(solver.statistics().particles, 162U);
}

TEST(State, ScaleMakesTheSameClothLarger) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9});
  ClothDesc cloth = test::describe(asset);
  cloth.transform.scale = 3;
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  Solver solver(std::vector{cloth}, settings);
  test::run(solver, 5);
  EXPECT_NEAR(measure_stretch(asset, 3, test::positions_of(solver)).max, 1, 1e-4);
  const Energy energy =
      measure_energy(cloth, {0, -1, 0}, std::vector<Vec3>(81, Vec3{0, 1, 0}), std::vector<Vec3>(81, Vec3{1, 0, 0}));
  EXPECT_NEAR(energy.potential, 9 * 0.2, 1e-5);
  EXPECT_NEAR(energy.kinetic, 0.5 * 9 * 0.2, 1e-5);
}

TEST(Guards, SliversWithHardlyAnyAreaAreNoWeightlessParticles) {
  ClothAsset asset = make_sheet({.nx = 9, .ny = 9, .charts_x = 2, .jitter = 0.3F});
  for (uint32_t p = 0; p < asset.pixel_count(); p += 3)
    if (asset.valid(p)) asset.area[p] = 1e-30F;
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  solver.set_pins(0, test::pins_at_rest(asset, "top"));
  test::run(solver, 60);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST(Guards, SpringsWithoutLengthAreLeftOut) {
  ClothAsset asset = make_sheet({.nx = 9, .ny = 9});
  for (uint32_t x = 2; x < 6; ++x) asset.rest_position[40 + x - 4] = asset.rest_position[38];
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  solver.set_pins(0, test::pins_at_rest(asset, "top"));
  test::run(solver, 60);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST(Guards, VeryIrregularSpringsStayStable) {
  for (const float jitter : {0.3F, 0.45F}) {
    const ClothAsset asset = make_sheet({.nx = 33, .ny = 33, .charts_x = 3, .charts_y = 2, .jitter = jitter});
    const ClothDesc cloth = test::describe(asset, test::undamped());
    SolverSettings settings = test::cpu_settings();
    Solver solver(std::vector{cloth}, settings);
    solver.set_pins(0, test::pins_at_rest(asset, "corners"));
    test::run(solver, 120);
    EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
    for (const Vec3& v : test::velocities_of(solver)) EXPECT_LT(length(v), 20);
    EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  }
}

TEST(Refusals, EveryValueOutOfRangeIsNamed) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5});
  const auto refused = [&](const std::function<void(ClothDesc&, SolverSettings&)>& spoil) {
    ClothDesc cloth = test::describe(asset);
    SolverSettings settings = test::cpu_settings();
    spoil(cloth, settings);
    EXPECT_THROW(Solver(std::vector{cloth}, settings), Error);
  };
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  refused([](ClothDesc& c, SolverSettings&) { c.asset = nullptr; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.areal_density = 0; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.stretch_warp = kNaN; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.damping = -1; });
  refused([](ClothDesc& c, SolverSettings&) { c.material.stiffness = 2; });
  refused([](ClothDesc& c, SolverSettings&) { c.transform.scale = 0; });
  refused([](ClothDesc& c, SolverSettings&) { c.transform.translate.x = kNaN; });
  refused([](ClothDesc& c, SolverSettings&) { c.transform.rotate.w = 3; });
  refused([](ClothDesc&, SolverSettings& s) { s.substeps = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.substeps = 257; });
  refused([](ClothDesc&, SolverSettings& s) { s.relaxation_steps = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.frame_time = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.threads = 0; });
  refused([](ClothDesc&, SolverSettings& s) { s.gravity.y = kNaN; });

  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  const auto collider = [](ColliderShape shape) { return std::vector<Collider>{{"solid", shape, 0.3F, {}}}; };
  EXPECT_THROW(solver.set_colliders(collider(Sphere{{0, 0, 0}, -1})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Sphere{{kNaN, 0, 0}, 1})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Plane{{0, 0, 0}, {0, 0, 0}})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Box{{0, 0, 0}, {1, 0, 1}, {}})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Ellipsoid{{0, 0, 0}, {1, kNaN, 1}, {}})), Error);
  EXPECT_THROW(solver.set_colliders(collider(Capsule{{0, 0, 0}, {0, 1, 0}, 0, 1})), Error);
  EXPECT_THROW(solver.set_wind({{kNaN, 0, 0}, 0, 1, 1, 0}), Error);
  EXPECT_THROW(solver.set_gravity({0, kNaN, 0}), Error);
  EXPECT_THROW(solver.set_pins(0, std::vector<Pin>{{25, {}}}), Error);
  EXPECT_THROW(solver.set_pins(0, std::vector<Pin>{{0, {kNaN, 0, 0}}}), Error);
  EXPECT_THROW(solver.set_pins(1, {}), Error);
  EXPECT_THROW(solver.write_state(0, std::vector<Vec3>(3), std::vector<Vec3>(3)), Error);
  test::run(solver, 1);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

// Values that no cloth has were taken, and came out again as cloth that is not a number.
TEST(Refusals, ValuesTooSmallForSinglePrecisionAreNamed) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5});
  using Spoil = std::function<void(ClothDesc&, SolverSettings&)>;
  const std::vector<std::pair<const char*, Spoil>> cases{
      {"areal_density", [](ClothDesc& c, SolverSettings&) { c.material.areal_density = 1e-38F; }},
      {"stretch_warp", [](ClothDesc& c, SolverSettings&) { c.material.stretch_warp = 1e-38F; }},
      {"stretch_weft", [](ClothDesc& c, SolverSettings&) { c.material.stretch_weft = 1e-20F; }},
      {"shear", [](ClothDesc& c, SolverSettings&) { c.material.shear = 1e-38F; }},
      {"bend_warp", [](ClothDesc& c, SolverSettings&) { c.material.bend_warp = 1e-38F; }},
      {"bend_weft", [](ClothDesc& c, SolverSettings&) { c.material.bend_weft = 1e-20F; }},
      {"bend_bias", [](ClothDesc& c, SolverSettings&) { c.material.bend_bias = 1e-38F; }},
      {"scale", [](ClothDesc& c, SolverSettings&) { c.transform.scale = 1e-20F; }},
      {"frame_time", [](ClothDesc&, SolverSettings& s) { s.frame_time = 1e-40; }},
      {"frame_time", [](ClothDesc&, SolverSettings& s) { s.frame_time = 1e-6; }}};
  for (const auto& [field, spoil] : cases) {
    ClothDesc cloth = test::describe(asset);
    SolverSettings settings = test::cpu_settings();
    spoil(cloth, settings);
    try {
      const Solver solver(std::vector{cloth}, settings);
      ADD_FAILURE() << field;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      EXPECT_THAT(e.what(), testing::HasSubstr(field));
    }
  }
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  EXPECT_THROW(solver.set_time_step(1e-20, 1), Error);
  EXPECT_THROW(solver.set_time_step(1e-5, 256), Error);
  EXPECT_NO_THROW(solver.set_time_step(1e-5, 100));
}

// The ends of the ranges are safe, each by itself and with each end of the step's length.
TEST(Guards, EveryValueAtTheEndOfItsRangeStaysANumber) {
  using Change = std::function<void(ClothDesc&)>;
  std::vector<std::pair<std::string, Change>> changes{{"plain", [](ClothDesc&) {}}};
  const auto add = [&](const char* name, float Material::*field, std::initializer_list<float> values) {
    for (const float v : values)
      changes.emplace_back(std::string(name) + " " + std::to_string(v), [=](ClothDesc& c) { c.material.*field = v; });
  };
  add("areal_density", &Material::areal_density, {1e-6F, 1e4F});
  add("stretch_warp", &Material::stretch_warp, {1e-9F, 1e12F});
  add("shear", &Material::shear, {0, 1e-9F, 1e12F});
  add("bend_warp", &Material::bend_warp, {0, 1e-12F, 1e6F});
  add("bend_bias", &Material::bend_bias, {0, 1e-12F, 1e6F});
  changes.emplace_back("soft and light", [](ClothDesc& c) {
    c.material = {.areal_density = 1e-6F, .stretch_warp = 1e-9F, .stretch_weft = 1e-9F, .shear = 1e-9F};
    c.material.bend_warp = c.material.bend_weft = c.material.bend_bias = 1e-12F;
  });
  changes.emplace_back("soft and heavy", [](ClothDesc& c) {
    c.material = {.areal_density = 1e4F, .stretch_warp = 1e-9F, .stretch_weft = 1e-9F, .shear = 1e-9F};
    c.material.bend_warp = c.material.bend_weft = c.material.bend_bias = 1e-12F;
  });
  changes.emplace_back("stiff and light", [](ClothDesc& c) {
    c.material = {.areal_density = 1e-6F, .stretch_warp = 1e12F, .stretch_weft = 1e12F, .shear = 1e12F};
    c.material.bend_warp = c.material.bend_weft = c.material.bend_bias = 1e6F;
  });
  const ClothAsset asset = make_sheet({.nx = 13, .ny = 13, .charts_x = 2, .jitter = 0.2F});
  for (const float scale : {1e-6F, 1.F, 1e5F})
    for (const auto& [name, change] : changes)
      for (const double step : {1e-7, 1.0 / 960, 10.0 / 4})
        for (const uint32_t relaxation_steps : {1U, 2U})
          for (const SolverPath path : {SolverPath::automatic, SolverPath::plain}) {
            ClothDesc cloth = test::describe(asset);
            cloth.transform.scale = scale;
            cloth.self_collision = SelfCollision{};
            change(cloth);
            SolverSettings settings = test::cpu_settings();
            settings.path = path;
            settings.frame_time = 4 * step;
            settings.substeps = 4;
            settings.relaxation_steps = relaxation_steps;
            Solver solver(std::vector{cloth}, settings);
            std::vector<Pin> pins = test::pins_at_rest(asset, "corners");
            for (Pin& pin : pins) pin.target = apply(cloth.transform, pin.target);
            solver.set_pins(0, pins);
            solver.set_colliders(
                std::vector<Collider>{{"ball", Sphere{{0, 0, 0.2F * scale}, 0.21F * scale}, 0.3F, {}}});
            solver.set_wind({{1, 0, 2}, 0.3F, 1, 1, 0.2F});
            test::run(solver, 8);
            EXPECT_TRUE(test::all_finite(test::positions_of(solver)))
                << name << ", scale " << scale << ", step " << step << ", path " << to_string(path);
            EXPECT_TRUE(test::all_finite(test::velocities_of(solver)))
                << name << ", scale " << scale << ", step " << step;
          }
}

// They read past what they were given.
TEST(Refusals, MeasuresOfAnotherNumberOfPixels) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5});
  const ClothDesc cloth = test::describe(asset);
  const std::vector<Vec3> few(3), all(25), many(26);
  const EnergyMeter meter(cloth);
  const auto refused = [](const auto& measure) {
    try {
      measure();
      ADD_FAILURE();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
    }
  };
  for (const std::vector<Vec3>& other : {few, many}) {
    refused([&] { static_cast<void>(measure_stretch(asset, 1, other)); });
    refused([&] { static_cast<void>(hash_state(asset, other)); });
    refused([&] { static_cast<void>(meter.measure({}, other, all)); });
    refused([&] { static_cast<void>(meter.measure({}, all, other)); });
  }
  refused([&] { static_cast<void>(meter.measure({}, all, all, std::vector<uint32_t>{25})); });
  refused([&] { static_cast<void>(measure_energy(ClothDesc{}, {}, all, all)); });
  EXPECT_NO_THROW(static_cast<void>(meter.measure({}, all, all, std::vector<uint32_t>{24})));
}

// A cloth that had flown apart was reported as not stretched at all.
TEST(Stretch, OfWhatIsNotANumberIsInfinite) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5});
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  const StretchStatistics none = measure_stretch(asset, 1, std::vector<Vec3>(25, Vec3{kNaN, 0, 0}));
  for (const double value : {none.max, none.p99, none.mean}) EXPECT_EQ(value, kInfinity);
  std::vector<Vec3> one = asset.rest_position;
  one[7].y = kNaN;
  const StretchStatistics in_part = measure_stretch(asset, 1, one);
  EXPECT_EQ(in_part.max, kInfinity);
  EXPECT_EQ(in_part.p99, kInfinity);  // of four springs in forty
  EXPECT_EQ(in_part.mean, kInfinity);
}

// A pixel out of range ended the program, and an asset that no solver takes was measured as if it were one.
TEST(Refusals, TheEnergyOfClothThatNoSolverTakes) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5});
  const auto refused = [](const ClothDesc& cloth, ErrorCode code, const char* why) {
    try {
      const EnergyMeter meter(cloth);
      ADD_FAILURE() << why;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code) << e.what();
      EXPECT_THAT(e.what(), testing::HasSubstr(why));
    }
  };
  ClothDesc cloth = test::describe(asset);
  cloth.fabrics.push_back({.pixels = {4'000'000}});
  refused(cloth, ErrorCode::invalid_argument, "fabric 0: pixel 4000000 is not one of the cloth's");
  cloth.fabrics.resize(33);
  refused(cloth, ErrorCode::limit, "33 fabrics");
  ClothAsset broken = asset;
  broken.area.resize(3);
  refused(test::describe(broken), ErrorCode::invalid_data, "area");
  refused({}, ErrorCode::invalid_argument, "asset is null");
}

// `--backend cpu --device ...` ran on the cpu whatever it was told, and the cpu's own name was that of no device.
TEST(Refusals, TheCpuIsADeviceWithAName) {
  const std::string name = enumerate_devices().front().name;
  const ClothAsset asset = make_sheet({.nx = 6, .ny = 6});
  const std::vector cloths{test::describe(asset)};
  for (const Backend backend : {Backend::cpu, Backend::automatic}) {
    SolverSettings settings;
    settings.backend = backend;
    settings.device = name;
    EXPECT_EQ(Solver(cloths, settings).statistics().device, name);
  }
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.device = "Voodoo 2";
  try {
    const Solver solver(cloths, settings);
    ADD_FAILURE() << "ran on " << name;
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::device);
    EXPECT_THAT(e.what(), testing::HasSubstr("'Voodoo 2'"));
  }
}

TEST(Refusals, CopiesThatDisagreeCannotBeWritten) {
  const ClothAsset asset = make_sheet({.nx = 5, .ny = 5, .charts_x = 2});
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  std::vector<Vec3> x = test::positions_of(solver);
  x[asset.splits.pixel[1]].x += 0.01F;
  EXPECT_THROW(solver.write_state(0, x, std::vector<Vec3>(x.size())), Error);
}

// It took the origin along before it looked at velocities and copies: who went on after the refusal got other frames
// than who had never asked.
TEST(Refusals, OfAStateLeaveTheSolverAsItIs) {
  const ClothAsset asset = make_sheet({.nx = 9, .ny = 9, .charts_x = 2});
  Solver solver(std::vector{test::describe(asset)}, test::cpu_settings());
  test::run(solver, 3);
  std::vector<Vec3> far = test::positions_of(solver);
  for (Vec3& x : far) x.x += 500;
  const std::vector<Vec3> still(far.size());
  const std::vector<std::byte> before = solver.save();
  const auto refused = [&](const std::vector<Vec3>& x, const std::vector<Vec3>& v, const char* why) {
    try {
      solver.write_state(0, x, v);
      ADD_FAILURE() << why;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
      EXPECT_THAT(error.what(), testing::HasSubstr(why));
    }
    EXPECT_EQ(solver.save(), before) << why;
  };
  const uint32_t copy = asset.splits.pixel[1];
  std::vector<Vec3> bad = still;
  bad[copy].y = std::numeric_limits<float>::quiet_NaN();
  refused(far, bad, "a velocity is nan");
  bad[copy].y = 2e6F;
  refused(far, bad, "a velocity is 2000000");
  bad = far;
  bad[copy].z += 0.01F;
  refused(bad, still, "is a copy of pixel");
  bad[copy].z = std::numeric_limits<float>::infinity();
  refused(bad, still, "a position is inf");
}

}  // namespace
}  // namespace geocloth
