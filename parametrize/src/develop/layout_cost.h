// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/chart.h"

namespace geocloth {

constexpr double kMostStrain = 4.055;   ///< energy of a triangle with s1 / s2 of about 1.15
constexpr double kMostStrained = 0.05;  ///< of a chart's area: more of it is not to be stretched so

/// The area that is stretched more one way than the other than kMostStrain tells.
[[nodiscard]] double strained_area(const Chart& chart);

/// The length of an outline in the plane when it runs straight where it is serrated now, about; with
/// the rims of holes inside of it.
[[nodiscard]] double smooth_outline_length(const Chart& chart);

/// By what layouts of the same part are compared.
struct LayoutCost {
  double area = 0;      ///< [m^2]
  double outline = 0;   ///< [m]
  double energy = 0;    ///< symmetric Dirichlet energy times the area [m^2]
  double strained = 0;  ///< [m^2]

  void add(const Chart& chart, double outline_length);

  /// In lengths of seam by the root of the area: the seams, what little distortion there is, and much more where that
  /// is beyond the bounds.
  [[nodiscard]] double value(double target_energy) const;
};

}  // namespace geocloth
