// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth must stay outside of every solid, whatever its shape and however it moves, and friction must hold what Coulomb
// says.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <variant>

#include <gtest/gtest.h>

#include "colliders/match.h"
#include "colliders/ways.h"
#include "frame_input.h"
#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/ball_surface.h"

namespace geocloth {
namespace {

using test::make_sheet;
using test::SheetOptions;

struct ShapeCase {
  const char* name;
  std::function<ColliderShape()> make;  ///< in the test itself: every process of this program would make them all
};
void PrintTo(const ShapeCase& shape, std::ostream* out) {
  *out << shape.name;
}

class EveryShape : public ::testing::TestWithParam<ShapeCase> {
 protected:
  const ColliderShape shape_ = GetParam().make();

  static SheetOptions sheet() {
    SheetOptions options;
    options.nx = options.ny = 25;
    options.horizontal = true;
    options.charts_x = 2;
    options.center = {0, 0.6F, 0};
    return options;
  }
};

TEST_P(EveryShape, AtRestNoPointIsInside) {
  Solver solver(std::vector{test::describe(make_sheet(sheet()))}, test::cpu_settings());
  solver.set_colliders(std::vector<Collider>{{"solid", shape_, 0.3F, {}}});
  test::run(solver, 60);
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
  EXPECT_LE(solver.statistics().penetration, 0.0);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

TEST_P(EveryShape, MovingAndTurningNoPointIsInside) {
  Solver solver(std::vector{test::describe(make_sheet(sheet()))}, test::cpu_settings());
  Collider collider{"solid", shape_, 0.3F, {}};
  for (uint32_t f = 0; f < 60; ++f) {
    const float t = static_cast<float>(f) / 60.F;
    collider.pose.translate = {0.4F * std::sin(6 * t), 0.3F * std::sin(9 * t), 0};
    collider.pose.rotate = quat_from_euler_deg({60 * t, 40 * t, 90 * t});
    solver.set_colliders(std::vector{collider});
    solver.step();
  }
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
  EXPECT_LE(solver.statistics().penetration, 0.0);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
}

// Contacts are looked for where the way of a collider in a substep says that there may be any. One that is too short
// lets cloth sink in.
TEST_P(EveryShape, NoPointOnItGoesFartherThanItsWay) {
  if (std::holds_alternative<Plane>(shape_)) return;  // goes any way
  constexpr float kThickness = 0.01F;
  std::mt19937 random(7);
  const auto between = [&](float low, float high) {
    return low + (high - low) * static_cast<float>(random()) / static_cast<float>(std::mt19937::max());
  };
  const auto somewhere = [&](float size) {
    return Vec3{between(-size, size), between(-size, size), between(-size, size)};
  };
  for (int pair = 0; pair < 50; ++pair) {
    Collider before{"solid", shape_, 0.3F, {}}, after = before;
    before.pose = {somewhere(1), quat_from_euler_deg(somewhere(180)), 1};
    after.pose = {before.pose.translate + somewhere(0.02F), quat_from_euler_deg(somewhere(10)) * before.pose.rotate, 1};
    std::vector<float> numbers;
    std::vector<shader::ColliderShape> shapes{collider_shape_of(before, numbers)};
    std::vector<shader::ColliderPose> poses;
    const Transform from = collider_frame(before);
    collider_poses({&from, 1}, {&after, 1}, std::array{0.F}, 1, {}, poses);
    measure_ways(shapes, poses, 1, kThickness);
    float farthest = 0;
    for (int k = 0; k < 500; ++k) {
      const Vec3 local = Vec3{0, 0.2F, 0} + somewhere(0.6F), start = apply(before.pose, local);
      if (signed_distance(before, start) < kThickness)
        farthest = std::max(farthest, length(apply(after.pose, local) - start));
    }
    EXPECT_GT(farthest, 0);
    EXPECT_LE(farthest, shapes[0].way * 1.0001F);
  }
}

MeshSolid ball_mesh() {
  return {std::make_shared<const DistanceField>(make_distance_field(test::ball_surface({0, 0.2F, 0}, 0.25F), 60'000))};
}
Convex wedge() {
  return convex_hull(std::vector<Vec3>{{-0.3F, 0, -0.3F},
                                       {0.3F, 0, -0.3F},
                                       {0.3F, 0, 0.3F},
                                       {-0.3F, 0, 0.3F},
                                       {-0.3F, 0.3F, 0},
                                       {0.3F, 0.4F, 0.1F},
                                       {0, 0.1F, 0}});
}

template <class Shape>
ShapeCase shape_case(const char* name, Shape shape) {
  return {name, [shape = std::move(shape)] { return ColliderShape{shape}; }};
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, EveryShape,
    ::testing::Values(shape_case("plane", Plane{{0, 0.3F, 0}, {0, 1, 0}}),
                      shape_case("sphere", Sphere{{0, 0.2F, 0}, 0.25F}),
                      shape_case("capsule", Capsule{{-0.3F, 0.2F, 0}, {0.3F, 0.3F, 0.1F}, 0.12F, 0.12F}),
                      shape_case("tapered_capsule", Capsule{{-0.3F, 0.2F, 0}, {0.3F, 0.3F, 0.1F}, 0.18F, 0.06F}),
                      shape_case("box", Box{{0, 0.2F, 0}, {0.3F, 0.1F, 0.2F}, quat_from_euler_deg({10, 30, 5})}),
                      shape_case("ellipsoid",
                                 Ellipsoid{{0, 0.2F, 0}, {0.4F, 0.1F, 0.2F}, quat_from_euler_deg({0, 20, 10})}),
                      ShapeCase{"convex", [] { return ColliderShape{wedge()}; }},
                      ShapeCase{"mesh", [] { return ColliderShape{ball_mesh()}; }}),
    [](const auto& shape) { return shape.param.name; });

// A dancer who turned once a second had legs that went, by a ball about each, 5 mm in a substep: every frame had twice
// the substeps, cells met colliders, and a frame took a hundred times as long.
TEST(Collider, APoleThatTurnsAboutItsAxisIsNotFast) {
  SheetOptions options;
  options.nx = options.ny = 25;
  options.center = {0, 0, 0.3F};
  const auto play = [&](float degrees) {
    const ClothAsset sheet = make_sheet(options);
    Solver solver(std::vector{test::describe(sheet)}, test::cpu_settings());
    solver.set_pins(0, test::pins_at_rest(sheet, "top"));
    Collider pole{"pole", Capsule{{0, -1, 0}, {0, 1, 0}, 0.1F, 0.1F}, 0.3F, {}};
    for (int f = 0; f < 30; ++f) {
      pole.pose.rotate = quat_from_euler_deg({0, degrees * static_cast<float>(f), 0});
      solver.set_colliders(std::vector{pole});
      solver.step();
    }
    return hash_state(sheet, test::positions_of(solver));
  };
  EXPECT_EQ(play(12), play(0));
}

// Triangles that lie over the edges of a table's top are inside it for good. Where they were pushed out in every
// substep, the whole cloth trembled by a millimetre a frame, for ever: where the top is thicker than two spacings, and
// where it is a thin board, which is met by triangles also at rest.
TEST(Collider, ClothOverATablesEdgesComesToRest) {
  SheetOptions options;
  options.nx = options.ny = 41;
  options.horizontal = true;
  options.center = {0, 0.1F, 0};
  ClothDesc cloth = test::describe(make_sheet(options));
  cloth.material = find_material_preset("cotton")->material;
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 16;
  for (const float thickness : {0.08F, 0.02F}) {
    Solver solver({&cloth, 1}, settings);
    solver.set_colliders(std::vector<Collider>{{"top", Box{{}, {0.3F, thickness / 2, 0.3F}}, 0.5F, {}}});
    test::run(solver, 240);
    const double tremble = test::tremble(solver, 20);
    RecordProperty("mm", std::to_string(1000 * tremble));
    EXPECT_LT(tremble, 0.0003) << thickness;
  }
}

TEST(Collider, FastThinWallDoesNotTunnel) {
  SheetOptions options;
  options.nx = options.ny = 9;
  options.horizontal = true;
  options.center = {0, 1, 0};
  Solver solver(std::vector{test::describe(make_sheet(options), test::undamped())}, test::cpu_settings());
  const std::vector<Vec3> start = test::positions_of(solver);
  solver.write_state(0, start, std::vector<Vec3>(start.size(), Vec3{0, -20, 0}));  // 21 mm in a substep
  solver.set_colliders(std::vector<Collider>{{"wall", Box{{0, 0, 0}, {2, 0.002F, 2}, {}}, 0.3F, {}}});
  test::run(solver, 30);
  for (const Vec3& p : test::positions_of(solver)) EXPECT_GT(p.y, 0.002F);
}

TEST(Collider, ClothBetweenBallAndFloorIsInNeither) {
  SheetOptions options;
  options.nx = options.ny = 33;
  options.horizontal = true;
  options.charts_x = options.charts_y = 2;
  options.center = {0, 0.45F, 0};
  Solver solver(std::vector{test::describe(make_sheet(options))}, test::cpu_settings());
  // The ball stands on the floor, leans on a box and rolls: many points are in two or three solids at once.
  for (uint32_t f = 0; f < 90; ++f) {
    Collider ball{"ball", Sphere{{0, 0.2F, 0}, 0.2F}, 0.5F, {}};
    ball.pose.translate.x = 0.003F * static_cast<float>(f);
    solver.set_colliders(std::vector<Collider>{{"floor", Plane{{0, 0, 0}, {0, 1, 0}}, 0.5F, {}},
                                               ball,
                                               {"box", Box{{0.3F, 0.05F, 0}, {0.1F, 0.15F, 0.3F}, {}}, 0.5F, {}}});
    solver.step();
  }
  EXPECT_LE(solver.statistics().penetration, 0.002);  // the thickness
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
  for (const Vec3& v : test::velocities_of(solver)) EXPECT_LT(length(v), 10);
}

/// Two planes that lean on each other, so many degrees apart, open towards +x.
std::vector<Collider> cleft(float degrees) {
  const float half = degrees * std::numbers::pi_v<float> / 360;
  const float s = std::sin(half), c = std::cos(half);
  return {{"below", Plane{{}, {s, c, 0}}, 0.3F, {}}, {"above", Plane{{}, {s, -c, 0}}, 0.3F, {}}};
}

/// A little cloth at (x, 0, 0), after one substep.
Solver cloth_between(const std::vector<Collider>& solids, float x) {
  SheetOptions options;
  options.nx = options.ny = 3;
  options.width = options.height = 0.01F;
  options.horizontal = true;
  options.center = {x, 0, 0};
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 1;
  settings.gravity = {};
  Solver solver(std::vector{test::describe(make_sheet(options))}, settings);
  solver.set_colliders(solids);
  solver.step();
  return solver;
}

// Pushed out of one side and then the other, in twelve rounds, it is still deep in both.
TEST(Collider, ClothDeepInANarrowCleftOfTwoSolidsIsOutOfBothAfterOneSubstep) {
  for (const float degrees : {20.F, 12.F, 6.F, 4.F}) {
    Solver solver = cloth_between(cleft(degrees), -0.2F);
    EXPECT_LE(solver.statistics().penetration, 1e-5) << degrees;
    for (const Vec3& p : test::positions_of(solver)) EXPECT_LT(p.x, 0.05F) << degrees;  // no farther than needs be
  }
}

TEST(Collider, ClothDeepInACleftUnderABallIsOutAlongTheCleft) {
  for (const float degrees : {20.F, 12.F}) {
    std::vector<Collider> solids = cleft(degrees);
    solids.push_back({"ball", Sphere{{0.16F, 0, -0.1F}, 0.2F}, 0.3F, {}});
    Solver solver = cloth_between(solids, -0.02F);
    EXPECT_LE(solver.statistics().penetration, 1e-5) << degrees;
    for (const Vec3& p : test::positions_of(solver)) EXPECT_LT(length(p), 0.3F) << degrees;
  }
}

TEST(Collider, PointsThatStartDeepInsideComeOutWithoutAnExplosion) {
  SheetOptions options;
  options.nx = options.ny = 17;
  Solver solver(std::vector{test::describe(make_sheet(options))}, test::cpu_settings());
  solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, 0, 0.1F}, 0.3F}, 0.3F, {}}});
  solver.step();
  for (const Vec3& v : test::velocities_of(solver)) EXPECT_LT(length(v), 60);
  test::run(solver, 20);
  for (const Vec3& v : test::velocities_of(solver)) EXPECT_LT(length(v), 10);
  EXPECT_LE(solver.statistics().penetration, 0.0);
}

TEST(Collider, FrictionCarriesClothAlongOnAMovingFloor) {
  SheetOptions options;
  options.nx = options.ny = 9;
  options.horizontal = true;
  options.center = {0, 0.002F, 0};
  Solver solver(std::vector{test::describe(make_sheet(options), test::undamped())}, test::cpu_settings());
  Collider floor{"floor", Box{{0, -0.5F, 0}, {5, 0.5F, 5}, {}}, 0.8F, {}};
  for (uint32_t f = 0; f < 60; ++f) {
    floor.pose.translate.x = 0.5F * static_cast<float>(f * f) / 3600.F;  // 1 m/s^2, less than friction can hold
    solver.set_colliders(std::vector{floor});
    solver.step();
  }
  const float shift = floor.pose.translate.x;
  EXPECT_NEAR(test::positions_of(solver)[0].x, -0.5F + shift, 0.01F);
}

// Poses of substeps were rounded where the world has them: a hundred metres out a belt at 2 m/s went by now 4 um too
// much in a substep, now too little, and what lay on it crept by some millimetres a second, either way.
TEST(Collider, FrictionHoldsClothOnABeltThatIsFarOut) {
  constexpr uint32_t kFrames = 180;
  constexpr float kFar = 100, kSpeed = 2;
  SheetOptions options;
  options.nx = options.ny = 9;
  options.width = options.height = 0.4F;
  options.horizontal = true;
  options.center = {kFar, 0.001F, 0};
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 32;
  Material material = test::undamped();
  material.friction = 0.5F;
  Solver solver(std::vector{test::describe(make_sheet(options), material)}, settings);
  const std::vector<Vec3> start = test::positions_of(solver);
  solver.write_state(0, start, std::vector<Vec3>(start.size(), {kSpeed, 0, 0}));
  Collider belt{"belt", Box{{kFar, -0.1F, 0}, {1.5F, 0.1F, 1.5F}, {}}, 0.5F, {}};
  const auto slip = [&] {
    double mean = 0;
    for (const Vec3& p : test::positions_of(solver)) mean += static_cast<double>(p.x);
    return mean / static_cast<double>(start.size()) - static_cast<double>(belt.pose.translate.x);
  };
  double before = 0;
  for (uint32_t f = 0; f <= kFrames; ++f) {
    belt.pose.translate.x = kSpeed * static_cast<float>(f) / 60.F;
    solver.set_colliders(std::vector{belt});
    solver.step();
    if (f == kFrames / 3) before = slip();
  }
  EXPECT_NEAR(slip(), before, 2e-4);
}

/// Distance by brute force: the nearest of many surface points, with the sign of `inside`.
double sampled_distance(const Vec3& p, const std::vector<Vec3>& surface, bool inside) {
  double nearest = 1e9;
  for (const Vec3& q : surface) nearest = std::min(nearest, static_cast<double>(length(p - q)));
  return inside ? -nearest : nearest;
}

TEST(SignedDistance, OfAnEllipsoidIsThatToItsNearestPoint) {
  const Vec3 r{0.4F, 0.1F, 0.25F};
  const Collider collider{"egg", Ellipsoid{{1, 2, 3}, r, quat_from_euler_deg({20, 30, 40})}, 0.3F, {}};
  std::vector<Vec3> surface;
  for (int i = 0; i <= 400; ++i)
    for (int j = 0; j < 800; ++j) {
      const double u = std::numbers::pi * i / 400, v = 2 * std::numbers::pi * j / 800;
      surface.push_back({static_cast<float>(r.x * std::sin(u) * std::cos(v)), static_cast<float>(r.y * std::cos(u)),
                         static_cast<float>(r.z * std::sin(u) * std::sin(v))});
    }
  const Transform pose{{1, 2, 3}, quat_from_euler_deg({20, 30, 40}), 1};
  for (const Vec3& p : {Vec3{0.5F, 0.2F, 0.1F}, Vec3{0.1F, 0.02F, 0.05F}, Vec3{0, 0.3F, 0}, Vec3{0.39F, 0, 0},
                        Vec3{-0.2F, -0.05F, 0.3F}, Vec3{0, 0, 0}, Vec3{3, 1, -2}}) {
    const bool inside = p.x * p.x / (r.x * r.x) + p.y * p.y / (r.y * r.y) + p.z * p.z / (r.z * r.z) < 1;
    EXPECT_NEAR(signed_distance(collider, apply(pose, p)), sampled_distance(p, surface, inside), 3e-5)
        << p.x << ' ' << p.y << ' ' << p.z;
  }
}

// A tool that asks before it sets its colliders crashed on those that the solver refuses.
TEST(SignedDistance, OfWhatIsNoColliderIsRefused) {
  DistanceField few;
  few.size = {2, 2, 2};
  few.spacing = 1;
  few.distance.resize(7);
  const std::vector<ColliderShape> shapes{MeshSolid{}, Convex{}, MeshSolid{std::make_shared<const DistanceField>(few)},
                                          Sphere{{}, -1}};
  for (const ColliderShape& shape : shapes) {
    const Collider collider{.name = "body", .shape = shape};
    try {
      static_cast<void>(signed_distance(collider, {}));
      ADD_FAILURE() << shape.index();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      EXPECT_NE(std::string(e.what()).find("\"body\""), std::string::npos) << e.what();
    }
    EXPECT_THROW(SignedDistance{collider}, Error);
  }
}

TEST(SignedDistance, OfTheOtherShapes) {
  const auto at = [](ColliderShape shape, const Vec3& p) { return signed_distance({"", shape, 0, {}}, p); };
  EXPECT_NEAR(at(Plane{{0, 1, 0}, {0, 0.6F, 0.8F}}, {5, 2, 1}), 1.4, 1e-6);
  EXPECT_NEAR(at(Sphere{{1, 0, 0}, 0.5F}, {1, 2, 0}), 1.5, 1e-6);
  EXPECT_NEAR(at(Box{{0, 0, 0}, {1, 2, 3}, {}}, {2, 3, 0}), std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(at(Box{{0, 0, 0}, {1, 2, 3}, {}}, {0.5F, 0, 0}), -0.5, 1e-6);
  EXPECT_NEAR(at(Box{{0, 0, 0}, {1, 2, 3}, quat_from_euler_deg({0, 0, 90})}, {0, 2, 0}), 1.0, 1e-6);
  EXPECT_NEAR(at(Capsule{{0, 0, 0}, {0, 2, 0}, 0.5F, 0.5F}, {1, 1, 0}), 0.5, 1e-6);
  EXPECT_NEAR(at(Capsule{{0, 0, 0}, {0, 2, 0}, 0.5F, 0.5F}, {0, 3, 0}), 0.5, 1e-6);
  // A cone of half angle 30 degrees between balls of 1 and 0.5 that are 1 apart: its side is the line at distance
  // 1 from the axis' start, tilted by 30 degrees.
  const Capsule tapered{{0, 0, 0}, {0, 1, 0}, 1.F, 0.5F};
  EXPECT_NEAR(at(tapered, {2, 0, 0}), 1.0, 1e-6);
  EXPECT_NEAR(at(tapered, {2 * std::cos(std::numbers::pi_v<float> / 6), 1, 0}), 2 * 0.75 + 0.5 - 1, 1e-6);
  EXPECT_NEAR(at(tapered, {0, 2, 0}), 0.5, 1e-6);
  EXPECT_NEAR(at(Capsule{{0, 0, 0}, {0, 0.1F, 0}, 1.F, 0.5F}, {0, 2, 0}), 1.0, 1e-6);  // one ball holds the other
  EXPECT_NEAR(at(Capsule{{0, 0, 0}, {0, 0, 0}, 0.5F, 0.5F}, {0, 2, 0}), 1.5, 1e-6);
}

TEST(Convex, HullOfABoxesCornersIsTheBox) {
  std::vector<Vec3> points{{0, 0, 0}, {0.1F, -0.2F, 0.3F}};  // two inside
  for (const float x : {-1.F, 1.F})
    for (const float y : {-2.F, 2.F})
      for (const float z : {-3.F, 3.F}) points.push_back({x, y, z});
  const Convex hull = convex_hull(points);
  EXPECT_EQ(hull.planes.size(), 6U);
  const Collider box{"", Box{{0, 0, 0}, {1, 2, 3}, {}}, 0, {}}, convex{"", hull, 0, {}};
  for (const Vec3& p : {Vec3{0.5F, 0, 0}, Vec3{1.5F, 0, 0}, Vec3{0, -2.5F, 1}, Vec3{0.2F, 1.9F, 0}})
    EXPECT_NEAR(signed_distance(convex, p), signed_distance(box, p), 1e-6);
}

TEST(Convex, PlanesAreTheSameSolidAsTheirCorners) {
  const Convex hull = wedge();
  const Convex again = convex_of_planes(hull.planes);
  EXPECT_FALSE(again.surface.triangle.empty());
  for (const Vec3& p : {Vec3{0, 0.1F, 0}, Vec3{1, 1, 1}, Vec3{-0.3F, 0.35F, 0}})
    EXPECT_NEAR(signed_distance({"", hull, 0, {}}, p), signed_distance({"", again, 0, {}}, p), 1e-5);
  const std::vector<Plane> gutter{{{0, 0, 0}, {0, 1, 0}}, {{0, 0, 0}, {1, 0, 0}}};
  EXPECT_TRUE(convex_of_planes(gutter).surface.triangle.empty());
  EXPECT_NEAR(signed_distance({"", convex_of_planes(gutter), 0, {}}, {-2, -1, 5}), -1, 1e-6);
}

// The four corners of such a well lie in one plane, which was taken for a hull without a volume.
TEST(Convex, PlanesMayLeaveAPrismOpen) {
  const std::vector<Plane> well{{{0, 0, 0}, {0, 1, 0}},
                                {{1, 0, 0}, {1, 0, 0}},
                                {{-1, 0, 0}, {-1, 0, 0}},
                                {{0, 0, 1}, {0, 0, 1}},
                                {{0, 0, -1}, {0, 0, -1}}};
  const Convex open = convex_of_planes(well);
  EXPECT_TRUE(open.surface.triangle.empty());
  EXPECT_NEAR(signed_distance({"", open, 0, {}}, {0.5F, -3, 0}), -0.5, 1e-6);
}

// A box of planes that point inwards has nothing behind them: cloth fell through it, and nothing said why.
TEST(Convex, PlanesThatPointInwardsAreRefused) {
  std::vector<Plane> inwards;
  for (const float side : {-1.F, 1.F})
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
      inwards.push_back({side * axis, -side * axis});
  EXPECT_THROW(static_cast<void>(convex_of_planes(inwards)), Error);
  inwards.resize(1);  // a half space is a solid either way
  EXPECT_NO_THROW(static_cast<void>(convex_of_planes(inwards)));
}

TEST(Convex, PointsInAPlaneAreRefused) {
  EXPECT_THROW(static_cast<void>(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}})), Error);
  EXPECT_THROW(static_cast<void>(convex_hull(std::vector<Vec3>(5, Vec3{1, 2, 3}))), Error);
}

