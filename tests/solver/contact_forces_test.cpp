// SPDX-License-Identifier: GPL-3.0-or-later
// What cloth does to colliders: an engine moves its bodies by it, so a wrong sum lets them sink, drift or spin.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geocloth/asset/error.h"
#include "lib/contact_sum.h"
#include "solver_fixture.h"
#include "support/machine.h"
#include "support/momentum.h"

namespace geocloth {
namespace {

SolverSettings summing(uint32_t substeps = 8) {
  SolverSettings settings;
  settings.substeps = substeps;
  settings.contact_forces = true;
  return settings;
}

double mass_of(const ClothDesc& cloth) {
  double mass = 0;
  for (const double m : test::masses_of(cloth)) mass += m;
  return mass;
}

const double kGravity = 9.81F, kFrame = 1.0 / 60;

class ContactForces : public test::MachineTest<> {
 protected:
  /// Points along a side.
  [[nodiscard]] uint32_t side(uint32_t most) const { return machine().slow() ? 8 : most; }
};
class ContactForcesOnEveryPath : public ContactForces {};

/// Mean of some frames of one collider.
ContactForce mean_force(Solver& solver, int frames, size_t collider = 0) {
  std::array<double, 6> sum{};
  for (int f = 0; f < frames; ++f) {
    solver.step();
    const ContactForce contact = solver.contact_forces()[collider];
    for (size_t k = 0; k < 3; ++k) {
      sum[k] += test::component(contact.force, k) / frames;
      sum[3 + k] += test::component(contact.torque, k) / frames;
    }
  }
  const auto of = [&](size_t k) { return static_cast<float>(sum[k]); };
  return {{of(0), of(1), of(2)}, {of(3), of(4), of(5)}};
}

TEST_P(ContactForces, AFloorBearsTheWeightOfWhatLiesOnIt) {
  const test::SheetOptions sheet{
      .nx = side(24), .ny = side(24), .charts_x = 2, .horizontal = true, .center = {2, 0, 1}};
  const ClothDesc cloth = test::describe(test::make_sheet(sheet));
  Solver solver = make(cloth, summing());
  solver.set_colliders(std::vector{Collider{"floor", Plane{{0, -0.01F, 0}, {0, 1, 0}}, 0.5F}}, true);
  test::run(solver, machine().slow() ? 20 : 60);
  const double weight = mass_of(cloth) * kGravity;
  const ContactForce felt = mean_force(solver, machine().slow() ? 10 : 60);
  EXPECT_NEAR(static_cast<double>(felt.force.y), -weight, 0.002 * weight);
  EXPECT_NEAR(static_cast<double>(felt.force.x), 0, 0.002 * weight);
  EXPECT_NEAR(static_cast<double>(felt.force.z), 0, 0.002 * weight);
  // The plane's pose is the world's origin, and the sheet lies around (2, 0, 1).
  EXPECT_NEAR(static_cast<double>(felt.torque.x), weight, 0.005 * weight);
  EXPECT_NEAR(static_cast<double>(felt.torque.z), -2 * weight, 0.01 * weight);
}

/// A floor, a ball that hits the sheet from the side, a rod that its triangles meet.
std::vector<Collider> about_a_falling_sheet(int frame) {
  std::vector<Collider> colliders{{"floor", Plane{{0, -0.3F, 0}, {0, 1, 0}}, 0.4F},
                                  {"ball", Sphere{{}, 0.1F}, 0.6F},
                                  {"rod", Capsule{{-1, 0, 0}, {1, 0, 0}, 0.004F, 0.004F}, 0.2F}};
  colliders[1].pose.translate = {0.6F - 0.03F * static_cast<float>(frame), -0.05F, 0};
  colliders[2].pose.translate = {0, -0.1F, 0.1F};
  return colliders;
}

/// By how much the sheet's momentum differs from what gravity and colliders gave it [N s].
struct Balance {
  double largest = 0, sum = 0;       ///< of a frame, of all of them
  std::array<double, 3> impulses{};  ///< of each collider, sums without signs
  double largest_momentum = 0;
};

Balance balance_of(Solver& solver, const ClothDesc& cloth, int frames, size_t colliders) {
  Balance balance;
  std::array<double, 3> sum{};
  const double weight = mass_of(cloth) * kGravity;
  test::Momentum before = test::momentum_of(solver, cloth);
  for (int f = 0; f < frames; ++f) {
    std::vector<Collider> all = about_a_falling_sheet(f);
    all.resize(colliders);
    solver.set_colliders(all, f == 0);
    solver.step();
    const test::Momentum after = test::momentum_of(solver, cloth);
    std::array<double, 3> felt{};
    const std::vector<ContactForce> contacts = solver.contact_forces();
    for (size_t i = 0; i < contacts.size(); ++i) {
      for (size_t k = 0; k < 3; ++k) felt[k] += test::component(contacts[i].force, k);
      balance.impulses[i] += static_cast<double>(length(contacts[i].force)) * kFrame;
    }
    for (size_t k = 0; k < 3; ++k) {
      const double pulled = k == 1 ? -weight : 0, gained = after.linear[k] - before.linear[k];
      const double left = gained - (pulled - felt[k]) * kFrame;
      sum[k] += left;
      balance.largest = std::max(balance.largest, std::abs(left));
    }
    balance.largest_momentum = std::max(balance.largest_momentum, after.linear_scale);
    before = after;
  }
  balance.sum = std::hypot(sum[0], sum[1], sum[2]);
  return balance;
}

// What the cloth gains is what gravity and colliders give it: to rounding where points give way to springs as their
// masses have it; where colliders hold some of them so hard that they do not (lib/yield.h), nearly.
TEST_P(ContactForcesOnEveryPath, ACollidersLossIsTheClothsGain) {
  const test::SheetOptions sheet{
      .nx = side(20), .ny = side(20), .width = 0.6F, .height = 0.6F, .charts_x = 2, .charts_y = 2, .horizontal = true};
  const ClothDesc cloth = test::describe(test::make_sheet(sheet), test::undamped());
  const int frames = machine().slow() ? 20 : 60;
  Solver on_floor = make(cloth, summing(4));
  const Balance exact = balance_of(on_floor, cloth, frames, 1);
  EXPECT_LT(exact.largest, 1e-5 * exact.largest_momentum);
  EXPECT_GT(exact.impulses[0], exact.largest_momentum);
  if (machine().slowest()) return;
  Solver among_all = make(cloth, summing(4));
  const Balance nearly = balance_of(among_all, cloth, frames, 3);
  EXPECT_LT(nearly.largest, 0.05 * nearly.largest_momentum);
  EXPECT_LT(nearly.sum, 0.05 * nearly.largest_momentum);
  for (const double impulse : nearly.impulses) EXPECT_GT(impulse, 0.002 * nearly.largest_momentum);
}

// All of a cloth's weight, where it hangs over something small and springs draw so hard on few points of it that they
// give way less than their masses have it (lib/yield.h): as on the shoulders of whoever wears it.
TEST_P(ContactForces, WhatFewPointsLieOnBearsAllOfTheCloth) {
  if (machine().slow()) GTEST_SKIP() << "the sum is the cpu's, as random scenes have it";
  const test::SheetOptions sheet{.nx = 30, .ny = 30, .horizontal = true};
  const ClothDesc cloth = test::describe(test::make_sheet(sheet));
  for (const Collider& small : {Collider{"rod", Capsule{{-1, -0.02F, 0}, {1, -0.02F, 0}, 0.01F, 0.01F}, 0.8F},
                                Collider{"ball", Sphere{{0, -0.09F, 0}, 0.08F}, 0.8F}}) {
    Solver solver = make(cloth, summing(16));
    solver.set_colliders(std::vector{small}, true);
    test::run(solver, 240);
    const double weight = mass_of(cloth) * kGravity;
    const ContactForce felt = mean_force(solver, 60);
    EXPECT_NEAR(static_cast<double>(felt.force.y), -weight, 0.03 * weight) << small.name;
  }
}

// A sheet that slides down a slope drags it along by friction: mu times how hard it presses.
TEST_P(ContactForces, FrictionDragsASlopeAlong) {
  const test::SheetOptions sheet{.nx = side(16), .ny = side(16), .horizontal = true};
  ClothDesc cloth = test::describe(test::make_sheet(sheet), test::undamped());
  cloth.material.friction = 0.2F;
  cloth.transform.rotate = quat_from_euler_deg({30, 0, 0});
  Solver solver = make(cloth, summing(16));
  const float slope = 30.F * 3.14159265F / 180;
  const Vec3 normal{0, std::cos(slope), std::sin(slope)}, down{0, -std::sin(slope), std::cos(slope)};
  solver.set_colliders(std::vector{Collider{"slope", Plane{-0.003F * normal, normal}, 0.2F}}, true);
  test::run(solver, 10);
  const double weight = mass_of(cloth) * kGravity;
  const Vec3 force = mean_force(solver, 20).force;
  EXPECT_NEAR(static_cast<double>(dot(force, normal)), -weight * std::cos(30 * 3.14159265 / 180), 0.01 * weight);
  EXPECT_NEAR(static_cast<double>(dot(force, down)), 0.2 * weight * std::cos(30 * 3.14159265 / 180), 0.01 * weight);
}

// An engine's loop: it moves a ball by its weight and by what the cloth does to it.
TEST_P(ContactForces, ANetCarriesABallThatFallsIntoIt) {
  if (machine().slow()) GTEST_SKIP() << "eight seconds of 240 frames";
  const test::SheetOptions sheet{.nx = 24, .ny = 24, .horizontal = true};
  ClothDesc cloth = test::describe(test::make_sheet(sheet), find_material_preset("cotton")->material);
  cloth.material.damping = 6;
  constexpr float kMass = 0.3F, kRadius = 0.12F, kStep = 1.F / 240;
  SolverSettings settings = summing(4);
  settings.frame_time = static_cast<double>(kStep);
  Solver solver = make(cloth, settings);
  std::vector<Pin> pins;
  for (const char* edge : {"top", "bottom", "left", "right"})
    for (const Pin& pin : test::pins_at_rest(*cloth.asset, edge)) pins.push_back(pin);
  solver.set_pins(0, pins);
  Collider ball{"ball", Sphere{{}, kRadius}, 0.3F};
  ball.pose.translate = {0.05F, 0.4F, -0.03F};
  solver.set_colliders(std::vector{ball}, true);
  Vec3 velocity, borne, felt_before;
  float highest = 0;  ///< [m] that it would come by its energy, once it has met the net
  constexpr int kFrames = 1920, kLast = 960, kMet = 240;  // it goes on to bounce by a few centimetres
  for (int f = 0; f < kFrames; ++f) {
    solver.step();
    const Vec3 felt = solver.contact_forces()[0].force;
    if (f >= kFrames - kLast) borne = borne + (1.F / kLast) * felt;
    const Vec3 feels = 1.5F * felt - 0.5F * felt_before;  // in the next step
    felt_before = felt;
    velocity = velocity + kStep * (Vec3{0, static_cast<float>(-kGravity), 0} + (1 / kMass) * feels);
    ball.pose.translate = ball.pose.translate + kStep * velocity;
    solver.set_colliders(std::vector{ball});
    ASSERT_LT(length(ball.pose.translate), 1) << "frame " << f;
    const float height = ball.pose.translate.y + dot(velocity, velocity) / (2 * static_cast<float>(kGravity));
    if (f > kMet) highest = std::max(highest, height);
  }
  EXPECT_LT(highest, 0.4F) << "it gains no energy";
  const double weight = static_cast<double>(kMass) * kGravity;
  EXPECT_NEAR(static_cast<double>(borne.y), weight, 0.05 * weight);
  EXPECT_LT(std::abs(ball.pose.translate.y), 0.2F);
}

// Forces are told apart by cloth, follow their collider where the caller lists it elsewhere, and stay where cloth
// sleeps.
TEST_P(ContactForces, AreOfTheColliderThatFeltThem) {
  const test::SheetOptions near_sheet{.nx = 8, .ny = 8, .horizontal = true},
      far_sheet{.nx = 8, .ny = 8, .horizontal = true, .center = {3, 0, 0}};
  std::vector<ClothDesc> cloths{test::describe(test::make_sheet(near_sheet)),
                                test::describe(test::make_sheet(far_sheet))};
  cloths[1].meets = 2;
  SolverSettings settings = summing(4);
  settings.sleep_speed = 0.05F;
  settings.sleep_time = 0.1F;
  Solver solver = make(cloths, settings);
  Collider all{"for all", Plane{{0, -0.004F, 0}, {0, 1, 0}}}, second{"for the second", Sphere{{3, -0.2F, 0}, 0.3F}};
  all.groups = 3;
  second.groups = 2;
  solver.set_colliders(std::vector{all, second}, true);
  test::run(solver, 4);
  const std::vector<ContactForce> first = solver.contact_forces(0), other = solver.contact_forces(1),
                                  both = solver.contact_forces();
  ASSERT_EQ(both.size(), 2U);
  EXPECT_LT(first[0].force.y, -0.5F);
  EXPECT_EQ(length(first[1].force), 0);
  EXPECT_NE(length(other[1].force), 0);
  for (size_t i = 0; i < 2; ++i)
    EXPECT_LE(length(both[i].force - first[i].force - other[i].force), 1e-5F * length(both[i].force)) << i;

  solver.set_colliders(std::vector{second, Collider{"new", Sphere{{0, 9, 0}, 1}}, all});
  const std::vector<ContactForce> told = solver.contact_forces(1);
  ASSERT_EQ(told.size(), 3U);
  EXPECT_EQ(told[0].force, other[1].force);
  EXPECT_EQ(told[1].force, Vec3());
  EXPECT_EQ(told[2].force, other[0].force);
  EXPECT_EQ(told[0].torque, other[1].torque);

  for (int f = 0; f < 60 && !solver.asleep(0); ++f) solver.step();
  ASSERT_TRUE(solver.asleep(0));
  const Vec3 asleep = solver.contact_forces(0)[2].force;
  EXPECT_NEAR(static_cast<double>(asleep.y), -mass_of(cloths[0]) * kGravity, 0.05 * mass_of(cloths[0]) * kGravity);
  solver.step();
  EXPECT_EQ(solver.contact_forces(0)[2].force, asleep);
  const std::vector<std::byte> state = solver.save();
  solver.set_gravity({});
  test::run(solver, 3);
  ASSERT_FALSE(solver.asleep(0));
  solver.restore(state);
  EXPECT_EQ(solver.contact_forces(0)[2].force, asleep) << "a body that carries it would be free of it after a rollback";
  test::run(solver, 2);
  ASSERT_TRUE(solver.asleep(0));
  EXPECT_EQ(solver.contact_forces(0)[2].force, asleep);
  EXPECT_EQ(solver.save(), [&] {
    Solver again = make(cloths, settings);
    again.restore(state);
    test::run(again, 2);
    return again.save();
  }());
  solver.remove_cloth(0);
  EXPECT_THROW(static_cast<void>(solver.contact_forces(0)), Error);
  EXPECT_EQ(solver.contact_forces()[0].force, solver.contact_forces(1)[0].force);
}

TEST_P(ContactForces, AreToBeAskedForFirst) {
  const ClothDesc cloth = test::describe(test::make_sheet({.nx = 4, .ny = 4}));
  Solver solver = make(cloth, {});
  EXPECT_THROW(static_cast<void>(solver.contact_forces()), Error);
  Solver summed = make(cloth, summing());
  EXPECT_TRUE(summed.contact_forces().empty());
  summed.set_colliders(std::vector{Collider{"floor", Plane{}}});
  EXPECT_EQ(summed.contact_forces().at(0).force, Vec3()) << "no step yet";
  const std::vector<std::byte> state = summed.save();
  summed.step();
  summed.restore(state);
  EXPECT_EQ(summed.contact_forces().at(0).force, Vec3());
  summed.step();
  const Vec3 pressed = summed.contact_forces().at(0).force;
  ASSERT_NE(pressed, Vec3());
  const std::vector<std::byte> later = summed.save();
  test::run(summed, 3);
  summed.restore(later);
  EXPECT_EQ(summed.contact_forces().at(0).force, pressed);
}

// Shaders have no whole numbers of 64 bits, and the cpu takes a short cut past this.
TEST(ContactSum, AFixedPointIsTheWholeNumberNextToItTowardsZero) {
  for (const float v : {0.F, 0.99F, -0.99F, 1.F, -1.F, 4294967296.F, -4294967296.F, 8589934591.F, -4294967040.F, 3e18F,
                        -3e18F, 123456789.5F, -1.5e10F}) {
    const shader::FixedPoint n = shader::fixed_point(v);
    EXPECT_EQ(static_cast<int64_t>(uint64_t{n.high} << 32U | n.low), static_cast<int64_t>(v)) << v;
  }
  for (const float v : {5e18F, -1e30F, std::numeric_limits<float>::infinity(), std::nanf("")}) {
    EXPECT_EQ(shader::fixed_point(v).low, 0U) << v;
    EXPECT_EQ(shader::fixed_point(v).high, 0U) << v;
  }
}

INSTANTIATE_TEST_SUITE_P(On, ContactForces, test::first_machine(), test::kMachineName);
INSTANTIATE_TEST_SUITE_P(On, ContactForcesOnEveryPath, test::every_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
