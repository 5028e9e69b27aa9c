// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth becomes of another material while it runs: as if it had always been of it, and without what the solver keeps of
// the old one. People who tune a garment while they look at it would be shown what no other run does.
#include <cmath>
#include <span>
#include <vector>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

using test::material_with;

/// A cloth in three places, with bends of several kinds over seams.
ClothDesc sheet(const Material& material, uint32_t charts = 2) {
  return test::describe(test::make_sheet({.nx = 11, .ny = 9, .charts_x = charts, .charts_y = charts, .jitter = 0.2F}),
                        material);
}

/// Each differs from all others in what the solver makes of it: bends of another kind or none, attachments or none,
/// other masses, numbers of a frame alone.
std::vector<Material> materials() {
  Material limp = material_with(&Material::bend_warp, 0), grainless = material_with(&Material::bend_bias, 2e-4F);
  limp.bend_weft = 0;
  grainless.bend_warp = grainless.bend_weft = 2e-4F;
  Material seeds = material_with(&Material::stiffness, 0.8F), loose = material_with(&Material::max_stretch, 0);
  seeds.bend_stiffness = 0.5F;
  loose.stretch_warp = 40;
  Material heavy = material_with(&Material::areal_density, 0.9F), wet = heavy;
  wet.damping = 4;
  wet.friction = 0.9F;
  return {Material{}, limp, grainless, seeds, loose, heavy, wet, material_with(&Material::verlet_damping, 0.97F)};
}

void play(Solver& solver, const ClothAsset& asset, int frames) {
  solver.set_pins(0, test::pins_at_rest(asset, "corners"));
  solver.set_wind({.velocity = {0, 0, 3}});
  test::push_ball(solver, frames);
}

/// A strip of 1 m that hangs by its upper edge.
constexpr uint32_t kStripRows = 21;
const test::SheetOptions kStrip{.nx = 5, .ny = kStripRows, .width = 0.2F, .height = 1};
void hang_up(Solver& solver, const ClothDesc& strip) {
  solver.set_pins(0, test::pins_at_rest(*strip.asset, "top"));
}

class MaterialChange : public test::MachineTest<> {
 protected:
  [[nodiscard]] int frames() const { return machine().slow() ? 3 : 8; }
};
class MaterialChangeOnEveryPath : public MaterialChange {};

TEST_P(MaterialChangeOnEveryPath, BeforeTheFirstStepItIsAsIfMadeOfIt) {
  SolverSettings settings;
  settings.substeps = 4;
  settings.check_copies = true;
  const std::vector<Material> all = materials();
  std::vector<std::pair<size_t, size_t>> changes;  // from, to
  for (size_t to = 0; to < all.size(); ++to)
    for (size_t from = 0; from < all.size(); ++from)
      if (from != to) changes.emplace_back(from, to);
  if (machine().slow()) changes = {{1, 2}, {4, 0}, {0, 3}, {2, 6}};
  if (machine().slowest()) changes.resize(1);
  for (const auto& [from, to] : changes) {
    const ClothDesc cloth = sheet(all[to]);
    Solver made = make(cloth, settings);
    play(made, *cloth.asset, frames());
    Solver changed = make(sheet(all[from]), settings);
    changed.set_material(0, all[to]);
    EXPECT_TRUE(changed.material(0) == all[to]);
    play(changed, *cloth.asset, frames());
    EXPECT_EQ(test::positions_of(changed), test::positions_of(made)) << from << " to " << to;
    EXPECT_EQ(test::velocities_of(changed), test::velocities_of(made)) << from << " to " << to;
    EXPECT_EQ(changed.statistics().springs, made.statistics().springs) << from << " to " << to;
    EXPECT_EQ(changed.statistics().copy_gap, 0) << from << " to " << to;
  }
}

