// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "image/pixel_chain.h"

namespace geocloth {

/// A chart's closed chain of outline pixels with the surface point that each of them stands for.
struct PointChain {
  std::vector<Pixel> pixel;
  std::vector<uint32_t> point;
};

/// Samples of one chart that must come to lie further apart.
struct ChainConflict {
  uint32_t chart;
  ApartSamples samples;
  bool operator==(const ChainConflict&) const = default;
  bool operator<(const ChainConflict& other) const {
    return std::tie(chart, samples) < std::tie(other.chart, other.samples);
  }
};

/// Finds the grid edges through the inside of a chart that join two surface points which another edge of the image
/// joins too, or two copies of one point: welded, such edges would pinch the surface. Ascending.
[[nodiscard]] std::vector<ChainConflict> chain_conflicts(std::span<const PointChain> charts);

}  // namespace geocloth
