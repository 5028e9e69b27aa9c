// SPDX-License-Identifier: GPL-3.0-or-later
// Pressure within cloth against closed forms: what inflates a cushion neither pushes it about nor leaves it where it
// was.

#include <cmath>
#include <limits>
#include <vector>

#include "geocloth/asset/error.h"
#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

/// [m] Mean distance from the y axis of all points.
double mean_radius(const ClothAsset& asset, const std::vector<Vec3>& position) {
  double sum = 0, count = 0;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    sum += std::hypot(position[p].x, position[p].z);
    ++count;
  }
  return sum / count;
}

Vec3 middle_of_mass(const ClothDesc& cloth, const std::vector<Vec3>& position) {
  const std::vector<double> mass = test::masses_of(cloth);
  double all = 0, x = 0, y = 0, z = 0;
  for (size_t p = 0; p < mass.size(); ++p) {
    all += mass[p];
    x += mass[p] * static_cast<double>(position[p].x);
    y += mass[p] * static_cast<double>(position[p].y);
    z += mass[p] * static_cast<double>(position[p].z);
  }
  return {static_cast<float>(x / all), static_cast<float>(y / all), static_cast<float>(z / all)};
}

class Pressure : public test::MachineTest<> {
 protected:
  [[nodiscard]] uint32_t frames(uint32_t on_the_cpu) const { return machine().slow() ? 6 : on_the_cpu; }
};

class PressureOnEveryPath : public Pressure {};

TEST_P(PressureOnEveryPath, OfItsOwnWeightCarriesASheet) {
  for (const uint32_t charts : {1U, 2U}) {
    const ClothDesc sheet = test::describe(
        test::make_sheet({.nx = 13, .ny = 13, .charts_x = charts, .charts_y = charts, .horizontal = true}));
    SolverSettings settings;
    settings.check_copies = true;
    Solver solver = make(sheet, settings);
    solver.set_pressure(0, 9.81F * sheet.material.areal_density);
    const std::vector<Vec3> start = test::positions_of(solver);
    test::run(solver, 6);  // in which it would fall by 49 mm
    const std::vector<Vec3> end = test::positions_of(solver);
    EXPECT_NEAR(middle_of_mass(sheet, end).y, middle_of_mass(sheet, start).y, 1e-4F) << charts;
    // A corner weighs a quarter of a cell and has a third of it, or a sixth: corners bend.
    for (size_t p = 0; p < end.size(); ++p) EXPECT_LT(length(end[p] - start[p]), 0.015F) << p;
    EXPECT_EQ(solver.statistics().copy_gap, 0);
  }
}

TEST_P(Pressure, MakesATubeAsWideAsItsHoopsStretch) {
  // A hoop of the radius r carries p r, and K (r / r0 - 1) by its stretch: r = r0 / (1 - p r0 / K).
  constexpr float kStiff = 20, kPressure = 3;  // [N/m], [Pa]
  Material material;
  material.stretch_warp = material.stretch_weft = kStiff;
  material.shear = 0.1F;
  material.bend_warp = material.bend_weft = 0;
  material.damping = 8;
  for (const uint32_t charts : {1U, 3U}) {
    const test::TubeOptions options{.nx = 24, .ny = 8, .radius = 0.2F, .height = 0.3F, .charts_x = charts};
    const ClothDesc tube = test::describe(test::make_tube(options), material);
    SolverSettings settings;
    settings.gravity = {};
    settings.substeps = 32;
    Solver solver = make(tube, settings);
    const double before = mean_radius(*tube.asset, test::positions_of(solver));
    solver.set_pressure(0, kPressure);
    test::run(solver, frames(180));
    const double strain = mean_radius(*tube.asset, test::positions_of(solver)) / before - 1;
    const double x = double{kPressure} * double{options.radius} / double{kStiff};
    if (machine().slow()) {
      EXPECT_GT(strain, 0.001) << "too few frames to come to rest, but on its way";
      continue;
    }
    EXPECT_NEAR(strain, x / (1 - x), 0.05 * x) << charts;
    EXPECT_LT(length(middle_of_mass(tube, test::positions_of(solver))), 5e-4F) << "it was pushed about";
    solver.set_pressure(0, 0);
    test::run(solver, frames(180));
    EXPECT_NEAR(mean_radius(*tube.asset, test::positions_of(solver)) / before, 1, 1e-3) << charts;
  }
}

TEST_P(Pressure, ThatIsFarTooHighStaysFinite) {
  const ClothDesc tube = test::describe(test::make_tube({.nx = 24, .ny = 8}));
  Solver solver = make(tube, SolverSettings());
  solver.set_pressure(0, 1e5F);
  test::run(solver, frames(30));
  EXPECT_TRUE(test::all_finite(test::positions_of(solver)));
}

TEST_P(Pressure, WakesClothThatSleeps) {
  SolverSettings settings;
  settings.gravity = {};
  settings.sleep_speed = 0.01F;
  settings.sleep_time = 0;
  Solver solver = make(test::describe(test::make_sheet({.nx = 9, .ny = 9})), settings);
  test::run(solver, 6);
  ASSERT_TRUE(solver.asleep(0));
  solver.set_pressure(0, 0);
  solver.step();
  EXPECT_TRUE(solver.asleep(0)) << "nothing has changed";
  const std::vector<Vec3> start = test::positions_of(solver);
  solver.set_pressure(0, -2);
  test::run(solver, 5);
  EXPECT_FALSE(solver.asleep(0));
  const Vec3 way = test::positions_of(solver)[40] - start[40];
  EXPECT_LT(way.z, -0.01F) << "a sheet that faces +z is drawn back";
}

TEST_P(Pressure, OutOfRangeIsRefused) {
  Solver solver = make(test::describe(test::make_sheet({.nx = 9, .ny = 9})), SolverSettings());
  for (const float bad : {2e6F, -2e6F, std::numeric_limits<float>::quiet_NaN()}) {
    try {
      solver.set_pressure(0, bad);
      ADD_FAILURE() << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_argument);
      EXPECT_NE(std::string(error.what()).find("cloth 0: pressure is"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(solver.set_pressure(1, 0), Error);
}

INSTANTIATE_TEST_SUITE_P(On, Pressure, test::first_machine(), test::kMachineName);
INSTANTIATE_TEST_SUITE_P(On, PressureOnEveryPath, test::every_machine(), test::kMachineName);

}  // namespace
}  // namespace geocloth
