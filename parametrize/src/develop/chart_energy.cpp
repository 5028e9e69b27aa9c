// SPDX-License-Identifier: GPL-3.0-or-later
#include "develop/chart_energy.h"

#include <vector>

namespace geocloth {

SymmetricDirichlet chart_energy(const Chart& chart) {
  constexpr double kFilling = 0.01;
  std::vector<double> share;
  for (const uint32_t h : chart.hole) share.push_back(h == kNone ? 1 : kFilling);
  return {chart.position, chart.triangle, {}, share};
}

}  // namespace geocloth
