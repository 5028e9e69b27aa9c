// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/sewn_sheet.h"

namespace geocloth {

/// A cut surface with its charts in the plane.
struct ChartedSurface {
  CutSurface cut;
  std::vector<Chart> charts;
};

/// Lets the seams of laid out charts run straight across the faces (straight_cuts.h) and relaxes the charts again. A
/// chart that would come to lie over itself or be strained by that lets its seams move less: off no crease, a few
/// vertices far, one, or not at all.
/// @param charts  of `cut`, sewn up in part perhaps (merge_charts.h)
/// @param prefer  seams of the garment that cuts along them do not leave
/// @param target_energy  of charts; what is above counts much (layout_cost.h)
[[nodiscard]] ChartedSurface straighten_layout(const CutSurface& cut, const Sheet& sheet,
                                               const std::vector<Chart>& charts, const CutPreferences& prefer,
                                               double target_energy);

}  // namespace geocloth
