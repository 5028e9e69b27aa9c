// SPDX-License-Identifier: GPL-3.0-or-later
// Characters come and go while a game runs. A cloth that comes later has to do what it had done as the first one, the
// others must not notice, and whatever its user says to a cloth by its number has to reach that one.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

using test::positions_of;
using testing::ElementsAre;
using testing::HasSubstr;

/// In two charts, at some place.
ClothDesc sheet_at(const Vec3& place, const Material& material = {}) {
  ClothDesc cloth = test::describe(test::make_sheet({.nx = 9, .ny = 7, .charts_x = 2}), material);
  cloth.transform.translate = place;
  return cloth;
}

/// Lies in the plane of its height.
ClothDesc floor_sheet(float height, uint32_t points = 9) {
  ClothDesc cloth = test::describe(test::make_sheet({.nx = points, .ny = points, .horizontal = true}));
  cloth.transform.translate = {0, height, 0};
  cloth.inter_collision = InterCollision{};
  return cloth;
}

std::vector<Pin> pins_of(const ClothDesc& cloth, const std::string& group) {
  return test::pins_at_rest(*cloth.asset, group, cloth.transform.translate);
}

class Adding : public test::MachineTest<> {
 protected:
  Adding() { settings_.substeps = 4; }
  SolverSettings settings_;
};

TEST_P(Adding, AClothThatComesLaterDoesWhatItDoesAlone) {
  const ClothDesc first = sheet_at({}), second = sheet_at({1.3F, 0, 0}, test::undamped());
  const auto hang = [&](Solver& solver, uint32_t number, const ClothDesc& cloth) {
    solver.set_pins(number, pins_of(cloth, "corners"));
  };
  Solver both = make(first, settings_), one = make(first, settings_), other = make(second, settings_);
  hang(both, 0, first);
  hang(one, 0, first);
  hang(other, 0, second);
  test::run(both, 3);
  test::run(one, 3);
  EXPECT_EQ(both.add_cloth(second), 1U);
  EXPECT_EQ(positions_of(both, 1), positions_of(other));
  hang(both, 1, second);
  for (int f = 0; f < 4; ++f) {
    both.step();
    one.step();
    other.step();
    EXPECT_EQ(positions_of(both, 0), positions_of(one));
    EXPECT_EQ(positions_of(both, 1), positions_of(other));
  }
  EXPECT_EQ(both.statistics().particles, 2 * one.statistics().particles);
}

TEST_P(Adding, NumbersStayWithTheirCloths) {
  const ClothDesc first = sheet_at({}), second = sheet_at({1.3F, 0, 0}), third = sheet_at({0, 0, 1});
  Solver solver = make(std::vector{first, second, third}, settings_), alone = make(third, settings_);
  solver.step();
  alone.step();
  const uint64_t bytes = solver.statistics().memory_bytes;
  solver.remove_cloth(0);
  EXPECT_LT(solver.statistics().memory_bytes, bytes);
  EXPECT_EQ(solver.cloth_count(), 2U);
  EXPECT_THAT(solver.cloths(), ElementsAre(1, 2));
  for (const auto& [number, told] : {std::pair<uint32_t, Solver*>{2, &solver}, {0, &alone}}) {
    told->set_pins(number, pins_of(third, "top"));
    told->set_material(number, test::material_with(&Material::stretch_weft, 200));
    told->set_pressure(number, 3);
    told->set_meets(number, 2);
    told->set_parent(number, {{0, 0, 0.1F}, {}, 1});
    told->set_colliders(std::vector{Collider{"ball", Sphere{{0, 0, 1.1F}, 0.2F}, 0.3F, {}, false, 2}});
    EXPECT_GT(told->cut(number, {Vec3{0, -1, 0}, {0, -0.1F, 2}, {0, -0.1F, 0}}).springs, 0U);
    test::run(*told, 3);
  }
  EXPECT_EQ(positions_of(solver, 2), positions_of(alone));
  EXPECT_EQ(solver.material(2).stretch_weft, 200);
  EXPECT_EQ(solver.held_pixels(2), alone.held_pixels(0));
  EXPECT_LT(positions_of(solver, 1)[0].y, 0.5F) << "nothing holds it";
  EXPECT_EQ(solver.add_cloth(first), 3U);
  EXPECT_THAT(solver.cloths(), ElementsAre(1, 2, 3));
  for (const uint32_t none : {0U, 4U}) {
    const auto says =
        HasSubstr(none == 0 ? "there is no cloth 0 any more; it has 3 cloths" : "there is no cloth 4; it");
    EXPECT_THAT([&] { solver.set_pins(none, {}); }, testing::ThrowsMessage<Error>(says));
    EXPECT_THAT([&] { solver.remove_cloth(none); }, testing::ThrowsMessage<Error>(says));
    EXPECT_THAT([&] { static_cast<void>(positions_of(solver, none)); }, testing::ThrowsMessage<Error>(says));
  }
}

TEST_P(Adding, ASolverMayHaveNoCloths) {
  const ClothDesc far = sheet_at({3000, 0, 0});
  Solver solver = make(std::span<const ClothDesc>{}, settings_), usual = make(far, settings_);
  solver.set_colliders(std::vector{Collider{"ball", Sphere{{3000, -0.3F, 0}, 0.2F}}});
  usual.set_colliders(std::vector{Collider{"ball", Sphere{{3000, -0.3F, 0}, 0.2F}}});
  test::run(solver, 2);
  EXPECT_EQ(solver.statistics().particles, 0U);
  for (const uint32_t number : {0U, 1U}) {
    EXPECT_EQ(solver.add_cloth(far), number);
    Solver same = make(far, settings_);
    for (Solver* told : {&solver, &same}) {
      told->set_colliders(std::vector{Collider{"ball", Sphere{{3000, -0.3F, 0}, 0.2F}}});
      test::run(*told, 3);
    }
    EXPECT_EQ(positions_of(solver, number), positions_of(same)) << "far away as exact as a solver of its own";
    solver.remove_cloth(number);
    solver.step();
  }
  EXPECT_THAT(solver.cloths(), ElementsAre());
}

