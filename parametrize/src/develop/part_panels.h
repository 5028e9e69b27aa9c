// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/sewn_sheet.h"

namespace geocloth {

struct PartingOptions {
  double pixel = 0;           ///< [m] side of a pixel of the image; 0: nothing is parted
  double wanted = 0.77;       ///< utilisation above which nothing is parted, as estimated on outlines
  double most_border = 0.07;  ///< share of the pixels that may lie on outlines, unless the image is mostly empty
  double most_seam = 1.79;    ///< seams in all, by the root of the area, unless they are longer already
  double least_gain = 0.015;  ///< of the utilisation, by length of new seam / root of the area
};

/// How charts that lie as they are fill an image.
struct Filling {
  double utilisation = 0;  ///< share of its pixels
  double border = 0;       ///< share of the charts' pixels that miss one of their eight neighbours
  double seam = 0;         ///< by the root of the area
};
[[nodiscard]] Filling filling_of(const std::vector<Chart>& charts, const Sheet& sheet, double pixel);

/// Charts that keep their places in the plane; the ends of new seams are pinned in the sheet.
struct PartedPanels {
  std::vector<Chart> charts;
  Sheet sheet;
  double promise = 0;  ///< the utilisation, as far as it is wanted, less the price of new seams
};

constexpr double kSparse = 0.25;  ///< utilisation below which pixels on borders cost less than empty ones

/// Ways to part charts so that they can be packed closer: a sleeve at its end, a shirt between its halves, the ring of
/// a wide skirt into sectors. As few and as short partings as reach the wanted utilisation, and none that makes more
/// seam and border than allowed, as far as can be told by outlines cut straight.
/// @param charts  upright (grain.h) or not
/// @returns a few, the most promising first
[[nodiscard]] std::vector<PartedPanels> ways_to_part(const std::vector<Chart>& charts, const Sheet& sheet,
                                                     const PartingOptions& options);

}  // namespace geocloth
