// SPDX-License-Identifier: Apache-2.0
// A sheet that bends into a cylinder of curvature k, across an axis at the angle t from weft, stores k^2 / 2 times
//   f(t) = B_weft cos^4 t + B_warp sin^4 t + 2 H cos^2 t sin^2 t
// (orthotropic plate; H from f(45 degrees) = B_bias). A direction at the angle d that has the rigidity w alone gives
// w cos^4(t - d) = w (3/8 + cos 2(t - d) / 2 + cos 4(t - d) / 8). So the weights come from five coefficients, by least
// squares with no weight below 0 (a row of springs that pushes would buckle), by coordinate descent.

#include "rest/bend_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geocloth {
namespace {

constexpr int kCoefficients = 5;  ///< of 1, cos 2t, sin 2t, cos 4t, sin 4t
using Series = std::array<double, kCoefficients>;

/// Scalar product over all angles.
double product(const Series& a, const Series& b) {
  double sum = a[0] * b[0];
  for (size_t k = 1; k < kCoefficients; ++k) sum += 0.5 * a[k] * b[k];
  return sum;
}

Series direction_series(double d) {
  return {3.0 / 8, 0.5 * std::cos(2 * d), 0.5 * std::sin(2 * d), 0.125 * std::cos(4 * d), 0.125 * std::sin(4 * d)};
}

Series material_series(const Material& m) {
  const double weft = m.bend_weft, warp = m.bend_warp;
  const double h = 0.5 * (4 * static_cast<double>(m.bend_bias) - weft - warp);
  return {3.0 / 8 * (weft + warp) + 0.25 * h, 0.5 * (weft - warp), 0, 0.125 * (weft + warp) - 0.25 * h, 0};
}

/// Warp and weft are at right angles in the cloth: the cross that is nearest to the grid's two directions.
double right_from_weft(const GridDirections& grid) {
  return 0.5 * (std::numbers::pi / 2 - grid.angle);
}

}  // namespace

double angle_from_weft(const GridDirections& grid, double angle_from_right) {
  return right_from_weft(grid) + angle_from_right;
}

double rigidity_along(const Material& material, double angle) {
  const double weft = material.bend_weft, warp = material.bend_warp, bias = material.bend_bias;
  const double c = std::cos(angle) * std::cos(angle), s = 1 - c;
  const double h = bias >= 0 ? 0.5 * (4 * bias - weft - warp) : 0;
  return weft * c * c + warp * s * s + 2 * h * c * s;
}

std::array<double, kBendDirections> spread_rigidity(const Material& material, const GridDirections& grid) {
  const double right = right_from_weft(grid), down = right + grid.angle;
  const double x = grid.right * std::cos(right), y = grid.right * std::sin(right);
  const double u = grid.down * std::cos(down), v = grid.down * std::sin(down);
  const std::array<Series, kBendDirections> direction{direction_series(right), direction_series(down),
                                                      direction_series(std::atan2(y + v, x + u)),
                                                      direction_series(std::atan2(v - y, u - x))};
  const Series wanted = material_series(material);
  std::array<double, kBendDirections> weight{};
  const double enough = 1e-6 * (std::abs(wanted[0]) + std::abs(wanted[1]) + std::abs(wanted[3]));
  for (int round = 0; round < 1000; ++round) {
    double change = 0;
    for (size_t i = 0; i < kBendDirections; ++i) {
      double rest = product(direction[i], wanted);
      for (size_t j = 0; j < kBendDirections; ++j)
        if (j != i) rest -= product(direction[i], direction[j]) * weight[j];
      const double next = std::max(0.0, rest / product(direction[i], direction[i]));
      change = std::max(change, std::abs(next - weight[i]));
      weight[i] = next;
    }
    if (change <= enough) break;
  }
  return weight;
}

}  // namespace geocloth
