// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "refined_mesh.h"

namespace geocloth {

/// A vertex of an outline and how far along it lies; a whole number is a sample, on which a pixel falls.
struct OutlineStop {
  uint32_t vertex;
  double step;
};

/// The outline of one component, counter-clockwise from its first node, every vertex once; steps ascend from 0.
struct SampledOutline {
  std::vector<OutlineStop> stop;
  uint32_t steps = 0;  ///< in all, once around
};

/// Divides every seam into a whole number of equal steps and inserts a vertex where a sample falls between two. Samples
/// are found once per seam, so that all its runs get the same points at bit-identical places.
/// @param seam_steps  per seam, > 0
/// @param segment_length  per seam and per segment between its vertices, in the seam's own direction: what counts as
///   length along it; empty: arc length in space
/// @param at  per seam and per sample, ends included: where along that length the samples lie; empty: evenly
[[nodiscard]] std::vector<SampledOutline> insert_seam_samples(RefinedMesh& mesh, std::span<const Outline> outlines,
                                                              std::span<const uint32_t> seam_steps,
                                                              std::span<const std::vector<double>> segment_length = {},
                                                              std::span<const std::vector<double>> at = {});

}  // namespace geocloth
