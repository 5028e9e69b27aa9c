// SPDX-License-Identifier: GPL-3.0-or-later
// Panels of a sewing pattern: their seams close evenly, without pushing the cloth about, hold what hangs on them, and
// open again.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

/// The two halves of a sheet, 0.2 m from each other sideways and 0.1 m in depth, to be sewn where the sheet is cut.
ClothAsset two_panels(uint32_t points, bool horizontal = false) {
  ClothAsset asset = test::make_sheet({.nx = points, .ny = points, .charts_x = 2, .horizontal = horizontal});
  for (uint32_t r = 0; r < asset.splits.rows(); ++r)
    asset.sewing.push_back({asset.splits.pixel[2 * r], asset.splits.pixel[2 * r + 1]});
  asset.splits = {};
  asset.seam_bends.clear();
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && asset.chart[p] == 1) asset.rest_position[p] += {0.2F, 0, 0.1F};
  return asset;
}

/// [m]
float widest_seam(const ClothAsset& asset, const std::vector<Vec3>& position) {
  float widest = 0;
  for (const auto& [a, b] : asset.sewing) widest = std::max(widest, length(position[b] - position[a]));
  return widest;
}

Vec3 momentum_of(const ClothDesc& cloth, const std::vector<Vec3>& velocity) {
  const std::vector<double> mass = test::masses_of(cloth);
  Vec3 sum{};
  for (size_t p = 0; p < mass.size(); ++p) sum += static_cast<float>(mass[p]) * velocity[p];
  return sum;
}

/// Closes the seams evenly.
void sew(Solver& solver, uint32_t frames) {
  const float gap = solver.sewing_gap(0);
  solver.set_sewing(0, gap);
  for (uint32_t f = 1; f <= frames; ++f) {
    solver.set_sewing(0, gap * (1 - static_cast<float>(f) / static_cast<float>(frames)));
    solver.step();
  }
}

class Sewing : public test::MachineTest<> {
 protected:
  [[nodiscard]] uint32_t points() const { return machine().slow() ? 8 : 24; }
  [[nodiscard]] uint32_t frames() const { return machine().slowest() ? 2 : machine().slow() ? 6 : 30; }
};
class SewingOnTheFirstMachine : public Sewing {};

TEST_P(Sewing, ClosesSeamsEvenlyAndPushesNothingAbout) {
  const ClothDesc panels = test::describe(two_panels(points()), test::undamped());
  SolverSettings settings;
  settings.gravity = {};
  if (machine().slowest()) settings.substeps = 4;
  Solver solver = make(panels, settings);
  EXPECT_NEAR(solver.sewing_gap(0), 1, 1e-5);
  const std::vector<Vec3> start = test::positions_of(solver);
  const float apart = widest_seam(*panels.asset, start);
  float before = apart;
  Solver on_cpu = test::make_cpu_solver({&panels, 1}, settings);
  on_cpu.set_sewing(0, 1);
  solver.set_sewing(0, 1);
  constexpr uint32_t kClosed = 2;  // frames in which bends over the seam act, too
  for (uint32_t f = 1; f <= frames() + kClosed; ++f) {
    const float share = std::max(0.F, 1 - static_cast<float>(f) / static_cast<float>(frames()));
    for (Solver* each : {&solver, &on_cpu}) {
      each->set_sewing(0, share);
      each->step();
    }
    const std::vector<Vec3> position = test::positions_of(solver), same = test::positions_of(on_cpu);
    for (size_t p = 0; p < position.size(); ++p) ASSERT_LT(length(position[p] - same[p]), 1e-5F) << p;
    const float now = widest_seam(*panels.asset, position);
    EXPECT_LE(now, share * apart + 1e-4F) << "frame " << f;
    EXPECT_LE(now, std::max(before, 1e-4F) + 1e-6F) << "frame " << f;
    before = now;
  }
  EXPECT_LT(length(momentum_of(panels, test::velocities_of(solver))), 1e-4F);
  EXPECT_LT(solver.sewing_gap(0), 1e-3F);
}

