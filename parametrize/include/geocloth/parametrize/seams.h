// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geocloth/parametrize/rasterize.h"

namespace geocloth {

/// Fills the image part of an asset from a raster: split-vertex table (pixels of one point), triangles of the cells
/// (the shorter diagonal that joins no two copies and repeats no edge of the welded mesh), spring validity per spring,
/// bending across seams, area shares, spacing.
[[nodiscard]] ClothAsset build_image(const FlatSurface& flat, const Raster& raster, Layout layout);

/// Fills `name`, `vertex_groups`, `source` and `binding`: the mesh of the file as render vertices (those of file vertex
/// 0 first), each bound to the grid triangle that holds its place in the chart. Vertices without a place there, such as
/// those that no face uses, are bound to the nearest place. Pieces that the image leaves out ride on the cloth beside
/// them: small ones as a whole, so that they keep their shape, larger ones vertex by vertex.
/// @param carried_piece  per point of the clean surface: which such piece it is in, kNone for none; empty: all none
/// @param beside  [m] per vertex of the file: where the cloth is that it is to ride on; empty: all where they are
void bind_source(const TriangleMesh& mesh, const CleanSurface& clean, const FlatSurface& flat, const Raster& raster,
                 ClothAsset& asset, std::span<const uint32_t> carried_piece = {}, std::span<const Point3> beside = {});

}  // namespace geocloth
