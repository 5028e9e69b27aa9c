// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"
#include "image/pixel_chain.h"
#include "image/seam_samples.h"

namespace geocloth {

/// One side of a seam, in the seam's own direction.
struct SeamSide {
  size_t chart = 0;
  std::vector<uint32_t> sample;  ///< per sample of the seam: which pixel of the chart's chain it falls on
  std::vector<Point2> curve;     ///< per vertex of the seam: its place in the chart's plane [pixels]
};

/// A seam whose samples may move along it.
struct SlidingSeam {
  SeamPlaces places;
  std::vector<double> mark;  ///< ascending: samples that lie here stay
  std::vector<SeamSide> side;
};

/// Moves the samples of seams along them, those of all sides together, to where the grids of the charts beside them
/// come out most even. Ends stay, and samples keep their order and a distance from each other.
/// @param chain  per chart: the pixels of its outline, closed
void slide_samples(std::span<const std::vector<Pixel>> chain, std::vector<SlidingSeam>& seams);

}  // namespace geocloth