TEST_P(SewingOnTheFirstMachine, HoldsWhatHangsOnASeam) {
  const ClothDesc panels = test::describe(two_panels(points()));
  Solver solver = make(panels, SolverSettings{});
  const uint32_t left = panels.asset->sewing[0][0];
  std::vector<Pin> pins;
  for (uint32_t p = 0; p < panels.asset->pixel_count(); ++p)
    if (panels.asset->valid(p) && panels.asset->chart[p] == panels.asset->chart[left])
      pins.push_back({p, panels.asset->rest_position[p]});
  solver.set_pins(0, pins);
  solver.set_gravity_scale(0, 0);
  sew(solver, frames());
  solver.set_gravity_scale(0, 1);
  test::run(solver, frames());
  const std::vector<Vec3> hanging = test::positions_of(solver);
  EXPECT_LT(widest_seam(*panels.asset, hanging), 0.01F * panels.asset->spacing);
  EXPECT_LT(measure_stretch(*panels.asset, 1, hanging).max, machine().slow() ? 1.3 : 1.1);

  solver.set_sewing(0, std::nullopt);
  test::run(solver, 6);
  EXPECT_GT(widest_seam(*panels.asset, test::positions_of(solver)), 0.02F) << "what was let go falls";
}

/// [m] How far a stiff sheet's right half hangs down at most that is clamped by its left one.
float droop(Solver& solver, const ClothAsset& asset, float seam) {
  std::vector<Pin> pins;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p) && asset.rest_position[p].x < seam) pins.push_back({p, asset.rest_position[p]});
  solver.set_pins(0, pins);
  if (!asset.sewing.empty()) {
    solver.set_gravity_scale(0, 0);
    sew(solver, 15);
    solver.set_gravity_scale(0, 1);
  }
  test::run(solver, 150);
  float lowest = 0;
  const std::vector<Vec3> position = test::positions_of(solver);
  for (uint32_t p = 0; p < asset.pixel_count(); ++p)
    if (asset.valid(p)) lowest = std::min(lowest, position[p].y);
  return -lowest;
}

// A seam is not a hinge: what was sewn bends over it as the cloth does elsewhere.
TEST_P(SewingOnTheFirstMachine, BendsOverASeamAsBesideIt) {
  if (machine().slow()) GTEST_SKIP() << "three seconds at 32 substeps";
  Material stiff;
  stiff.bend_warp = stiff.bend_weft = 0.03F;
  stiff.damping = 5;
  SolverSettings settings;
  settings.substeps = 32;
  const ClothDesc panels = test::describe(two_panels(24, true), stiff);
  const ClothDesc whole = test::describe(test::make_sheet({.nx = 24, .ny = 24, .horizontal = true}), stiff);
  Solver sewn = make(panels, settings), uncut = make(whole, settings);
  const float by_seam = droop(sewn, *panels.asset, 0.001F), as_one = droop(uncut, *whole.asset, -0.001F);
  EXPECT_GT(as_one, 0.1F);
  EXPECT_LT(as_one, 0.45F) << "a hinge lets it hang straight down, by half a metre";
  EXPECT_NEAR(by_seam, as_one, 0.1F * as_one);
}

TEST_P(SewingOnTheFirstMachine, LayersThatAreSewnDoNotPushEachOther) {
  ClothDesc panels = test::describe(two_panels(points()));
  panels.self_collision = SelfCollision{};
  SolverSettings settings;
  settings.gravity = {};
  Solver solver = make(panels, settings);
  sew(solver, frames());
  test::run(solver, frames());
  EXPECT_LT(widest_seam(*panels.asset, test::positions_of(solver)), 0.01F * panels.asset->spacing);
  if (machine().slow()) return;  // too few frames to come to rest
  float fastest = 0;
  for (const Vec3& v : test::velocities_of(solver)) fastest = std::max(fastest, length(v));
  EXPECT_LT(fastest, 0.2F)
      << "two panels that meet at 1 m/s swing a little; pushed apart and drawn together they shake";
}

