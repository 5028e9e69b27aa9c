// SPDX-License-Identifier: GPL-3.0-or-later
// A garment of several fabrics: a collar stands and the shirt hangs, a band draws and the skirt falls. Each place has
// to do what its own fabric does, whatever is beside it and however the garment is cut into panels.
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

using test::material_with;

constexpr double kGravity = 9.81;

/// All copies of the points that are where `is_there` says, at rest.
Fabric fabric_where(const ClothAsset& asset, const Material& material,
                    const std::function<bool(const Vec3&)>& is_there) {
  Fabric fabric{{}, material};
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && is_there(asset.rest_position[p])) fabric.pixels.push_back(p);
  return fabric;
}
bool everywhere(const Vec3&) {
  return true;
}
bool in_lower_half(const Vec3& x) {
  return x.y < 1e-4F;
}

ClothDesc sheet(const Material& material, uint32_t charts = 2) {
  return test::describe(test::make_sheet({.nx = 13, .ny = 9, .charts_x = charts, .charts_y = charts, .jitter = 0.2F}),
                        material);
}

void play(Solver& solver, const ClothAsset& asset, int frames) {
  solver.set_pins(0, test::pins_at_rest(asset, "corners"));
  test::push_ball(solver, frames);
}

SolverSettings few_substeps() {
  SolverSettings settings;
  settings.substeps = 4;
  return settings;
}

/// Stiff where the others are limp, heavy where they are light.
Material canvas() {
  Material m;
  m.areal_density = 0.7F;
  m.stretch_warp = 4000;
  m.stretch_weft = 2500;
  m.shear = 300;
  m.bend_warp = 3e-3F;
  m.bend_weft = 2e-3F;
  return m;
}

class Fabrics : public test::MachineTest<> {
 protected:
  [[nodiscard]] int frames() const { return machine().slow() ? 3 : 8; }
  [[nodiscard]] std::vector<Vec3> played(const ClothDesc& cloth, int frame_count) {
    Solver solver = make(cloth, few_substeps());
    play(solver, *cloth.asset, frame_count);
    return test::positions_of(solver);
  }
};

TEST_P(Fabrics, OfTheClothsOwnMaterialChangesNothing) {
  ClothDesc cloth = sheet(canvas());
  const std::vector<Vec3> plain = played(cloth, frames());
  cloth.fabrics = {fabric_where(*cloth.asset, canvas(), in_lower_half)};
  EXPECT_EQ(played(cloth, frames()), plain);
}

TEST_P(Fabrics, ThatIsEverywhereIsTheMaterial) {
  Material bias = canvas();
  bias.bend_bias = 1e-3F;
  for (const Material& material : {canvas(), bias}) {
    const std::vector<Vec3> plain = played(sheet(material), frames());
    Material other = material_with(&Material::areal_density, 0.1F);
    other.stretch_warp = 50;
    ClothDesc cloth = sheet(other);
    cloth.fabrics = {fabric_where(*cloth.asset, other, in_lower_half),
                     fabric_where(*cloth.asset, material, everywhere)};
    EXPECT_EQ(played(cloth, frames()), plain) << "the last fabric of several counts";
  }
}

TEST_P(Fabrics, BecomesAnotherWhileItRuns) {
  ClothDesc cloth = sheet(Material{});
  cloth.fabrics = {fabric_where(*cloth.asset, canvas(), in_lower_half)};
  const std::vector<Vec3> made = played(cloth, frames());
  cloth.fabrics[0].material = material_with(&Material::bend_warp, 0);
  Solver solver = make(cloth, few_substeps());
  solver.set_fabric(0, 0, canvas());
  EXPECT_TRUE(solver.fabric(0, 0) == canvas());
  play(solver, *cloth.asset, frames());
  EXPECT_EQ(test::positions_of(solver), made);
  solver.set_material(0, solver.fabric(0, 0));  // which moves meanwhile
  EXPECT_TRUE(solver.material(0) == canvas());
}

