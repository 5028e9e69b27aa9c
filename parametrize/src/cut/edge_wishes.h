// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "cut/straight_cuts.h"
#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// Cuts along creases show least and let more of the curvature out; where the garment has its own seams they show most
/// like it, and where left and right agree they look meant. What is wanted counts as shorter by this share.
constexpr double kCreaseDiscount = 0.5;
constexpr double kSeamDiscount = 0.3;
constexpr double kMirrorDiscount = 0.4;

/// The angle between the normals of two triangles [rad].
[[nodiscard]] double fold_between(std::span<const Point3> position, const Triangle& a, const Triangle& b);

/// How wanted a crease is, from 0 where the surface is flat to 1 where it is folded by a radian or more.
[[nodiscard]] double crease_between(std::span<const Point3> position, const Triangle& a, const Triangle& b);

/// Where the first cuts run: only what is folded more than the wrinkles of worn cloth counts.
[[nodiscard]] double sharp_crease_between(std::span<const Point3> position, const Triangle& a, const Triangle& b);

/// Per half-edge the discount for the garment's own seams and for the mirror plane, 0 where there is neither.
/// @param clean_vertex  per vertex: that of CutPreferences::seams
[[nodiscard]] std::vector<double> wished_discounts(std::span<const Point3> position, std::span<const Triangle> triangle,
                                                   std::span<const uint32_t> clean_vertex,
                                                   const CutPreferences& prefer);

/// Fixes the cuts that follow one of the garment's own seams, and those that follow a crease where that is preferred or
/// the lines may not go anywhere: straightening may not take them off it.
void hold_wished_cuts(const RefinedMesh& mesh, const CutPreferences& prefer, CutLines& lines);

/// Per vertex the one nearest to its mirror image, kNone where no surface is.
[[nodiscard]] std::vector<uint32_t> mirror_vertices(std::span<const Point3> position,
                                                    std::span<const Triangle> triangle, const MirrorPlane& plane);

}  // namespace geocloth
