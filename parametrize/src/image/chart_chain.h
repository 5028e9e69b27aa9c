// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "image/pixel_chain.h"

namespace geocloth {

/// The outline pixels of one chart, and what was asked for.
struct ChartChain {
  std::vector<Point2> target;
  std::vector<ApartSamples> apart;
  PixelChain chain;
};

/// Finds the outline pixels of a chart, counter-clockwise seen with v up, so that no two samples far apart in the plane
/// become neighbours on the lattice if that can be.
[[nodiscard]] ChartChain place_chart(std::vector<Point2> target);

/// Moves outline pixels apart that would pinch the welded surface between them.
/// @param points  per chart and per sample: the surface point that it stands for
/// @returns the charts in which that did not succeed
[[nodiscard]] std::vector<size_t> part_pinches(std::span<const std::vector<uint32_t>> points,
                                               std::vector<ChartChain>& charts);

}  // namespace geocloth