TEST_P(Fabrics, AreInAState) {
  ClothDesc cloth = sheet(Material{});
  cloth.fabrics = {fabric_where(*cloth.asset, canvas(), in_lower_half)};
  Solver solver = make(cloth, few_substeps());
  play(solver, *cloth.asset, 2);
  const std::vector<std::byte> state = solver.save();
  test::run(solver, 2);
  const std::vector<Vec3> after = test::positions_of(solver);
  cloth.fabrics[0].material = Material{};  // what it is made of comes with the state
  Solver other = make(cloth, few_substeps());
  other.restore(state);
  EXPECT_TRUE(other.fabric(0, 0) == canvas());
  test::run(other, 2);
  EXPECT_EQ(test::positions_of(other), after);
  other.set_fabric(0, 0, Material{});
  other.restore(state);
  test::run(other, 2);
  EXPECT_EQ(test::positions_of(other), after);
  cloth.fabrics[0].pixels.pop_back();  // another garment
  Solver elsewhere = make(cloth, few_substeps());
  EXPECT_THROW(elsewhere.restore(state), Error);
}

TEST_P(Fabrics, ThatAreWrongAreRefused) {
  const ClothDesc good = sheet(Material{});
  const auto refused = [&](const std::function<void(ClothDesc&)>& spoil) {
    ClothDesc cloth = good;
    cloth.fabrics = {fabric_where(*cloth.asset, canvas(), in_lower_half)};
    spoil(cloth);
    EXPECT_THROW(static_cast<void>(make(cloth, few_substeps())), Error);
  };
  refused([](ClothDesc& c) { c.fabrics[0].pixels.push_back(c.asset->pixel_count()); });
  refused([](ClothDesc& c) {
    uint32_t empty = 0;
    while (c.asset->valid(empty)) ++empty;
    c.fabrics[0].pixels.push_back(empty);
  });
  refused([](ClothDesc& c) { c.fabrics[0].material.areal_density = 0; });
  refused([](ClothDesc& c) { c.fabrics[0].material.stiffness = 0.5F; });
  refused([](ClothDesc& c) { c.material.stiffness = 0.5F; });
  refused([](ClothDesc& c) { c.fabrics.resize(33, c.fabrics[0]); });
  Solver solver = make(good, few_substeps());
  EXPECT_THROW(solver.set_fabric(0, 0, Material{}), Error);
  EXPECT_THROW(static_cast<void>(solver.fabric(0, 0)), Error);
}

/// [m] of a strip that hangs by its upper edge at rest: its middle and its lower edge.
struct Hanging {
  double middle, end;
};
Hanging hang(const test::MakeSolver& make, uint32_t rows, const Material& upper, const Material& lower,
             uint32_t charts) {
  const test::SheetOptions strip{.nx = 5, .ny = rows, .width = 0.2F, .height = 1, .charts_y = charts};
  ClothDesc cloth = test::describe(test::make_sheet(strip), upper);
  cloth.fabrics = {fabric_where(*cloth.asset, lower, in_lower_half)};
  SolverSettings settings;
  settings.substeps = 32;
  settings.relaxation_steps = 4;
  Solver solver = make({&cloth, 1}, settings);
  solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
  test::run(solver, rows > 20 ? 180 : 90);
  const std::vector<Vec3> x = test::positions_of(solver);
  const auto height = [&](uint32_t row) { return double{x[test::sheet_pixel(strip, 2, row)].y}; };
  return {height(0) - height(rows / 2), height(0) - height(rows - 1)};
}