TEST_P(SewingOnTheFirstMachine, ASecondSimulationBeginsWhereASeamIs) {
  // Pulled apart since: no jerk, for the share begins at what sewing_gap() says.
  const ClothDesc panels = test::describe(two_panels(points()));
  SolverSettings settings;
  settings.gravity = {};
  Solver solver = make(panels, settings);
  std::vector<Vec3> apart = test::positions_of(solver), still(apart.size());
  for (uint32_t p = 0; p < panels.asset->pixel_count(); ++p)
    if (panels.asset->valid(p) && panels.asset->chart[p] == 1) apart[p] += {0.3F, 0, 0};
  solver.write_state(0, apart, still);
  const float gap = solver.sewing_gap(0);
  EXPECT_GT(gap, 2);
  solver.set_sewing(0, gap);
  solver.step();
  for (const Vec3& v : test::velocities_of(solver)) EXPECT_LT(length(v), 1e-3F);
}

TEST_P(SewingOnTheFirstMachine, GravityIsScaled) {
  const ClothDesc sheet = test::describe(test::make_sheet({.nx = 4, .ny = 4}), test::undamped());
  for (const float scale : {0.F, 0.5F, -1.F}) {
    Solver solver = make(sheet, SolverSettings{});
    solver.set_gravity_scale(0, scale);
    test::run(solver, 6);
    for (uint32_t p = 0; p < sheet.asset->pixel_count(); ++p)
      EXPECT_NEAR(test::velocities_of(solver)[p].y, scale * -9.81F * 0.1F, 1e-2F);
  }
}

/// A sheet of n x n points, of which those that `is_sewn` chooses are sewn to its middle.
template <class IsSewn>
ClothAsset gathered_sheet(uint32_t n, const IsSewn& is_sewn) {
  const test::SheetOptions options{.nx = n, .ny = n};
  ClothAsset asset = test::make_sheet(options);
  const uint32_t middle = test::sheet_pixel(options, n / 2, n / 2);
  for (uint32_t j = 0; j < n; ++j) {
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t p = test::sheet_pixel(options, i, j);
      if (p != middle && is_sewn(i, j)) asset.sewing.push_back({std::min(p, middle), std::max(p, middle)});
    }
  }
  std::sort(asset.sewing.begin(), asset.sewing.end());
  return asset;
}

TEST(SewingToOnePoint, ClosesAllThreads) {
  const ClothDesc bag = test::describe(gathered_sheet(12, [](uint32_t i, uint32_t j) {
    return i == 0 || j == 0 || i == 11 || j == 11;  // 44, the border
  }));
  SolverSettings settings = test::cpu_settings();
  settings.gravity = {};
  Solver solver({&bag, 1}, settings);
  sew(solver, 60);
  EXPECT_LT(solver.sewing_gap(0), 0.02);
}

TEST(SewingToOnePoint, IsRefusedWhereThreadsWouldBeLeftOut) {
  const ClothDesc sheet = test::describe(gathered_sheet(40, [](uint32_t, uint32_t) { return true; }));
  try {
    Solver solver({&sheet, 1}, test::cpu_settings());
    FAIL() << "1599 points are sewn to one";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::limit);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("sewing: so many pixels are sewn to one"));
  }
}

TEST(SewingInput, WrongNumbersAreRefused) {
  const ClothDesc panels = test::describe(two_panels(6));
  Solver solver({&panels, 1}, test::cpu_settings());
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (const float share : {-0.1F, 1e9F, kNan}) EXPECT_THROW(solver.set_sewing(0, share), Error) << share;
  for (const float scale : {1e3F, kNan}) EXPECT_THROW(solver.set_gravity_scale(0, scale), Error) << scale;
  EXPECT_THROW(solver.set_sewing(1, 0.F), Error);
  EXPECT_NO_THROW(solver.set_sewing(0, std::nullopt));
}

INSTANTIATE_TEST_SUITE_P(Machines, Sewing, test::every_machine(), test::kMachineName);
INSTANTIATE_TEST_SUITE_P(Machines, SewingOnTheFirstMachine, test::first_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
