// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/lattice_shift.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace geocloth {
namespace {

/// How badly stretches of a closed outline that run along lattice lines miss them.
/// @param axis   0: lines u = const, 1: lines v = const
/// @param shift  [pixels] of the outline along the axis
double lattice_misfit(std::span<const Point2> outline, size_t axis, double shift) {
  double sum = 0;
  for (size_t i = 0; i < outline.size(); ++i) {
    const Point2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
    const double across = b[axis] - a[axis], along = b[1 - axis] - a[1 - axis];
    const double squared = across * across + along * along;
    if (!(squared > 0)) continue;
    const double place = (a[axis] + b[axis]) / 2 + shift, off = place - std::round(place);
    const double parallel = along * along / squared;  // squared cosine; its high power leaves parallel stretches only
    sum += std::pow(parallel, 16) * off * off;
  }
  return sum;
}

/// The rows or columns of pixels from one end of an outline to the other.
double lines_met(std::span<const Point2> outline, size_t axis, double shift) {
  const auto [low, high] = std::minmax_element(outline.begin(), outline.end(),
                                               [&](const Point2& a, const Point2& b) { return a[axis] < b[axis]; });
  return std::round((*high)[axis] + shift) - std::round((*low)[axis] + shift) + 1;
}

}  // namespace

Point2 shift_to_lattice(std::span<const Point2> outline) {
  constexpr int kTrials = 16;
  constexpr double kLine = 0.01;  // [squared pixels of misfit] what a pixel of the chart's box is worth
  Point2 shift{0, 0};
  for (size_t axis = 0; axis < 2; ++axis) {
    const double width = lines_met(outline, 1 - axis, 0);
    double least = std::numeric_limits<double>::infinity();
    for (int trial = 0; trial < kTrials; ++trial) {
      const double by = static_cast<double>(trial) / kTrials;
      const double misfit = lattice_misfit(outline, axis, by) + kLine * width * lines_met(outline, axis, by);
      if (misfit < least) shift[axis] = by;
      least = std::min(least, misfit);
    }
  }
  return shift;
}

}  // namespace geocloth
