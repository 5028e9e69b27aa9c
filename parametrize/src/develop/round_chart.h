// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "image/seam_samples.h"
#include "mesh/refined_mesh.h"

namespace geocloth {

/// A disk with its outline on a circle.
struct RoundChart {
  std::vector<uint32_t> vertex;  ///< of the refined mesh
  std::vector<Point2> uv;        ///< per vertex [pixels]: y up, the circle's middle at the origin
};

/// Lays a component out on a disk whose circumference is one pixel per step: room for any outline, at the price of its
/// shape. For crumpled scraps whose own shape has no room for the pixels of all their seams.
/// @param triangles  those of the component
/// @throws Error(verification) when they are too thin for that
[[nodiscard]] RoundChart lay_out_round(const RefinedMesh& mesh, std::span<const uint32_t> triangles,
                                       const SampledOutline& outline);

}  // namespace geocloth
