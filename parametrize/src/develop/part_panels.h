// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/sewn_sheet.h"

namespace geocloth {

/// What parting may cost. Seams are what users pay for: lines on the cloth, copies of points, and outlines along which
/// the image is less exact. Empty pixels are only memory. What an image lacks of each of its targets is counted as a
/// share of that target, so that what is far off counts for more than what is nearly there.
struct PartingOptions {
  double pixel = 0;           ///< [m] side of a pixel of the image; 0: nothing is parted
  double enough = 0.75;       ///< utilisation at which an image counts as well filled
  double wanted = 0.77;       ///< above which nothing is parted: what is estimated on outlines may come to be less
  double reaching = 0.05;     ///< what it is worth besides to get from the one to the other
  double much_fuller = 1.3;   ///< times the utilisation for which cloth that needs no seam is cut in any case
  double seam_price = 0.12;   ///< of new seams, by length / root of the area
  double most_seam = 1.79;    ///< seams in all, by the root of the area
  double most_longer = 1.22;  ///< where they are longer already: than they are
  double most_border = 0.07;  ///< share of the pixels that is to lie on outlines
};

/// How charts that lie as they are fill an image.
struct Filling {
  double utilisation = 0;  ///< share of its pixels
  double border = 0;       ///< share of the charts' pixels that miss one of their eight neighbours
  double seam = 0;         ///< by the root of the area
};
[[nodiscard]] Filling filling_of(const std::vector<Chart>& charts, const Sheet& sheet, double pixel);
/// The same but for the utilisation, which takes long.
[[nodiscard]] Filling unpacked(const std::vector<Chart>& charts, const Sheet& sheet, double pixel);

/// The limit for charts that may be beyond it already.
[[nodiscard]] double most_seam(const Filling& whole, const PartingOptions& options);

/// What a filling misses of its targets, in shares of them, and the price of new seams. The border's part and the
/// price alone are least_misses(): what no packing can do anything about.
[[nodiscard]] double misses_of(const Filling& f, double new_seam, const PartingOptions& options);
[[nodiscard]] double least_misses(double border, double new_seam, const PartingOptions& options);

/// Is a border that was short enough given up, or cloth cut that lies flat without any seam, though it is not sure that
/// the image is well filled for it? (Nor much fuller than before: cloth without seams may be a ribbon.)
[[nodiscard]] bool gives_up_too_much(const Filling& f, const Filling& whole, const PartingOptions& options);

/// Charts that keep their places in the plane; outlines as they were are pinned in the sheet, so that only new seams
/// are drawn straight: drawn once more, the others would become still shorter, and the cloth more stretched.
struct PartedPanels {
  std::vector<Chart> charts;
  Sheet sheet;
  double promise = 0;  ///< what it is thought to miss
};

constexpr double kSparse = 0.25;  ///< utilisation below which every trial takes long, such as of ribbons

/// Ways to part charts so that they can be packed closer: a sleeve at its end, a shirt between its halves, the ring of
/// a wide skirt into sectors. As few and as short partings as pay, and none that makes more seam than allowed, as far
/// as can be told by outlines cut straight.
/// @param charts  upright (grain.h) or not
/// @returns a few, the most promising first
[[nodiscard]] std::vector<PartedPanels> ways_to_part(const std::vector<Chart>& charts, const Sheet& sheet,
                                                     const PartingOptions& options);

}  // namespace geocloth