std::vector<Vec3> box_corners() {
  std::vector<Vec3> points;
  for (const float x : {-1.F, 1.F})
    for (const float y : {-2.F, 2.F})
      for (const float z : {-3.F, 3.F}) points.push_back({x, y, z});
  return points;
}

/// Spread evenly over the unit ball's surface.
std::vector<Vec3> on_ball(int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const float z = (2 * static_cast<float>(i) + 1) / static_cast<float>(count) - 1,
                turn = 2.39996F * static_cast<float>(i);
    points.push_back({std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z});
  }
  return points;
}

void expect_the_box(const Convex& hull) {
  EXPECT_EQ(hull.planes.size(), 6U);
  for (const Plane& p : hull.planes) {
    EXPECT_NEAR(std::abs(p.normal.x) + std::abs(p.normal.y) + std::abs(p.normal.z), 1, 1e-5);
    EXPECT_NEAR(dot(p.normal, p.point), length(Vec3{1 * p.normal.x, 2 * p.normal.y, 3 * p.normal.z}), 1e-4);
  }
}

// Every point was held against every face each time that one was added: 100,000 points never came to an end.
TEST(Convex, HullOfManyPointsIsThatOfTheFewOutside) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(-1, 1);
  std::vector<Vec3> points = box_corners();
  while (points.size() < 100'000) points.push_back({share(random), 2 * share(random), 3 * share(random)});
  std::shuffle(points.begin(), points.end(), random);
  expect_the_box(convex_hull(points));
  EXPECT_EQ(convex_hull(points), convex_hull(points));
  points.clear();  // a cloud, whose hull is one of many slim faces
  while (points.size() < 100'000) points.push_back({share(random), 2 * share(random), 3 * share(random)});
  const Convex cloud = convex_hull(points);
  EXPECT_GT(cloud.planes.size(), 50U);
  EXPECT_LT(cloud.surface.position.size(), 1000U);
  for (const Plane& plane : cloud.planes)
    for (const Vec3& p : points) ASSERT_LE(dot(plane.normal, p - plane.point), 2e-5F);
}

TEST(Convex, HullOfPointsOnABoxesFacesIsTheBox) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(-1, 1);
  std::vector<Vec3> points = box_corners();
  for (int i = 0; i < 10'000; ++i) {
    std::array<float, 3> p{share(random), share(random), share(random)};
    p[static_cast<size_t>(i % 3)] = i % 2 == 0 ? 1.F : -1.F;
    if (i % 5 == 0) p[static_cast<size_t>((i + 1) % 3)] = 1;  // on an edge
    points.push_back({p[0], 2 * p[1], 3 * p[2]});
  }
  for (int order = 0; order < 5; ++order) {
    expect_the_box(convex_hull(points));
    std::shuffle(points.begin(), points.end(), random);
  }
  const Quat turn = quat_from_euler_deg({20, 30, 40});
  for (Vec3& p : points) p = rotate(turn, p) + Vec3{10, 0, 0};
  EXPECT_EQ(convex_hull(points).planes.size(), 6U);
}

