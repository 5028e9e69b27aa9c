// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/sewn_sheet.h"

namespace geocloth {

/// What parting may cost. Seams are what users pay for: lines on the cloth, copies of points, and outlines along which
/// the image is less exact. Empty pixels are only memory.
struct PartingOptions {
  double pixel = 0;            ///< [m] side of a pixel of the image; 0: nothing is parted
  double enough = 0.75;        ///< utilisation at which an image counts as well filled
  double wanted = 0.77;        ///< above which nothing is parted: what is estimated on outlines may come to be less
  double reaching = 0.02;      ///< what it is worth besides to get from the one to the other
  double seam_price = 0.12;    ///< of new seams, in utilisation, by length / root of the area
  double most_seam = 1.79;     ///< seams in all, by the root of the area
  double most_longer = 1.22;   ///< where they are longer already: than they are
  double most_border = 0.07;   ///< share of the pixels that may lie on outlines
  double most_crowded = 0.10;  ///< where more do already, unless the image is mostly empty
};

/// How charts that lie as they are fill an image.
struct Filling {
  double utilisation = 0;  ///< share of its pixels
  double border = 0;       ///< share of the charts' pixels that miss one of their eight neighbours
  double seam = 0;         ///< by the root of the area
};
[[nodiscard]] Filling filling_of(const std::vector<Chart>& charts, const Sheet& sheet, double pixel);

/// The limits for charts that may be beyond them already.
[[nodiscard]] double most_seam(const Filling& whole, const PartingOptions& options);
[[nodiscard]] double most_border(const Filling& whole, const PartingOptions& options);

/// The utilisation, as far as it is wanted, less the price of new seams; the step to what is enough counts more.
[[nodiscard]] double worth_of(double utilisation, double new_seam, const PartingOptions& options);

/// Charts that keep their places in the plane; outlines as they were are pinned in the sheet, so that only new seams
/// are drawn straight: drawn once more, the others would become still shorter, and the cloth more stretched.
struct PartedPanels {
  std::vector<Chart> charts;
  Sheet sheet;
  double promise = 0;  ///< what it is thought to be worth
};

constexpr double kSparse = 0.25;  ///< utilisation below which pixels on borders cost less than empty ones

/// Ways to part charts so that they can be packed closer: a sleeve at its end, a shirt between its halves, the ring of
/// a wide skirt into sectors. As few and as short partings as pay, and none that makes more seam and border than
/// allowed, as far as can be told by outlines cut straight.
/// @param charts  upright (grain.h) or not
/// @returns a few, the most promising first
[[nodiscard]] std::vector<PartedPanels> ways_to_part(const std::vector<Chart>& charts, const Sheet& sheet,
                                                     const PartingOptions& options);

}  // namespace geocloth
