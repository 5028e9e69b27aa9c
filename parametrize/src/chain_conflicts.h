// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pixel_chain.h"

namespace geocloth {

/// A chart's closed chain of outline pixels with the surface point that each of them stands for.
struct PointChain {
  std::vector<Pixel> pixel;
  std::vector<uint32_t> point;
};

/// Charts in which a grid edge through the inside joins two surface points that another edge of the image joins too, or
/// two copies of one point: welded, such a pair of edges would pinch the surface. Ascending.
[[nodiscard]] std::vector<size_t> conflicting_charts(std::span<const PointChain> charts);

}  // namespace geocloth