// T(s) = g (what hangs below s); each half is longer by the mean of T / K over it.
TEST_P(Fabrics, StretchEachByWhatHangsOnThem) {
  const uint32_t rows = machine().slow() ? 11 : 21;
  Material upper = material_with(&Material::damping, 8), lower = upper;
  upper.max_stretch = 0;
  upper.areal_density = 0.2F;
  upper.stretch_warp = 60;
  lower.areal_density = 0.6F;
  lower.stretch_warp = 25;
  upper.shear = lower.shear = 0;
  const double below = kGravity * double{lower.areal_density} * 0.5, own = kGravity * double{upper.areal_density} * 0.5;
  const double upper_longer = 0.5 * (below + 0.5 * own) / double{upper.stretch_warp};
  const double lower_longer = 0.5 * 0.5 * below / double{lower.stretch_warp};
  for (const uint32_t charts : {1U, 2U}) {
    if (machine().slow() && charts == 1) continue;
    const Hanging hanging = hang(maker(), rows, upper, lower, charts);
    EXPECT_NEAR(hanging.middle - 0.5, upper_longer, 0.03 * upper_longer) << charts;
    // Of the lowest row half a cell hangs below itself.
    EXPECT_NEAR(hanging.end - hanging.middle - 0.5, lower_longer, 0.06 * lower_longer) << charts;
  }
}

// A stiff shirt on an elastic band: attachments that let the band stretch must not let the shirt, which eight substeps
// alone do not hold.
TEST_P(Fabrics, StiffClothIsHeldTightBelowAnElasticBand) {
  if (machine().slow()) GTEST_SKIP() << "hundreds of substeps";
  const test::SheetOptions options{.nx = 41, .ny = 61, .width = 0.6F, .height = 0.9F, .charts_x = 2};
  Material band = material_with(&Material::stretch_warp, 30);
  band.stretch_weft = 30;
  band.shear = 0;
  const auto longest = [&](bool has_band) {
    ClothDesc cloth = test::describe(test::make_sheet(options), Material{});
    if (has_band) cloth.fabrics = {fabric_where(*cloth.asset, band, [](const Vec3& x) { return x.y > 0.3799F; })};
    SolverSettings settings;
    settings.substeps = 8;
    Solver solver = make(cloth, settings);
    solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
    test::run(solver, 240);
    const std::vector<Vec3> x = test::positions_of(solver);
    const auto height = [&](uint32_t row) { return double{x[test::sheet_pixel(options, 20, row)].y}; };
    const uint32_t lowest = options.ny - 1, hem = 5;  // rows of 15 mm
    return std::pair{(height(0) - height(hem)) / (0.015 * hem),
                     (height(hem) - height(lowest)) / (0.015 * (lowest - hem))};
  };
  const auto [plain_band, plain_shirt] = longest(false);
  const auto [soft_band, shirt] = longest(true);
  EXPECT_LT(plain_shirt, 1.01);
  EXPECT_LT(shirt, 1.01);
  const double load = double{Material{}.areal_density} * kGravity * (0.9 - 0.5 * 0.075);
  EXPECT_NEAR(soft_band - 1, load / 30, 0.2 * load / 30);
  EXPECT_LT(plain_band, 1.01);
}