TEST(Convex, HullOfAGridIsTheBoxAboutIt) {
  std::vector<Vec3> points;
  for (int i = 0; i < 11 * 11 * 11; ++i) {
    const auto at = [](int k, float half) { return half * (0.2F * static_cast<float>(k % 11) - 1); };
    points.push_back({at(i, 1), at(i / 11, 2), at(i / 121, 3)});
  }
  expect_the_box(convex_hull(points));
}

TEST(Convex, PointsMayBeThereSeveralTimes) {
  std::vector<Vec3> points;
  for (int k = 0; k < 50; ++k)
    for (const Vec3& p : box_corners()) points.push_back(p);
  expect_the_box(convex_hull(points));
  EXPECT_EQ(convex_hull(points).surface.position.size(), 8U);
}

TEST(Convex, HullOfABallIsOnItAndHasNoMoreFacesThanItMay) {
  const std::vector<Vec3> points = on_ball(400);
  const Convex hull = convex_hull(points);
  EXPECT_EQ(hull.surface.position.size(), 400U);
  EXPECT_EQ(hull.surface.triangle.size(), 796U);
  for (const Plane& plane : hull.planes)
    for (const Vec3& p : points) ASSERT_LE(dot(plane.normal, p - plane.point), 1e-5F);
  EXPECT_THROW(static_cast<void>(convex_hull(on_ball(4'000))), Error);
  EXPECT_THROW(static_cast<void>(convex_hull(on_ball(100'000))), Error);
}

// One was taken for a point inside, and cloth went through where the corner was.
TEST(Convex, WhatIsNotFiniteIsRefused) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    std::vector<Vec3> points = box_corners();
    points[2].y = bad;
    EXPECT_THROW(static_cast<void>(convex_hull(points)), Error);
    EXPECT_THROW(static_cast<void>(convex_of_planes(std::vector<Plane>{{{bad, 0, 0}, {0, 1, 0}}})), Error);
  }
  EXPECT_THROW(static_cast<void>(convex_of_planes(std::vector<Plane>{{{0, 0, 0}, {0, 0, 0}}})), Error);
  EXPECT_THROW(static_cast<void>(convex_hull({})), Error);
}

/// Planes about a ball.
Convex convex_of(size_t planes) {
  Convex solid;
  for (const Vec3& p : on_ball(static_cast<int>(planes))) solid.planes.push_back({p, normalized(p)});
  return solid;
}

// The limit was a name in a header: 5000 planes were taken, and each point of the cloth looked at all of them.
TEST(Convex, OneMadeByHandHasNoMorePlanesThanItMay) {
  Solver solver(std::vector{test::describe(make_sheet({.nx = 5, .ny = 5}))}, test::cpu_settings());
  const auto set = [&](const Convex& solid) {
    solver.set_colliders(std::vector<Collider>{{"solid", solid, 0.3F, {}}});
  };
  EXPECT_NO_THROW(set(convex_of(kMostConvexPlanes)));
  EXPECT_THROW(set(convex_of(kMostConvexPlanes + 1)), Error);
  EXPECT_NO_THROW(static_cast<void>(convex_of_planes(convex_of(16).planes)));
  EXPECT_THROW(static_cast<void>(convex_of_planes(convex_of(kMostJoinedPlanes + 1).planes)), Error);
  Convex torn = convex_hull(box_corners());
  torn.surface.triangle[0][0] = 99;
  EXPECT_THROW(set(torn), Error);
  test::run(solver, 1);
}

// One made by hand was taken as it was: without distances the program ended, with others cloth was not a number.
TEST(DistanceField, OneMadeByHandIsChecked) {
  Solver solver(std::vector{test::describe(make_sheet({.nx = 5, .ny = 5}))}, test::cpu_settings());
  const auto set = [&](const DistanceField& field) {
    const Collider body{"body", MeshSolid{std::make_shared<const DistanceField>(field)}, 0.3F, {}};
    for (int frame = 0; frame < 2; ++frame) {  // it is looked at once
      solver.set_colliders({&body, 1});
      solver.step();
    }
  };
  DistanceField good;
  good.size = {2, 3, 4};
  good.low = {-1, -1, -1};
  good.spacing = 0.6F;
  good.margin = 0.1F;
  good.distance.assign(24, -0.01F);
  EXPECT_NO_THROW(set(good));
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  const auto refused = [&](const char* what, const auto& spoil) {
    DistanceField field = good;
    spoil(field);
    EXPECT_THROW(set(field), Error) << what;
  };
  refused("nothing", [](DistanceField& f) { f = {}; });
  refused("no distances", [](DistanceField& f) {
    f.size = {1000, 1000, 1000};
    f.distance.clear();
  });
  refused("one too few", [](DistanceField& f) { f.distance.pop_back(); });
  refused("product beyond 64 bits", [](DistanceField& f) {
    f.size = {1U << 31, 1U << 31, 4};
    f.distance.clear();
  });
  refused("one node", [](DistanceField& f) { f.size = {1, 6, 4}; });
  for (const float bad : {kNaN, kInfinity, -1.F}) {
    refused("spacing", [&](DistanceField& f) { f.spacing = bad; });
    refused("margin", [&](DistanceField& f) { f.margin = bad; });
  }
  refused("spacing 0", [](DistanceField& f) { f.spacing = 0; });
  refused("spacing 1e-40", [](DistanceField& f) { f.spacing = 1e-40F; });
  for (const float bad : {kNaN, kInfinity, 1e30F}) {
    refused("low", [&](DistanceField& f) { f.low.y = bad; });
    refused("distance", [&](DistanceField& f) { f.distance[23] = bad; });
  }
  refused("spacing 1e6", [](DistanceField& f) { f.spacing = 1e6F; });
  EXPECT_NO_THROW(set(good));
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

// Lists as programs keep them. A body taken for another one sweeps through all cloth between them, and one that is
// placed anew goes through cloth instead of pushing it.
class Matching : public testing::Test {
 protected:
  static Collider ball(float x, const char* name = "", float radius = 0.1F) {
    return {name, Sphere{{0, 0, 0}, radius}, 0.3F, {{x, 0, 0}, {}, 1}};
  }
  /// Number before of each collider now, -1 for a new one; each went by `way` before.
  static std::vector<int> matched(const std::vector<Collider>& before, const std::vector<Collider>& now,
                                  float way = 0) {
    std::vector<Vec3> expected;
    for (const Collider& c : before) expected.push_back(c.pose.translate + Vec3{way, 0, 0});
    std::vector<int> numbers;
    for (const std::optional<uint32_t>& m : match_colliders(before, expected, now))
      numbers.push_back(m ? static_cast<int>(*m) : -1);
    return numbers;
  }
};

TEST_F(Matching, UnnamedOnesOfOneShapeAreKnownByWhereTheyAre) {
  const std::vector<Collider> three{ball(0), ball(1), ball(2)};
  EXPECT_EQ(matched(three, {ball(0.1F), ball(1.1F), ball(2.1F), ball(3)}), (std::vector{0, 1, 2, -1}));
  EXPECT_EQ(matched(three, {ball(-1), ball(0.1F), ball(1.1F), ball(2.1F)}), (std::vector{-1, 0, 1, 2}));
  EXPECT_EQ(matched(three, {ball(1.1F), ball(2.1F)}), (std::vector{1, 2}));
  EXPECT_EQ(matched(three, {ball(0.1F), ball(2.1F)}), (std::vector{0, 2}));
  EXPECT_EQ(matched(three, {}), std::vector<int>{});
  EXPECT_EQ(matched({}, three), (std::vector{-1, -1, -1}));
  EXPECT_EQ(matched(three, {ball(5), ball(6), ball(7)}), (std::vector{0, 1, 2}));  // as many as before
}

TEST_F(Matching, BulletsInARowAreNotTakenForTheOneAhead) {
  const std::vector<Collider> row{ball(2), ball(1)};
  EXPECT_EQ(matched(row, {ball(3), ball(2), ball(1)}, 1), (std::vector{0, 1, -1}));
  EXPECT_EQ(matched(row, {ball(2)}, 1), std::vector{1});
}

TEST_F(Matching, UnnamedOnesKeepTheirShape) {
  const std::vector<Collider> two{ball(0, "", 0.1F), ball(0, "", 0.2F)};
  EXPECT_EQ(matched(two, {ball(9, "", 0.2F)}), std::vector{1});
  EXPECT_EQ(matched(two, {ball(0, "", 0.3F), ball(0, "", 0.1F), ball(0, "", 0.2F)}), (std::vector{-1, 0, 1}));
  EXPECT_EQ(matched(two, {ball(0, "", 0.3F), ball(0, "", 0.4F)}), (std::vector{0, 1}));  // they grow
}

TEST_F(Matching, NamesGoBeforeAllElse) {
  const std::vector<Collider> three{ball(0, "a"), ball(1, "b"), ball(2, "c")};
  EXPECT_EQ(matched(three, {ball(0, "c"), ball(2, "a", 0.5F), ball(1, "d")}), (std::vector{2, 0, -1}));
  const std::vector<Collider> same{ball(0, "a"), ball(1), ball(2, "a")};
  EXPECT_EQ(matched(same, {ball(2.1F, "a"), ball(7)}), (std::vector{2, 1}));
}

}  // namespace
}  // namespace geocloth
