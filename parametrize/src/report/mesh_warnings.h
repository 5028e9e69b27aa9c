// SPDX-License-Identifier: GPL-3.0-or-later
// What a user should know of the mesh that they gave, one sentence each, with the remedy; nothing where it is as it
// should be. What came out of it is measured in warnings.h.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "geocloth/parametrize/convert.h"
#include "geocloth/parametrize/repair.h"
#include "repair/small_pieces.h"

namespace geocloth {

/// Springs are much longer or shorter than asked for.
/// @param spacing  [m] of the asset
/// @param asked    [m] 0: nothing was asked for
[[nodiscard]] std::optional<std::string> warning_of_spacing(double spacing, double asked);

/// What is drawn is so coarse beside the pixels that it shows little of what these do.
[[nodiscard]] std::optional<std::string> warning_of_coarse_triangles(const ClothAsset& asset);

/// Where a garment may lie in pieces that no one meant to be apart.
[[nodiscard]] std::optional<std::string> warning_of_cracks(const Cracks& cracks);

/// Both sides of cloth with a thickness are cloth, each for itself.
/// @param thickness  [m] as of find_thickness()
[[nodiscard]] std::optional<std::string> warning_of_thickness(const std::optional<double>& thickness);

/// Layers at one place can be the two sides of cloth, or a garment folded flat.
/// @param triangles  of the file
/// @param size       [m] of its bounding diagonal
[[nodiscard]] std::optional<std::string> warning_of_folds(const RepairResult& repaired, std::size_t triangles,
                                                          double size);

/// Folds of a pleated skirt that touch were sewn together, and it could not open.
/// @param size  [m] of the file's bounding diagonal
[[nodiscard]] std::optional<std::string> warning_of_touching(const RepairResult& repaired, double size);

/// What looks like trimmings and is cloth for itself.
[[nodiscard]] std::optional<std::string> warning_of_loose_pieces(const LoosePiecesLeft& loose);

/// The mesh lay too far from the origin.
/// @param way  [m] by which it was moved
[[nodiscard]] std::string warning_of_move(const Point3& way);

/// Nearly all of a mesh is within a pixel, or small beside the whole, because a few of its vertices are far away.
/// @param moved    [m] what the file's vertices were moved by before
/// @param spacing  [m] of the asset
[[nodiscard]] std::optional<std::string> warning_of_far_vertices(const TriangleMesh& mesh, const Point3& moved,
                                                                 double spacing);

}  // namespace geocloth
