// SPDX-License-Identifier: GPL-3.0-or-later
// The same cloth cut into 1, 2, 4 or 8 charts is the same cloth: shape within 1 % of its side, period within 1 %, and
// no line where a seam is. At 32 substeps of 1/60 s and 4 relaxation steps; with fewer the uncut cloth itself is far
// from where it would come to rest.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "solver_fixture.h"

namespace geocloth {
namespace {

struct Charts {
  uint32_t x, y;
};
void PrintTo(const Charts& charts, std::ostream* out) {
  *out << charts.x << " x " << charts.y << " charts";
}

/// Points of the surface, whatever it was cut into: row by row, around again after the last where it is a tube.
struct Surface {
  uint32_t nx = 0, ny = 0;
  bool tube = false;
  std::vector<Vec3> points;
  [[nodiscard]] const Vec3& at(uint32_t i, uint32_t j) const { return points[size_t{j} * nx + i % nx]; }
};

SolverSettings settings_of() {
  SolverSettings settings = test::cpu_settings();
  settings.substeps = 32;
  settings.relaxation_steps = 4;
  return settings;
}

using PixelOf = std::function<uint32_t(uint32_t i, uint32_t j)>;
Surface read_surface(Solver& solver, uint32_t nx, uint32_t ny, bool tube, const PixelOf& pixel) {
  const std::vector<Vec3> x = test::positions_of(solver);
  Surface surface{nx, ny, tube, {}};
  for (uint32_t j = 0; j < ny; ++j)
    for (uint32_t i = 0; i < nx; ++i) surface.points.push_back(x[pixel(i, j)]);
  return surface;
}

double farthest(const Surface& a, const Surface& b) {
  double farthest = 0;
  for (size_t k = 0; k < a.points.size(); ++k)
    farthest = std::max(farthest, static_cast<double>(length(a.points[k] - b.points[k])));
  return farthest;
}

/// Root mean square of the second differences across the line of points i (or j).
double fold_over_column(const Surface& s, uint32_t i) {
  double sum = 0;
  for (uint32_t j = 1; j < s.ny; ++j) {
    const Vec3 d = s.at(i + s.nx - 1, j) - 2.F * s.at(i, j) + s.at(i + 1, j);
    sum += static_cast<double>(dot(d, d));
  }
  return std::sqrt(sum / (s.ny - 1));
}
double fold_over_row(const Surface& s, uint32_t j) {
  double sum = 0;
  for (uint32_t i = 0; i < s.nx; ++i) {
    const Vec3 d = s.at(i, j - 1) - 2.F * s.at(i, j) + s.at(i, j + 1);
    sum += static_cast<double>(dot(d, d));
  }
  return std::sqrt(sum / s.nx);
}

/// A seam is no fold: second differences over it are at most twice those two points beside it.
void expect_no_lines(const Surface& s, const Charts& charts) {
  const uint32_t cells_x = s.tube ? s.nx : s.nx - 1, cells_y = s.ny - 1;
  for (uint32_t k = s.tube ? 0 : 1; k < charts.x; ++k) {
    const uint32_t i = cells_x * k / charts.x;
    const double beside = 0.5 * (fold_over_column(s, (i + s.nx - 2) % s.nx) + fold_over_column(s, i + 2));
    EXPECT_LE(fold_over_column(s, i), 2 * beside) << "column " << i;
  }
  for (uint32_t k = 1; k < charts.y; ++k) {
    const uint32_t j = cells_y * k / charts.y;
    EXPECT_LE(fold_over_row(s, j), fold_over_row(s, j - 2) + fold_over_row(s, j + 2)) << "row " << j;
  }
}

/// A sheet of 1 m that hangs from two corners, 0.8 m apart.
Surface hang_sheet(const Charts& charts) {
  const test::SheetOptions options{.nx = 25, .ny = 25, .charts_x = charts.x, .charts_y = charts.y};
  Material material;
  material.damping = 3;
  material.max_stretch = 0;  // springs and bends alone
  const ClothDesc cloth = test::describe(make_sheet(options), material);
  Solver solver(std::vector{cloth}, settings_of());
  std::vector<Pin> pins = test::pins_at_rest(*cloth.asset, "corners");
  for (Pin& pin : pins) pin.target.x *= 0.8F;
  solver.set_pins(0, pins);
  test::run(solver, 120);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  return read_surface(solver, options.nx, options.ny, false,
                      [&](uint32_t i, uint32_t j) { return test::sheet_pixel(options, i, j); });
}

/// A sleeve of 40 cm held by its upper end, pulled down and to the side.
Surface pull_sleeve(const Charts& charts) {
  const test::TubeOptions options{
      .nx = 24, .ny = 25, .radius = 0.06F, .height = 0.4F, .charts_x = charts.x, .charts_y = charts.y};
  Material material;
  material.damping = 3;
  material.max_stretch = 0;  // springs and bends alone
  material.bend_warp = material.bend_weft = 1e-4F;
  const ClothDesc cloth = test::describe(make_tube(options), material);
  SolverSettings settings = settings_of();
  settings.gravity = {3, -9.3F, 1};
  Solver solver(std::vector{cloth}, settings);
  solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
  test::run(solver, 120);
  EXPECT_EQ(solver.statistics().copy_gap, 0.0);
  return read_surface(solver, options.nx, options.ny, true,
                      [&](uint32_t i, uint32_t j) { return test::tube_pixel(options, i, j); });
}

/// Period [s] of a sheet of 1 m that swings by a little about its upper edge.
double swing_period(const Charts& charts) {
  const test::SheetOptions options{.nx = 25, .ny = 25, .charts_x = charts.x, .charts_y = charts.y};
  Material material = test::undamped();
  material.max_stretch = 0;
  const ClothDesc cloth = test::describe(make_sheet(options), material);
  Solver solver(std::vector{cloth}, settings_of());
  std::vector<Vec3> x = cloth.asset->rest_position;
  for (uint32_t p = 0; p < x.size(); ++p)
    if (cloth.asset->valid(p)) x[p].z = 0.05F * (0.5F - x[p].y);
  solver.write_state(0, x, std::vector<Vec3>(x.size()));
  solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
  const uint32_t tip = test::sheet_pixel(options, options.nx / 2, options.ny - 1);
  std::vector<double> crossings;
  double before = 1;
  for (int frame = 1; frame <= 140; ++frame) {
    solver.step();
    const auto now = static_cast<double>(test::positions_of(solver)[tip].z);
    if ((before > 0) != (now > 0)) crossings.push_back((frame - 1 + before / (before - now)) / 60);
    before = now;
  }
  return 2 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

class CutInvariance : public testing::TestWithParam<Charts> {};

TEST_P(CutInvariance, SheetHangsTheSame) {
  static const Surface kUncut = hang_sheet({1, 1});
  const Surface cut = hang_sheet(GetParam());
  EXPECT_LE(farthest(cut, kUncut), 0.01);
  expect_no_lines(cut, GetParam());
}

TEST_P(CutInvariance, SheetSwingsTheSame) {
  static const double kUncut = swing_period({1, 1});
  EXPECT_NEAR(swing_period(GetParam()), kUncut, 0.01 * kUncut);
}

TEST_P(CutInvariance, SleeveHangsTheSame) {
  static const Surface kOneSeam = pull_sleeve({1, 1});
  const Surface cut = pull_sleeve(GetParam());
  EXPECT_LE(farthest(cut, kOneSeam), 0.01 * 0.4);
  expect_no_lines(cut, GetParam());
}

INSTANTIATE_TEST_SUITE_P(Charts, CutInvariance, testing::Values(Charts{2, 1}, Charts{2, 2}, Charts{4, 2}, Charts{1, 8}),
                         [](const auto& tested) {
                           return std::to_string(tested.param.x) + "x" + std::to_string(tested.param.y);
                         });

}  // namespace
}  // namespace geocloth
