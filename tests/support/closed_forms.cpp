// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/closed_forms.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "support/make_sheet.h"

namespace geocloth::test {
namespace {

constexpr double kGravity = 9.81;
constexpr double kDensity = 0.2;  ///< [kg/m^2]

/// A strip of square cells, four points wide, along -y or, lying, along +z; row 0 begins at the origin.
struct Strip {
  SheetOptions options;
  ClothDesc cloth;
  uint32_t rows = 0;
  double cell = 0;  ///< [m]

  [[nodiscard]] uint32_t pixel(uint32_t column, uint32_t row) const { return sheet_pixel(options, column, row); }
  [[nodiscard]] static uint32_t middle_column() { return 1; }
};

Strip make_strip(double length, uint32_t cells, bool lying, const Material& material) {
  constexpr uint32_t kColumns = 4;
  Strip strip;
  strip.rows = cells + 1;
  strip.cell = length / cells;
  strip.options = {.nx = kColumns,
                   .ny = strip.rows,
                   .width = static_cast<float>((kColumns - 1) * strip.cell),
                   .height = static_cast<float>(length),
                   .horizontal = lying};
  const auto half = static_cast<float>(0.5 * length);
  strip.options.center = lying ? Vec3{0, 0, half} : Vec3{0, -half, 0};
  strip.cloth = {std::make_shared<const ClothAsset>(make_sheet(strip.options)), material, {}};
  return strip;
}

Solver solver_of(const Strip& strip, const Effort& effort, const MakeSolver& make) {
  SolverSettings settings;
  settings.substeps = effort.substeps;
  settings.relaxation_steps = effort.relaxation_steps;
  return make({&strip.cloth, 1}, settings);
}

/// Where every row of the strip is put before the start, as (y, z).
using RowPlace = std::function<std::pair<double, double>(uint32_t row)>;

/// Puts the strip into a shape, at rest, and pins some of its rows there.
void place(Solver& solver, const Strip& strip, const RowPlace& at, std::span<const uint32_t> pinned_rows) {
  std::vector<Vec3> position = strip.cloth.asset->rest_position;
  std::vector<Pin> pins;
  for (uint32_t row = 0; row < strip.rows; ++row) {
    const auto [y, z] = at(row);
    for (uint32_t column = 0; column < strip.options.nx; ++column) {
      Vec3& p = position[strip.pixel(column, row)];
      p = {p.x, static_cast<float>(y), static_cast<float>(z)};
      if (std::ranges::count(pinned_rows, row) > 0) pins.push_back({strip.pixel(column, row), p});
    }
  }
  solver.write_state(0, position, std::vector<Vec3>(position.size()));
  solver.set_pins(0, pins);
}

std::vector<Vec3> positions_after(Solver& solver, double seconds) {
  for (double t = 0; t < seconds; t += 1.0 / 60) solver.step();
  std::vector<Vec3> position;
  solver.read_positions(0, position);
  return position;
}

Material material_of(double stretch, double damping) {
  Material material;
  material.areal_density = static_cast<float>(kDensity);
  material.stretch_warp = material.stretch_weft = static_cast<float>(stretch);
  material.shear = static_cast<float>(0.1 * stretch);
  material.bend_warp = material.bend_weft = 0;
  material.damping = static_cast<float>(damping);
  material.max_stretch = 0;  // what springs and bends alone make of it
  return material;
}

/// A strip of 1 m and 1000 N/m that hangs from its upper edge: strain at the pins.
double hanging_strip(const Effort& effort, const MakeSolver& make) {
  const Strip strip = make_strip(1, effort.cells, false, material_of(1000, 6));
  Solver solver = solver_of(strip, effort, make);
  place(
      solver, strip,
      [&](uint32_t row) {
        return std::pair{-strip.cell * row, 0.0};
      },
      std::array{0U});
  const std::vector<Vec3> x = positions_after(solver, 2);
  const auto strain = [&](uint32_t row) {  // between a row and the next
    const double length = static_cast<double>(x[strip.pixel(strip.middle_column(), row)].y) -
                          static_cast<double>(x[strip.pixel(strip.middle_column(), row + 1)].y);
    return length / strip.cell - 1;
  };
  // Strain is linear: on from the middles of the springs below the first, whose width the pins hold.
  return strain(1) + 1.5 * (strain(1) - strain(2));
}

/// A strip `ratio` times as long as the way between its pinned ends: sag / way.
double catenary(double ratio, const Effort& effort, const MakeSolver& make) {
  const Strip strip = make_strip(ratio, effort.cells, true, material_of(20000, 6));
  Solver solver = solver_of(strip, effort, make);
  const double depth = 0.5 * std::sqrt(ratio * ratio - 1);  // two straight halves to begin with
  place(
      solver, strip,
      [&](uint32_t row) {
        const double t = static_cast<double>(row) / effort.cells;
        return std::pair{-2 * depth * std::min(t, 1 - t), t};
      },
      std::array{0U, effort.cells});
  const std::vector<Vec3> x = positions_after(solver, 3);
  return -static_cast<double>(x[strip.pixel(strip.middle_column(), effort.cells / 2)].y);
}

/// A strip of 1 m that swings by a little about its upper edge, in its first mode: period [s].
double swinging_strip(const Effort& effort, const MakeSolver& make) {
  const Strip strip = make_strip(1, effort.cells, false, material_of(5000, 0));
  Solver solver = solver_of(strip, effort, make);
  constexpr double kFirstZero = 2.404825557695773;  // of the Bessel function J0
  place(
      solver, strip,
      [&](uint32_t row) {
        const double height = 1 - strip.cell * row;  // above the free end
        return std::pair{-strip.cell * row, 0.03 * std::cyl_bessel_j(0, kFirstZero * std::sqrt(std::max(0.0, height)))};
      },
      std::array{0U});
  const uint32_t tip = strip.pixel(strip.middle_column(), effort.cells);
  std::vector<double> crossings;
  double before = 1;
  for (int frame = 1; frame <= 300; ++frame) {
    const auto now = static_cast<double>(positions_after(solver, 1.0 / 120)[tip].z);
    if ((before > 0) != (now > 0)) crossings.push_back((frame - 1 + before / (before - now)) / 60);
    before = now;
  }
  if (crossings.size() < 3) return 0;
  return 2 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
}

/// Where the free end of a strip is, below and beside the clamp [m]: two pinned rows clamp it at the second one.
struct Tip {
  double down = 0, along = 0;
};
Tip cantilever(double gamma, const Effort& effort, const MakeSolver& make) {
  constexpr double kLength = 0.2;
  Material material = material_of(5000, 8);
  const double weight = kDensity * kGravity;
  material.bend_warp = material.bend_weft = static_cast<float>(weight * kLength * kLength * kLength / gamma);
  const Strip strip = make_strip(kLength * effort.cells / (effort.cells - 1.0), effort.cells, true, material);
  Solver solver = solver_of(strip, effort, make);
  place(
      solver, strip,
      [&](uint32_t row) {
        return std::pair{0.0, strip.cell * row};
      },
      std::array{0U, 1U});
  const std::vector<Vec3> x = positions_after(solver, 3);
  const Vec3 tip = x[strip.pixel(strip.middle_column(), effort.cells)];
  return {-static_cast<double>(tip.y), static_cast<double>(tip.z) - strip.cell};
}

double droop(double gamma, const Effort& effort, const MakeSolver& make) {
  const Tip tip = cantilever(gamma, effort, make);
  return tip.down / tip.along;
}
double chord_degrees(double gamma, const Effort& effort, const MakeSolver& make) {
  const Tip tip = cantilever(gamma, effort, make);
  return std::atan2(tip.down, tip.along) * 180 / std::numbers::pi;
}

/// A strip lies half a turn around a cylinder and hangs down on both sides; its own weight pulls at it.
constexpr double kCylinder = 0.1, kShortEnd = 0.1;  ///< [m] radius, length of what hangs on the light side

/// By how much the heavy end goes down in a second [m], when it is `ratio` times as long as the light one.
double capstan_slip(double ratio, double mu, const Effort& effort, const MakeSolver& make) {
  constexpr double kArc = std::numbers::pi * kCylinder;
  Material material = material_of(3000, 0.5);
  material.friction = static_cast<float>(mu);
  material.thickness = 0;
  const Strip strip = make_strip(kShortEnd + kArc + ratio * kShortEnd, effort.cells, false, material);
  Solver solver = solver_of(strip, effort, make);
  place(solver, strip,
        [&](uint32_t row) {
          const double s = strip.cell * row - kShortEnd;  // along the arc from where it touches
          if (s <= 0) return std::pair{s, -kCylinder};
          if (s >= kArc) return std::pair{kArc - s, kCylinder};
          return std::pair{kCylinder * std::sin(s / kCylinder), -kCylinder * std::cos(s / kCylinder)};
        },
        {});
  const auto radius = static_cast<float>(kCylinder);
  solver.set_colliders(
      std::vector<Collider>{{"cylinder", Capsule{{-2, 0, 0}, {2, 0, 0}, radius, radius}, static_cast<float>(mu), {}}});
  const double end = -ratio * kShortEnd;
  const std::vector<Vec3> x = positions_after(solver, 1);
  return end - static_cast<double>(x[strip.pixel(strip.middle_column(), effort.cells)].y);
}

/// dT/dphi = mu (T + w r sin phi) + w r cos phi, where w is the weight of a length: no weight may be left out.
double capstan_limit(double mu) {
  double tension = kShortEnd;  // in units of w
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double phi = std::numbers::pi * (i + 0.5) / kSteps;
    const double normal = tension + kCylinder * std::sin(phi);
    tension += (mu * normal + kCylinder * std::cos(phi)) * std::numbers::pi / kSteps;
  }
  return tension / kShortEnd;
}

/// How many times as long as the light end the heavy one may be before the strip slides, to one in a hundred.
double capstan(double mu, const Effort& effort, const MakeSolver& make) {
  constexpr double kSlides = 0.02;  // [m]
  double holds = 0.8 * capstan_limit(mu), slides = 1.25 * capstan_limit(mu);
  for (int i = 0; i < 5; ++i) {
    const double middle = 0.5 * (holds + slides);
    (capstan_slip(middle, mu, effort, make) < kSlides ? holds : slides) = middle;
  }
  return 0.5 * (holds + slides);
}

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

std::vector<ClosedForm> make_closed_forms() {
  std::vector<ClosedForm> forms;
  forms.push_back({"hanging_strip",
                   "strain at the pins",
                   kDensity * kGravity * 1 / 1000,
                   0.02,
                   {16, 32, 8},
                   {8, 16, 4},
                   {},
                   "rho g L / K",
                   hanging_strip});
  struct Sag {
    double ratio, sag;
    Effort least;
    std::optional<Effort> single;
  };
  const Sag sags[]{{1.05, 0.13930, {16, 16, 4}, {}},
                   {1.1, 0.20030, {16, 16, 2}, {}},
                   {1.25, 0.33180, {16, 16, 1}, Effort{8, 16, 1}},
                   {1.5, 0.50263, {16, 16, 1}, {}},
                   {2, 0.79639, {16, 16, 1}, {}}};
  for (const Sag& s : sags) {
    std::string name = "catenary_" + number(s.ratio);
    std::ranges::replace(name, '.', '_');
    forms.push_back({name,
                     "sag / span at length / span " + number(s.ratio),
                     s.sag,
                     0.01,
                     {32, 32, 8},
                     s.least,
                     s.single,
                     "catenary",
                     [r = s.ratio](const Effort& e, const MakeSolver& make) { return catenary(r, e, make); }});
  }
  forms.push_back({"swinging_strip",
                   "period of the first mode [s]",
                   1.6684,
                   0.02,
                   {16, 16, 4},
                   {8, 8, 2},
                   Effort{8, 8, 1},
                   "4 pi sqrt(L / g) / j01 (Bernoulli's hanging chain)",
                   swinging_strip});
  struct Droop {
    double gamma, ratio;
    Effort least;
  };
  const Droop droops[]{{1, 0.1246, {8, 16, 4}},
                       {2, 0.2467, {8, 16, 4}},
                       {5, 0.5857, {8, 16, 4}},
                       {10, 1.0668, {12, 16, 4}},
                       {20, 1.8639, {12, 32, 2}}};
  for (const Droop& d : droops) {
    forms.push_back({"cantilever_" + number(d.gamma),
                     "height / width at Gamma " + number(d.gamma),
                     d.ratio,
                     0.03,
                     {16, 32, 8},
                     d.least,
                     {},
                     "heavy elastica, Gamma = w L^3 / B",
                     [g = d.gamma](const Effort& e, const MakeSolver& make) { return droop(g, e, make); }});
  }
  forms.push_back({"chord_8",
                   "angle of the chord [degrees] at Gamma 8",
                   41.5,
                   0.03,
                   {12, 32, 4},
                   {8, 16, 2},
                   {},
                   "ASTM D1388: bending length = half the overhang at 41.5 degrees",
                   [](const Effort& e, const MakeSolver& make) { return chord_degrees(8, e, make); }});
  for (const double mu : {0.2, 0.3}) {
    std::string name = "capstan_" + number(mu);
    std::ranges::replace(name, '.', '_');
    forms.push_back({name,
                     "load / load at which it slides, friction " + number(mu),
                     capstan_limit(mu),
                     0.05,
                     {37, 32, 8},
                     {18, 16, 2},
                     {},
                     "exp(mu pi), and the weight of the strip on the cylinder",
                     [mu](const Effort& e, const MakeSolver& make) { return capstan(mu, e, make); }});
  }
  return forms;
}

}  // namespace

std::span<const ClosedForm> closed_forms() {
  static const std::vector<ClosedForm> forms = make_closed_forms();
  return forms;
}

}  // namespace geocloth::test
