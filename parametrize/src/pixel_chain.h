// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

using Pixel = std::array<int32_t, 2>;  ///< column, row (downwards)

/// One run of a chart's outline between two cut nodes, as places in the plane that pixels have to be found for.
struct ChainRun {
  std::vector<Point2> target;  ///< [pixels] sample by sample, node to node; v down
  std::vector<Point2> inward;  ///< per sample: unit vector into the chart
  bool operator==(const ChainRun&) const = default;
};

/// What came of it: for every run its pixels (as many as targets), or the runs that found no way.
struct ChainResult {
  struct Failure {
    uint32_t run;
    uint32_t least_steps;  ///< between the pixels that its ends got
  };
  std::vector<std::vector<Pixel>> run;
  std::vector<Failure> failed;  ///< runs without a way; then `run` is not complete
};

/// Finds a closed simple polygon of pixels with one pixel per sample, consecutive pixels being 8-neighbours, as near to
/// the targets as that goes. Since a lattice way between two places may take any number of steps from the larger to the
/// sum of its extents, runs of equal sample count fit both sides of a seam whatever their directions in the plane.
/// The polygon meets no pixel twice and crosses itself nowhere, so that its inside is a disk.
/// Dynamic programming over (pixel, direction) per run, least sum of squared distances; sharp turns cost, reversals are
/// not allowed. Runs are placed one after the other, longest first, on pixels still free.
[[nodiscard]] ChainResult place_chain(std::span<const ChainRun> outline);

}  // namespace geocloth