// The stiff half of a strip that sticks out stays level, and the limp half droops as a strip of half the length.
TEST_P(Fabrics, BendEachByTheirOwnRigidity) {
  if (machine().slow()) GTEST_SKIP() << "thousands of substeps";
  constexpr uint32_t kRows = 17, kHalf = 8;
  constexpr double kGamma = 5, kDroop = 0.5857, kLength = 0.2;  // [m] of a half
  const test::SheetOptions strip{.nx = 4, .ny = kRows, .width = 0.05F, .height = 0.4F, .horizontal = true};
  Material limp = material_with(&Material::damping, 8);
  limp.stretch_warp = limp.stretch_weft = 5000;
  const double weight = double{limp.areal_density} * kGravity;
  limp.bend_warp = limp.bend_weft = static_cast<float>(weight * kLength * kLength * kLength / kGamma);
  ClothDesc cloth = test::describe(test::make_sheet(strip), limp);
  Material stiff = limp;
  stiff.areal_density = 0.02F;  // carries the limp half, hardly itself
  stiff.bend_warp = stiff.bend_weft = 400 * limp.bend_warp;
  cloth.fabrics = {fabric_where(*cloth.asset, stiff, [](const Vec3& x) { return x.z < 1e-4F; })};
  SolverSettings settings;
  settings.substeps = 64;
  settings.relaxation_steps = 32;
  Solver solver = make(cloth, settings);
  std::vector<Pin> pins;
  for (uint32_t i = 0; i < strip.nx; ++i)
    for (const uint32_t row : {0U, 1U}) {
      const uint32_t p = test::sheet_pixel(strip, i, row);
      pins.push_back({p, cloth.asset->rest_position[p]});
    }
  solver.set_pins(0, pins);
  test::run(solver, 180);
  const std::vector<Vec3> x = test::positions_of(solver);
  const Vec3 middle = x[test::sheet_pixel(strip, 1, kHalf)], tip = x[test::sheet_pixel(strip, 1, kRows - 1)];
  const Vec3 start = cloth.asset->rest_position[test::sheet_pixel(strip, 1, 1)];
  EXPECT_LT(start.y - middle.y, 0.02F * static_cast<float>(kLength));
  EXPECT_NEAR(double{middle.y - tip.y} / double{tip.z - middle.z}, kDroop, 0.06 * kDroop);
}

// A seam is where fabrics change, as the pattern of a garment has it: nobody sees how it is cut.
TEST_P(Fabrics, HangAlikeHoweverTheClothIsCut) {
  const uint32_t frame_count = machine().slow() ? 4 : 20;  // later it folds, as any rounding has it
  const auto points = [&](uint32_t charts) {
    const test::SheetOptions options{.nx = 13, .ny = 13, .charts_x = charts, .charts_y = charts, .horizontal = true};
    ClothDesc cloth = test::describe(test::make_sheet(options), material_with(&Material::damping, 2));
    cloth.fabrics = {fabric_where(*cloth.asset, canvas(), [](const Vec3& x) { return x.x > -1e-4F && x.z > -1e-4F; })};
    SolverSettings settings;
    settings.substeps = 16;
    Solver solver = make(cloth, settings);
    solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
    test::run(solver, frame_count);
    const std::vector<Vec3> x = test::positions_of(solver);
    std::vector<Vec3> in_order;
    for (uint32_t j = 0; j < options.ny; ++j)
      for (uint32_t i = 0; i < options.nx; ++i) in_order.push_back(x[test::sheet_pixel(options, i, j)]);
    return in_order;
  };
  const std::vector<Vec3> whole = points(1), cut = points(2);
  float farthest = 0;
  for (size_t i = 0; i < whole.size(); ++i) farthest = std::max(farthest, length(whole[i] - cut[i]));
  EXPECT_LT(farthest, 0.002F);
}

TEST_P(Fabrics, WeighWhatTheirAreaWeighs) {
  if (machine().slow()) GTEST_SKIP() << "measured on the host";
  for (const uint32_t charts : {1U, 3U}) {
    const test::SheetOptions options{.nx = 13, .ny = 13, .charts_x = charts, .charts_y = charts};
    ClothDesc cloth = test::describe(test::make_sheet(options), material_with(&Material::areal_density, 0.2F));
    cloth.fabrics = {fabric_where(*cloth.asset, material_with(&Material::areal_density, 1), in_lower_half)};
    const std::vector<Vec3> at(cloth.asset->pixel_count(), Vec3{}), unit(cloth.asset->pixel_count(), Vec3{0, 0, 1});
    const double mass = 2 * measure_energy(cloth, {}, at, unit).kinetic;
    EXPECT_NEAR(mass, 0.5 * 0.2 + 0.5 * 1.0, 1e-5) << charts;
  }
}

INSTANTIATE_TEST_SUITE_P(Machines, Fabrics, test::first_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
