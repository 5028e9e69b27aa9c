// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "mesh/refined_mesh.h"

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

/// Where the samples of a seam lie, in the seam's own direction.
struct SeamPlaces {
  std::vector<double> arc;  ///< per vertex of the seam: what counts as length along it, ascending from 0
  std::vector<double> at;   ///< per sample, both ends included: where along that it lies, ascending
};

/// Divides every seam into a whole number of steps and inserts a vertex where a sample falls between two. Samples are
/// found once per seam, so that all its runs get the same points at bit-identical places.
/// @param seam_steps  per seam, > 0
/// @param places      per seam; empty: samples at equal lengths in space
[[nodiscard]] std::vector<SampledOutline> insert_seam_samples(RefinedMesh& mesh, std::span<const Outline> outlines,
                                                              std::span<const uint32_t> seam_steps,
                                                              std::span<const SeamPlaces> places = {});

}  // namespace geocloth
