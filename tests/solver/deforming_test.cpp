// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that deform: an animated character carries its clothes as a rigid one does, and they stay outside of it.

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "geocloth/solver/solid.h"
#include "solver_fixture.h"
#include "support/ball_surface.h"
#include "support/machine.h"

namespace geocloth {
namespace {

constexpr float kFrame = 1.F / 60;    ///< [s]
constexpr float kNodes = 0.015F;      ///< [m] between nodes
constexpr float kThickness = 0.002F;  ///< [m]

TriangleSurface ball_surface(float radius) {
  return test::ball_surface({}, radius, 40, 20);
}

/// Where a point of a body is after some frames.
using Way = std::function<Vec3(const Vec3& p, float frames)>;

TriangleSurface moved(TriangleSurface surface, const Way& way, float frames) {
  for (Vec3& p : surface.position) p = way(p, frames);
  return surface;
}

Collider solid(DistanceField field) {
  return {"body", MeshSolid{std::make_shared<const DistanceField>(std::move(field))}, 0.5F, {}};
}

Collider deformed(const TriangleSurface& rest, const Way& way, int frame) {
  const auto f = static_cast<float>(frame);
  return solid(make_deforming_field(moved(rest, way, f), moved(rest, way, f - 1).position, kNodes));
}

class Deforming : public test::MachineTest<> {
 protected:
  [[nodiscard]] int points() const { return machine().slow() ? 15 : 33; }
  [[nodiscard]] Solver sheet_above(float height) {
    const auto n = static_cast<uint32_t>(points());
    Material material;
    material.friction = 0.5F;
    material.thickness = kThickness;
    SolverSettings settings;
    settings.substeps = 8;
    settings.check_copies = true;
    return make(
        test::describe(
            test::make_sheet(
                {.nx = n, .ny = n, .width = 0.6F, .height = 0.6F, .horizontal = true, .center = {0, height, 0}}),
            material),
        settings);
  }
};

Transform rolled(float frames) {
  return {
      {0.4F * kFrame * frames, 0.1F * kFrame * frames, 0}, quat_from_euler_deg({0, 0.8F * frames, 0.5F * frames}), 1};
}

/// Mean of the points.
Vec3 middle(Solver& solver) {
  Vec3 sum;
  const std::vector<Vec3> x = test::positions_of(solver);
  for (const Vec3& p : x) sum += p;
  return (1.F / static_cast<float>(x.size())) * sum;
}

TEST_P(Deforming, WhoseVerticesAllGoAlikeCarriesAsOneThatIsMoved) {
  const int frames = machine().slow() ? 10 : 45;
  const TriangleSurface rest = ball_surface(0.15F);
  const Way way = [](const Vec3& p, float f) { return apply(rolled(f), p); };
  Solver rigid = sheet_above(0.155F), bent = sheet_above(0.155F);
  Collider body = solid(make_deforming_field(rest, rest.position, kNodes));
  rigid.set_colliders(std::vector{body}, true);
  bent.set_colliders(std::vector{deformed(rest, way, 0)}, true);
  for (int f = 1; f <= frames; ++f) {
    body.pose = rolled(static_cast<float>(f));
    rigid.set_colliders(std::vector{body});
    bent.set_colliders(std::vector{deformed(rest, way, f)});
    rigid.step();
    bent.step();
    EXPECT_LE(bent.statistics().penetration, 0.5F * kThickness) << f;
  }
  // It falls into other folds, as the nodes lie elsewhere in the ball; it goes as far.
  const Vec3 a = middle(rigid), b = middle(bent);
  EXPECT_LT(length(a - b), 0.006F);
  EXPECT_GT(a.x, machine().slow() ? 0.02F : 0.2F);
}

TEST_P(Deforming, ThatSwellsPushesClothOut) {
  const int frames = machine().slow() ? 10 : 40;
  const TriangleSurface rest = ball_surface(0.1F);
  const Way way = [](const Vec3& p, float f) { return (1 + 0.03F * f) * p; };  // 18 cm/s
  Solver solver = sheet_above(0.11F);
  solver.set_colliders(std::vector{deformed(rest, way, 0)}, true);
  for (int f = 1; f <= frames; ++f) {
    solver.set_colliders(std::vector{deformed(rest, way, f)});
    solver.step();
    EXPECT_LE(solver.statistics().penetration, 0.5F * kThickness) << f;
  }
  float highest = 0;
  for (const Vec3& p : test::positions_of(solver)) highest = std::max(highest, p.y);
  const float radius = 0.1F * (1 + 0.03F * static_cast<float>(frames));
  EXPECT_NEAR(highest, radius, 0.01F);
}

/// [m/s] Of its fastest point.
float speed_of(Solver& solver) {
  float fastest = 0;
  for (const Vec3& v : test::velocities_of(solver)) fastest = std::max(fastest, length(v));
  return fastest;
}

/// Two legs that pass each other: between them neighbouring nodes go opposite ways.
TEST_P(Deforming, PartsThatGoOppositeWaysThrowNothing) {
  const int frames = machine().slow() ? 10 : 60;
  constexpr float kApart = 0.165F;
  const TriangleSurface leg = ball_surface(0.08F);
  TriangleSurface legs = leg;
  const auto half = static_cast<uint32_t>(leg.position.size());
  for (const Vec3& p : leg.position) legs.position.push_back(p + Vec3{0, 0, kApart});
  for (const auto& t : leg.triangle) legs.triangle.push_back({t[0] + half, t[1] + half, t[2] + half});
  const auto swing = [](float f) { return 0.1F * std::sin(0.1F * f); };  // 0.6 m/s at most
  const Way way = [&](const Vec3& p, float f) { return p + Vec3{p.z < 0.5F * kApart ? swing(f) : -swing(f), 0, 0}; };
  std::vector<Collider> rigid(2, solid(make_deforming_field(leg, leg.position, kNodes)));
  rigid[1].name = "other";
  Solver bent = sheet_above(0.085F), beside = sheet_above(0.085F);
  float fastest = 0, fastest_beside = 0;
  for (int f = 0; f <= frames; ++f) {
    bent.set_colliders(std::vector{deformed(legs, way, f)}, f == 0);
    rigid[0].pose.translate = {swing(static_cast<float>(f)), 0, 0};
    rigid[1].pose.translate = {-swing(static_cast<float>(f)), 0, kApart};
    beside.set_colliders(rigid, f == 0);
    if (f == 0) continue;
    for (Solver* solver : {&bent, &beside}) solver->step();
    EXPECT_LE(bent.statistics().penetration, kThickness) << f;
    fastest = std::max(fastest, speed_of(bent));
    fastest_beside = std::max(fastest_beside, speed_of(beside));
  }
  EXPECT_LT(fastest, 1.2F * fastest_beside);
}

/// Else cloth would be dragged on by a body whose animation has ended.
TEST_P(Deforming, ThatGetsNoNewFieldStandsStill) {
  const int frames = machine().slow() ? 4 : 12;
  const TriangleSurface rest = ball_surface(0.15F);
  const Way way = [](const Vec3& p, float f) { return p + Vec3{0.01F * f, 0.002F * f, 0}; };  // upwards, into the sheet
  Solver carried = sheet_above(0.152F), placed = sheet_above(0.152F);
  carried.set_colliders(std::vector{deformed(rest, way, 0)}, true);
  for (int f = 1; f <= frames; ++f) {
    carried.set_colliders(std::vector{deformed(rest, way, f)});
    carried.step();
  }
  EXPECT_GT(length(middle(carried) - Vec3{0, 0.152F, 0}), 0.001F);
  // The body that has stopped, and one that was never elsewhere, hold the same cloth alike.
  placed.set_colliders(std::vector{deformed(rest, way, frames)}, true);
  placed.step();
  const std::vector<Vec3> x = test::positions_of(carried), v(x.size());
  for (Solver* solver : {&carried, &placed}) {
    solver->write_state(0, x, v);
    solver->step();
  }
  EXPECT_EQ(test::positions_of(carried), test::positions_of(placed));
}

TEST_P(Deforming, WakesWhatItReachesAndNothingElse) {
  Material material;
  SolverSettings settings;
  settings.substeps = 4;
  settings.sleep_speed = 0.02F;
  settings.sleep_time = 0.05F;
  const ClothDesc near = test::describe(
      test::make_sheet({.nx = 6, .ny = 6, .width = 0.1F, .height = 0.1F, .horizontal = true, .center = {0, 0.002F, 0}}),
      material);
  ClothDesc far = near;
  far.transform.translate = {3, 0, 0};
  Solver solver = make(std::vector{near, far}, settings);
  const TriangleSurface rest = ball_surface(0.1F);
  const Way way = [](const Vec3& p, float f) { return p + Vec3{0, 0.4F - 0.01F * std::max(f - 20, 0.F), 0}; };
  const Collider floor{"floor", Plane{}, 0.5F, {}};
  solver.set_colliders(std::vector{floor, deformed(rest, way, 0)}, true);
  bool slept = false;
  for (int f = 1; f <= 50; ++f) {
    solver.set_colliders(std::vector{floor, deformed(rest, way, f)});
    solver.step();
    slept = slept || (f <= 20 && solver.asleep(0) && solver.asleep(1));
  }
  EXPECT_TRUE(slept);
  EXPECT_FALSE(solver.asleep(0));
  EXPECT_TRUE(solver.asleep(1));
}

TEST_P(Deforming, GoesOnFromASavedState) {
  const TriangleSurface rest = ball_surface(0.15F);
  const Way way = [](const Vec3& p, float f) { return (1 + 0.01F * f) * p + Vec3{0.01F * f, 0, 0}; };
  Solver one = sheet_above(0.155F), two = sheet_above(0.155F);
  const Collider second = deformed(rest, way, 2);
  one.set_colliders(std::vector{deformed(rest, way, 0)}, true);
  one.set_colliders(std::vector{deformed(rest, way, 1)});
  one.step();
  one.set_colliders(std::vector{second});  // which it has yet to do
  const std::vector<std::byte> state = one.save();
  two.set_colliders(std::vector{second}, true);
  two.restore(state);
  one.step();
  two.step();
  EXPECT_EQ(test::positions_of(one), test::positions_of(two));
}

INSTANTIATE_TEST_SUITE_P(On, Deforming, test::first_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