TEST_P(Adding, WhatIsRefusedChangesNothing) {
  const ClothDesc first = floor_sheet(0);
  Solver solver = make(first, settings_), untouched = make(first, settings_);
  solver.step();
  untouched.step();
  ClothDesc without = first, weightless = first, fine = floor_sheet(0.1F);
  without.asset = nullptr;
  weightless.material.areal_density = 0;
  fine.transform.scale = 0.05F;
  fine.inter_collision = InterCollision{};
  const auto refuses = [&](const ClothDesc& cloth, const char* why) {
    EXPECT_THAT([&] { static_cast<void>(solver.add_cloth(cloth)); }, testing::ThrowsMessage<Error>(HasSubstr(why)));
  };
  refuses(without, "cloth 1: asset is null");
  refuses(weightless, "cloth 1: material");
  refuses(fine, "cloth 1 one of");
  EXPECT_THAT(solver.cloths(), ElementsAre(0));
  solver.step();
  untouched.step();
  EXPECT_EQ(positions_of(solver), positions_of(untouched));
  EXPECT_EQ(solver.add_cloth(first), 1U);
}

/// The lowest point of a cloth.
float bottom(Solver& solver, uint32_t cloth) {
  float y = 1e9F;
  for (const Vec3& p : positions_of(solver, cloth)) y = std::min(y, p.y);
  return y;
}

TEST_P(Adding, ClothsLieOnThoseThatCameLaterUntilTheyGo) {
  const uint32_t frames = machine().slow() ? 12 : 40, points = machine().slow() ? 6 : 9;
  const ClothDesc above = floor_sheet(0.25F, points);
  ClothDesc below = floor_sheet(0, points);
  below.transform.scale = 1.5F;
  Solver solver = make(above, settings_);
  solver.step();
  const uint32_t net = solver.add_cloth(below);
  std::vector<Pin> everywhere;
  for (uint32_t p = 0; p < below.asset->pixel_count(); ++p)
    if (below.asset->valid(p)) everywhere.push_back({p, apply(below.transform, below.asset->rest_position[p])});
  solver.set_pins(net, everywhere);
  test::run(solver, frames);
  EXPECT_GT(bottom(solver, 0), 0.5F * above.asset->spacing);
  const float before = bottom(solver, 0);
  solver.remove_cloth(net);
  test::run(solver, frames);
  EXPECT_LT(bottom(solver, 0), before - 0.15F) << "what lay on it falls";
  const uint32_t again = solver.add_cloth(below);
  EXPECT_EQ(again, net + 1);
  test::run(solver, 2);
}

TEST_P(Adding, WhatLayOnAClothWakesWhenItGoes) {
  settings_.sleep_speed = 0.5F;
  settings_.sleep_time = 0;
  settings_.gravity = {0, -0.1F, 0};
  const ClothDesc above = floor_sheet(0.16F, 7), below = floor_sheet(0, 7);
  Solver solver = make(std::vector{below, above}, settings_);
  test::run(solver, 6);
  EXPECT_TRUE(solver.asleep(1));
  solver.remove_cloth(0);
  solver.step();
  EXPECT_FALSE(solver.asleep(1));
}

TEST_P(Adding, ClothsThatComeTogetherKeepAsNearAsTheyStart) {
  settings_.gravity = {};
  const auto gap_after = [&](bool together) {
    const ClothDesc shirt = floor_sheet(0, 7), jacket = floor_sheet(0.01F, 7);
    Solver solver = make(std::span<const ClothDesc>{}, settings_);
    solver.step();
    const uint32_t lower = solver.add_cloth(shirt);
    if (!together) solver.step();
    const uint32_t upper = solver.add_cloth(jacket);
    test::run(solver, 8);
    float fastest = 0;
    for (const Vec3& v : test::velocities_of(solver, upper)) fastest = std::max(fastest, length(v));
    EXPECT_LT(fastest, 0.5F) << "parts without being thrown";
    return bottom(solver, upper) - bottom(solver, lower);
  };
  const float spacing = floor_sheet(0, 7).asset->spacing;
  EXPECT_NEAR(gap_after(true), 0.01F, 1e-4F);
  EXPECT_GT(gap_after(false), spacing);
}

TEST_P(Adding, AStateComesBackWhateverNumbersItsClothsHave) {
  const ClothDesc shirt = floor_sheet(0, 6), jacket = floor_sheet(0.01F, 6), coat = floor_sheet(0.1F, 6);
  Solver solver = make(std::vector{coat, shirt}, settings_);
  solver.step();
  solver.remove_cloth(0);
  const uint32_t added = solver.add_cloth(jacket);
  test::run(solver, 2);
  const std::vector<std::byte> state = solver.save();
  test::run(solver, 3);
  Solver other = make(std::vector{shirt, jacket}, settings_);
  other.restore(state);
  test::run(other, 3);
  EXPECT_EQ(positions_of(other, 0), positions_of(solver, 1));
  EXPECT_EQ(positions_of(other, 1), positions_of(solver, added));
  solver.add_cloth(coat);
  EXPECT_THAT([&] { solver.restore(state); }, testing::ThrowsMessage<Error>(HasSubstr("remove those that were added")));
}

INSTANTIATE_TEST_SUITE_P(On, Adding, test::every_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
