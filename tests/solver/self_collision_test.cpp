// SPDX-License-Identifier: GPL-3.0-or-later
// Cloth against itself: layers do not go through each other, what does not touch is as if nothing had been asked for,
// and nothing is gained or lost in between.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/self_contact.h"

namespace geocloth::test {
namespace {

constexpr double kDistance = 1.2;  ///< of the spacing: SelfCollision's default

/// A sheet of 0.4 m that stands on its edge, a little askew, and falls into a heap.
ClothDesc falling_sheet(uint32_t charts, bool self_collision, uint32_t points = 31) {
  const SheetOptions options{.nx = points,
                             .ny = points,
                             .width = 0.4F,
                             .height = 0.4F,
                             .charts_x = charts,
                             .charts_y = charts,
                             .center = {0, 0.25F, 0}};
  ClothDesc cloth = describe(make_sheet(options));
  cloth.transform.rotate = quat_from_euler_deg({3, 0, 2});
  if (self_collision) cloth.self_collision = SelfCollision{};
  return cloth;
}

Collider floor_plane() {
  Collider floor;
  floor.shape = Plane{{0, 0, 0}, {0, 1, 0}};
  floor.friction = 0.5F;
  return floor;
}

Solver on_the_floor(const ClothDesc& cloth, uint32_t threads = 1, SolverPath path = SolverPath::automatic) {
  SolverSettings settings = cpu_settings();
  settings.threads = threads;
  settings.path = path;
  Solver solver(std::vector<ClothDesc>{cloth}, settings);
  solver.set_colliders(std::vector<Collider>{floor_plane()}, true);
  return solver;
}

double highest(const ClothDesc& cloth, const std::vector<Vec3>& positions) {
  float y = -std::numeric_limits<float>::max();
  for (uint32_t p = 0; p < positions.size(); ++p)
    if (cloth.asset->valid(p)) y = std::max(y, positions[p].y);
  return y;
}

TEST(SelfCollision, AHeapDoesNotGoThroughItself) {
  const ClothDesc cloth = falling_sheet(1, true);
  Solver solver = on_the_floor(cloth);
  run(solver, 120);
  const std::vector<Vec3> positions = positions_of(solver);
  const double spacing = cloth.asset->spacing;
  EXPECT_EQ(count_intersections(*cloth.asset, positions), 0U);
  EXPECT_GE(smallest_distance(*cloth.asset, positions, 1.9 * spacing), 0.8 * kDistance * spacing);
  EXPECT_LE(solver.statistics().penetration, 1e-6);

  const ClothDesc without = falling_sheet(1, false);
  Solver other = on_the_floor(without);
  run(other, 120);
  EXPECT_GE(count_intersections(*without.asset, positions_of(other)), 100U) << "there was nothing to prevent";
}

// How high a heap is hangs on the least change: 2 to 5 cm where the sheet began to fall by a degree less aslant.
TEST(SelfCollision, HeapsOfChartsAreLikeThoseOfOnePiece) {
  const std::array<float, 3> tilts{2, 3, 4};
  std::array<double, 2> height{};
  for (const uint32_t charts : {1U, 2U}) {
    for (const float degrees : tilts) {
      ClothDesc cloth = falling_sheet(charts, true);
      cloth.transform.rotate = quat_from_euler_deg({degrees, 0, 2});
      Solver solver = on_the_floor(cloth);
      run(solver, 120);
      const std::vector<Vec3> positions = positions_of(solver);
      EXPECT_EQ(count_intersections(*cloth.asset, positions), 0U) << charts << " x " << charts << " charts";
      EXPECT_EQ(solver.statistics().copy_gap, 0);
      height[charts - 1] += highest(cloth, positions) / static_cast<double>(tilts.size());
    }
  }
  EXPECT_NEAR(height[0], height[1], 0.02);
}

TEST(SelfCollision, ThreadsAndPathsGiveTheSameBits) {
  for (const uint32_t charts : {1U, 2U}) {
    const ClothDesc cloth = falling_sheet(charts, true, 41);
    std::vector<uint64_t> hashes;
    const auto play = [&](uint32_t threads, SolverPath path) {
      Solver solver = on_the_floor(cloth, threads, path);
      run(solver, 30);
      hashes.push_back(hash_state(*cloth.asset, positions_of(solver)));
    };
    play(1, SolverPath::automatic);
    play(1, SolverPath::automatic);
    play(2, SolverPath::automatic);
    play(3, SolverPath::automatic);
    play(1, SolverPath::plain);
    play(2, SolverPath::plain);
    for (const uint64_t hash : hashes) EXPECT_EQ(hash, hashes.front());
  }
}

/// Whatever does not touch itself moves bit by bit as without self-collision.
void expect_untouched(ClothDesc cloth, const std::vector<Pin>& pins, uint32_t frames) {
  std::array<std::vector<Vec3>, 2> positions;
  for (const bool on : {false, true}) {
    cloth.self_collision = on ? std::optional<SelfCollision>(SelfCollision{}) : std::nullopt;
    Solver solver(std::vector<ClothDesc>{cloth}, cpu_settings());
    solver.set_pins(0, pins);
    run(solver, frames);
    positions[on ? 1 : 0] = positions_of(solver);
  }
  EXPECT_EQ(hash_state(*cloth.asset, positions[0]), hash_state(*cloth.asset, positions[1]));
}

TEST(SelfCollision, ASwingingSheetDoesNotNoticeIt) {
  for (const uint32_t charts : {1U, 3U}) {
    const SheetOptions options{
        .nx = 25, .ny = 25, .charts_x = charts, .charts_y = charts, .horizontal = true, .jitter = 0.2F};
    const ClothDesc cloth = describe(make_sheet(options));
    expect_untouched(cloth, pins_at_rest(*cloth.asset, "top"), 30);
  }
}

TEST(SelfCollision, ASleeveOfSeveralChartsDoesNotNoticeIt) {
  for (const uint32_t charts : {1U, 3U}) {
    const ClothDesc cloth = describe(make_tube({.charts_x = charts, .charts_y = charts}));
    expect_untouched(cloth, pins_at_rest(*cloth.asset, "top"), 20);
  }
}

/// Two tubes in one asset, the outer one around the inner.
ClothAsset two_layers(float inner, float outer) {
  ClothAsset a = make_tube({.nx = 24, .ny = 16, .radius = inner, .height = 0.5F});
  const ClothAsset b = make_tube({.nx = 24, .ny = 16, .radius = outer, .height = 0.5F});
  return beside(a, b);
}

TEST(SelfCollision, LayersOfAGarmentStayOnTheirSides) {
  // The outer tube is pushed against the inner one by a ball that comes from the side.
  const float gap = 0.03F;
  ClothDesc cloth = describe(two_layers(0.15F, 0.15F + gap));
  std::array<uint64_t, 2> through{};
  for (const bool on : {false, true}) {
    cloth.self_collision = on ? std::optional<SelfCollision>(SelfCollision{}) : std::nullopt;
    Solver solver(std::vector<ClothDesc>{cloth}, cpu_settings());
    std::vector<Pin> pins = pins_at_rest(*cloth.asset, "top");
    solver.set_pins(0, pins);
    for (uint32_t f = 0; f < 60; ++f) {
      Collider ball;
      ball.shape = Sphere{{0.45F - 0.005F * static_cast<float>(f), -0.1F, 0}, 0.15F};
      solver.set_colliders(std::vector<Collider>{ball}, f == 0);
      solver.step();
    }
    through[on ? 1 : 0] = count_intersections(*cloth.asset, positions_of(solver));
  }
  EXPECT_GE(through[0], 20U) << "there was nothing to prevent";
  EXPECT_EQ(through[1], 0U);
}

/// Linear momentum [kg m/s] and angular momentum about the origin [kg m^2/s].
struct Momentum {
  std::array<double, 3> linear{}, angular{};
};
Momentum momentum_of(const ClothDesc& cloth, Solver& solver) {
  const std::vector<double> mass = masses_of(cloth);
  const std::vector<Vec3> x = positions_of(solver), v = velocities_of(solver);
  Momentum sum;
  for (size_t p = 0; p < x.size(); ++p) {
    const std::array<double, 3> r{x[p].x, x[p].y, x[p].z}, u{v[p].x, v[p].y, v[p].z};
    for (size_t k = 0; k < 3; ++k) {
      const size_t i = (k + 1) % 3, j = (k + 2) % 3;
      sum.linear[k] += mass[p] * u[k];
      sum.angular[k] += mass[p] * (r[i] * u[j] - r[j] * u[i]);
    }
  }
  return sum;
}

TEST(SelfCollision, LayersThatCollideInFreeFlightKeepTheirMomentum) {
  // Two squares, one above the other, fly at each other at 2 m/s, and the upper one sideways too.
  const SheetOptions options{.nx = 13, .ny = 13, .width = 0.2F, .height = 0.2F, .horizontal = true};
  SheetOptions above = options;
  above.center = {0.03F, 0.05F, 0.01F};
  ClothDesc cloth = describe(beside(make_sheet(options), make_sheet(above)), undamped());
  cloth.self_collision = SelfCollision{};
  SolverSettings settings = cpu_settings();
  settings.gravity = {};
  Solver solver(std::vector<ClothDesc>{cloth}, settings);
  std::vector<Vec3> x = positions_of(solver), v(x.size());
  for (size_t p = 0; p < x.size(); ++p)
    if (x[p].y > 0.02F) v[p] = {0.5F, -2, 0};
  solver.write_state(0, x, v);
  const auto kinetic = [&] { return measure_energy(cloth, {}, positions_of(solver), velocities_of(solver)).kinetic; };
  const double kinetic_before = kinetic();
  const Momentum before = momentum_of(cloth, solver);
  run(solver, 30);
  const Momentum after = momentum_of(cloth, solver);
  EXPECT_LT(kinetic(), 0.9 * kinetic_before) << "nothing collided";
  const double size = std::abs(before.linear[1]);
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(after.linear[k], before.linear[k], 1e-4 * size) << "axis " << k;
  EXPECT_EQ(count_intersections(*cloth.asset, positions_of(solver)), 0U);
}

TEST(SelfCollision, NothingThatIsWrittenIntoAStateStopsIt) {
  // All points in one place, then far away, then in one place again.
  const ClothDesc cloth = falling_sheet(2, true);
  Solver solver = on_the_floor(cloth);
  const std::vector<Vec3> start = positions_of(solver);
  const std::vector<Vec3> still(start.size());
  for (const Vec3& place : {Vec3{0, 0.1F, 0}, Vec3{9e5F, 0.1F, -9e5F}, Vec3{0, 0.1F, 0}}) {
    solver.write_state(0, std::vector<Vec3>(start.size(), place), still);
    run(solver, 3);
    EXPECT_TRUE(all_finite(positions_of(solver)));
  }
  solver.write_state(0, start, still);
  run(solver, 3);
  EXPECT_TRUE(all_finite(positions_of(solver)));
}

TEST(SelfCollision, ADistanceThatCannotBeIsRefused) {
  ClothDesc cloth = falling_sheet(1, true);
  for (const float distance : {0.F, 10 * cloth.asset->spacing, std::numeric_limits<float>::quiet_NaN()}) {
    cloth.self_collision = SelfCollision{distance};
    EXPECT_THROW(Solver(std::vector<ClothDesc>{cloth}, cpu_settings()), Error) << distance;
  }
  cloth.self_collision = SelfCollision{2 * cloth.asset->spacing};
  EXPECT_NO_THROW(Solver(std::vector<ClothDesc>{cloth}, cpu_settings()));
}

}  // namespace
}  // namespace geocloth::test