// Multipliers of several relaxation steps are one for each bend over seams, of which there are more.
TEST_P(MaterialChange, WithSeveralRelaxationSteps) {
  SolverSettings settings;
  settings.substeps = 3;
  settings.relaxation_steps = 2;
  const std::vector<Material> all = materials();
  const ClothDesc cloth = sheet(all[2]);
  Solver made = make(cloth, settings), changed = make(sheet(all[1]), settings);
  changed.set_material(0, all[2]);
  play(made, *cloth.asset, frames());
  play(changed, *cloth.asset, frames());
  EXPECT_EQ(test::positions_of(changed), test::positions_of(made));
}

TEST_P(MaterialChange, AStateHasItAndTakesItBack) {
  SolverSettings settings;
  settings.substeps = 3;
  const std::vector<Material> all = materials();
  std::vector<ClothDesc> cloths{sheet(all[1]), sheet(all[0])};
  cloths[1].transform.translate = {0, 0, 0.06F};
  cloths[0].inter_collision = cloths[1].inter_collision = InterCollision{};
  Solver solver = make(cloths, settings);
  play(solver, *cloths[0].asset, 2);
  const std::vector<std::byte> before = solver.save();
  const auto seen = [](Solver& s) {
    test::run(s, 2);
    return std::pair(test::positions_of(s, 0), test::positions_of(s, 1));
  };
  const auto as_before = seen(solver);
  solver.restore(before);
  solver.set_material(0, all[6]);
  solver.set_material(1, material_with(&Material::friction, 0));
  const std::vector<std::byte> after = solver.save();
  const auto as_after = seen(solver);
  EXPECT_NE(as_before, as_after);
  solver.restore(before);
  EXPECT_TRUE(solver.material(0) == all[1]);
  EXPECT_EQ(seen(solver), as_before);
  cloths[1].material = all[5];  // what it is made of comes with the state
  Solver other = make(cloths, settings);
  other.restore(after);
  EXPECT_TRUE(other.material(0) == all[6]);
  EXPECT_EQ(seen(other), as_after);
}

// Heavier cloth is as fast as it was, and falls as it would.
TEST_P(MaterialChange, KeepsPlacesAndSpeeds) {
  SolverSettings settings;
  settings.substeps = 4;
  Solver heavier = make(sheet(test::undamped()), settings), same = make(sheet(test::undamped()), settings);
  Material heavy = test::undamped();
  heavy.areal_density = 3;
  for (int f = 0; f < frames(); ++f) {
    if (f == 2) heavier.set_material(0, heavy);
    heavier.step();
    same.step();
  }
  const std::vector<Vec3> a = test::positions_of(heavier), b = test::positions_of(same);
  for (size_t p = 0; p < a.size(); ++p) EXPECT_LT(length(a[p] - b[p]), 2e-6F) << p;
}

// A hanging strip is as long as its own weight makes it (strain rho g L / 2 K in the mean), of whichever material it
// is.
TEST_P(MaterialChange, AHangingStripIsAsLongAsItsMaterialMakesIt) {
  if (machine().slow()) GTEST_SKIP() << "takes long there, and the springs are the same";
  Material soft = material_with(&Material::stretch_warp, 60), firm = material_with(&Material::stretch_warp, 200);
  for (Material* m : {&soft, &firm}) {
    m->max_stretch = 0;
    m->damping = 12;
  }
  const ClothDesc cloth = test::describe(test::make_sheet(kStrip), soft);
  SolverSettings settings;
  settings.substeps = 64;
  Solver solver = make(cloth, settings);
  hang_up(solver, cloth);
  const auto hangs_by = [&](const Material& m) {
    test::run(solver, 150);
    const std::vector<Vec3> x = test::positions_of(solver);
    const float far = x[test::sheet_pixel(kStrip, 2, 0)].y - x[test::sheet_pixel(kStrip, 2, kStripRows - 1)].y;
    const float strain = m.areal_density * 9.81F / (2 * m.stretch_warp);
    EXPECT_NEAR(far - 1, strain, 0.03F * strain);
  };
  hangs_by(soft);
  solver.set_material(0, firm);
  hangs_by(firm);
  solver.set_material(0, soft);
  hangs_by(soft);
}

