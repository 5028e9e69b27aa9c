// SPDX-License-Identifier: GPL-3.0-or-later
// The same cloth cut into 1, 2, 4 or 8 charts is the same cloth: shape within 1 % of its side, period within 1 %, and
// no line where a seam is. At 32 substeps of 1/60 s and 4 relaxation steps (half of each where machines are slow, at
// two thirds of the points); with fewer the uncut cloth itself is far from where it would come to rest.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "solver_fixture.h"
#include "support/machine.h"

namespace geocloth {
namespace {

struct Charts {
  uint32_t x = 1, y = 1;
};
struct Case : test::Machine, Charts {};
void PrintTo(const Case& tested, std::ostream* out) {
  *out << tested.x << " x " << tested.y << " charts on " << test::name_of(tested);
}

/// Points of the surface, whatever it was cut into: row by row, around again after the last where it is a tube.
struct Surface {
  uint32_t nx = 0, ny = 0;
  bool tube = false;
  std::vector<Vec3> points;
  [[nodiscard]] const Vec3& at(uint32_t i, uint32_t j) const { return points[size_t{j} * nx + i % nx]; }
};

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

class CutInvariance : public test::MachineTest<Case> {
 protected:
  [[nodiscard]] const Charts& charts() const { return GetParam(); }

  [[nodiscard]] SolverSettings settings() const {
    SolverSettings settings;
    settings.check_copies = true;
    settings.substeps = machine().slow() ? 16 : 32;
    settings.relaxation_steps = machine().slow() ? 2 : 4;
    return settings;
  }
  [[nodiscard]] uint32_t points() const { return machine().slow() ? 17 : 25; }
  [[nodiscard]] uint32_t frames() const { return machine().slow() ? 60 : 120; }

  /// A sheet of 1 m that hangs from two corners, 0.8 m apart.
  [[nodiscard]] Surface hang_sheet(const Charts& charts) {
    const test::SheetOptions options{.nx = points(), .ny = points(), .charts_x = charts.x, .charts_y = charts.y};
    Material material;
    material.damping = 3;
    material.max_stretch = 0;  // springs and bends alone
    const ClothDesc cloth = test::describe(make_sheet(options), material);
    Solver solver = make(cloth, settings());
    std::vector<Pin> pins = test::pins_at_rest(*cloth.asset, "corners");
    for (Pin& pin : pins) pin.target.x *= 0.8F;
    solver.set_pins(0, pins);
    test::run(solver, frames());
    EXPECT_EQ(solver.statistics().copy_gap, 0.0);
    return read_surface(solver, options.nx, options.ny, false,
                        [&](uint32_t i, uint32_t j) { return test::sheet_pixel(options, i, j); });
  }

  /// A sleeve of 40 cm held by its upper end, pulled down and to the side.
  [[nodiscard]] Surface pull_sleeve(const Charts& charts) {
    const test::TubeOptions options{.nx = points() - 1,
                                    .ny = points(),
                                    .radius = 0.06F,
                                    .height = kSleeve,
                                    .charts_x = charts.x,
                                    .charts_y = charts.y};
    Material material;
    material.damping = 3;
    material.max_stretch = 0;  // springs and bends alone
    material.bend_warp = material.bend_weft = 1e-4F;
    const ClothDesc cloth = test::describe(make_tube(options), material);
    SolverSettings pulled = settings();
    pulled.gravity = {3, -9.3F, 1};
    Solver solver = make(cloth, pulled);
    solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
    test::run(solver, frames());
    EXPECT_EQ(solver.statistics().copy_gap, 0.0);
    return read_surface(solver, options.nx, options.ny, true,
                        [&](uint32_t i, uint32_t j) { return test::tube_pixel(options, i, j); });
  }

  /// Period [s] of a sheet of 1 m that swings by a little about its upper edge.
  [[nodiscard]] double swing_period(const Charts& charts) {
    const test::SheetOptions options{.nx = points(), .ny = points(), .charts_x = charts.x, .charts_y = charts.y};
    Material material = test::undamped();
    material.max_stretch = 0;
    const ClothDesc cloth = test::describe(make_sheet(options), material);
    Solver solver = make(cloth, settings());
    std::vector<Vec3> x = cloth.asset->rest_position;
    for (uint32_t p = 0; p < x.size(); ++p)
      if (cloth.asset->valid(p)) x[p].z = 0.05F * (0.5F - x[p].y);
    solver.write_state(0, x, std::vector<Vec3>(x.size()));
    solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
    const uint32_t tip = test::sheet_pixel(options, options.nx / 2, options.ny - 1);
    std::vector<double> crossings;
    double before = 1;
    for (int frame = 1; frame <= (machine().slow() ? 85 : 140); ++frame) {
      solver.step();
      const auto now = static_cast<double>(test::positions_of(solver)[tip].z);
      if ((before > 0) != (now > 0)) crossings.push_back((frame - 1 + before / (before - now)) / 60);
      before = now;
    }
    return 2 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  }

  static constexpr float kSleeve = 0.4F;  ///< [m] its length
};

TEST_P(CutInvariance, SheetHangsTheSame) {
  const Surface cut = hang_sheet(charts());
  EXPECT_LE(farthest(cut, hang_sheet({})), 0.01);
  expect_no_lines(cut, charts());
}

TEST_P(CutInvariance, SheetSwingsTheSame) {
  const double uncut = swing_period({});
  EXPECT_NEAR(swing_period(charts()), uncut, 0.01 * uncut);
}

TEST_P(CutInvariance, SleeveHangsTheSame) {
  const Surface cut = pull_sleeve(charts());
  EXPECT_LE(farthest(cut, pull_sleeve({})), 0.01 * double{kSleeve});
  expect_no_lines(cut, charts());
}

std::vector<Case> cases() {
  std::vector<Case> cases;
  const test::Machine machine = test::machines().front();
  for (const Charts& charts : {Charts{2, 1}, Charts{2, 2}, Charts{4, 2}}) cases.push_back({machine, charts});
  if (!machine.slow()) cases.push_back({machine, {1, 8}});  // needs three cells for each
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Charts, CutInvariance, testing::ValuesIn(cases()), [](const auto& tested) {
  return std::to_string(tested.param.x) + "x" + std::to_string(tested.param.y) + "_on_" + test::name_of(tested.param);
});

}  // namespace
}  // namespace geocloth
