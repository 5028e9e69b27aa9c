// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/sewn_sheet.h"

namespace geocloth {

struct MergeOptions {
  double most_energy = 4.02;  ///< of a merged chart
  double seam_price = 0.025;  ///< the energy may rise by this per length of the seam / sqrt(area)
  double narrow = 0;          ///< [m] parts of an outline that are nearer to each other leave no room for pixels
};

/// Sews charts together where the seam between them does not pay: the energy hardly rises, the result does not lie over
/// itself, and the grain (the direction that is up in space) of both runs along one line. Long seams go first.
void merge_charts(std::vector<Chart>& charts, const Sheet& sheet, const MergeOptions& options);

}  // namespace geocloth