// Cloth that is stretched far and gets a largest stretch is drawn together, not shot.
TEST_P(MaterialChange, AttachmentsThatComeDoNotPullAtOnce) {
  Material slack = material_with(&Material::stretch_warp, 4), held = slack;
  slack.max_stretch = 0;
  held.max_stretch = 0.02F;
  const ClothDesc cloth = test::describe(test::make_sheet(kStrip), slack);
  SolverSettings settings;
  settings.substeps = 4;
  Solver solver = make(cloth, settings);
  hang_up(solver, cloth);
  test::run(solver, machine().slow() ? 12 : 40);
  const auto stretch = [&] { return measure_stretch(*cloth.asset, 1, test::positions_of(solver)).max; };
  const auto fastest = [&] {
    float most = 0;
    for (const Vec3& v : test::velocities_of(solver)) most = std::max(most, length(v));
    return most;
  };
  ASSERT_GT(stretch(), 1.2);
  const float before = fastest();
  solver.set_material(0, held);
  for (int f = 0; f < 5; ++f) {
    solver.step();
    EXPECT_LT(fastest(), before + 1) << f;
  }
  if (machine().slow()) return;
  test::run(solver, 900);
  EXPECT_LT(stretch(), 1.06);
}

// From a soft knit to denim at once springs snap; a little in every frame they draw in.
TEST_P(MaterialChange, MixedFrameByFrameItComesWithoutAJerk) {
  if (machine().slow()) GTEST_SKIP() << "takes long there, and only mix() is new";
  const Material soft = material_with(&Material::stretch_warp, 10), firm = material_with(&Material::stretch_warp, 1000);
  const ClothDesc cloth = sheet(soft, 1);
  const auto fastest_in = [&](int frames) {
    SolverSettings settings;
    settings.substeps = 16;
    Solver solver = make(cloth, settings);
    solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
    test::run(solver, 180);
    float fastest = 0;
    for (int f = 1; f <= frames + 20; ++f) {
      solver.set_material(0, mix(soft, firm, static_cast<float>(f) / static_cast<float>(frames)));
      solver.step();
      for (const Vec3& v : test::velocities_of(solver)) fastest = std::max(fastest, length(v));
    }
    return fastest;
  };
  EXPECT_LT(fastest_in(60), 0.25F * fastest_in(1));
}

TEST_P(MaterialChange, WakesClothAndRefusesWhatIsNone) {
  SolverSettings settings;
  settings.substeps = 2;
  settings.sleep_speed = 0.5F;
  settings.sleep_time = 0.05F;
  settings.gravity = {};
  Solver solver = make(sheet({}), settings);
  test::run(solver, 8);
  ASSERT_TRUE(solver.asleep(0));
  solver.set_material(0, Material{});
  test::run(solver, 1);
  EXPECT_TRUE(solver.asleep(0)) << "it is of that material";
  solver.set_material(0, material_with(&Material::thickness, 0.01F));
  test::run(solver, 1);
  EXPECT_FALSE(solver.asleep(0));
  EXPECT_THROW(solver.set_material(0, material_with(&Material::areal_density, -1)), Error);
  EXPECT_THROW(solver.set_material(0, material_with(&Material::shear, NAN)), Error);
  EXPECT_THROW(solver.set_material(1, {}), Error);
  EXPECT_THROW(static_cast<void>(solver.material(1)), Error);
  EXPECT_TRUE(solver.material(0) == material_with(&Material::thickness, 0.01F));
}

INSTANTIATE_TEST_SUITE_P(On, MaterialChange, test::first_machine(), test::kMachineName);
INSTANTIATE_TEST_SUITE_P(On, MaterialChangeOnEveryPath, test::every_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
