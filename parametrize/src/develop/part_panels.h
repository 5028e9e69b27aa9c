// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/sewn_sheet.h"

namespace geocloth {

struct PartingOptions {
  double pixel = 0;           ///< [m] side of a pixel of the image; 0: nothing is parted
  double wanted = 0.77;       ///< utilisation above which nothing is parted, as estimated on outlines
  double most_border = 0.07;  ///< share of the pixels that may lie on outlines, unless the image is mostly empty
  double most_seam = 1.79;    ///< seams in all, by the root of the area
  double least_gain = 0.04;   ///< of the utilisation, by length of new seam / root of the area
};

/// About the share of the image that charts fill as they lie.
[[nodiscard]] double estimated_utilisation(const std::vector<Chart>& charts, double pixel);

/// Parts charts where that lets them be packed closer: a sleeve at its end, a shirt between its halves, the ring of a
/// wide skirt into sectors. As few and as short partings as reach the wanted utilisation, and none that makes more
/// seam and border than allowed. Charts keep their places in the plane.
/// @param charts  upright (grain.h) or not
/// @param sheet  the new seams' ends are pinned in it
/// @returns whether anything was parted
bool part_panels(std::vector<Chart>& charts, Sheet& sheet, const PartingOptions& options);

}  // namespace geocloth
