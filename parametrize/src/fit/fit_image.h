// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/convert.h"
#include "geocloth/parametrize/seams.h"

namespace geocloth {

/// Brings the grid mesh of a finished image as near to the surface as its pixels allow: splits cells by the diagonal
/// that lies along the folds instead of across them, and moves the pixels from samples of the surface to the least
/// squares fit of it. Pixels of panels also slide along the surface to its folds, as far as the springs' lengths stay
/// even and their angles right (grid_holds.h); free borders stay where they are. Springs between 0.6 and 1.5 of the
/// spacing stay so. Areas and rest lengths are set anew; everything else of the asset stays as it is, copies stay
/// bit-identical, and a surface that is flat between pixels is left alone.
/// @param raster  what the image was built from
void fit_image(const FlatSurface& flat, const Raster& raster, ClothAsset& asset);

/// Draws apart what of a finished image cuts through itself, see untangle(). Areas and rest lengths are set anew.
Untangled untangle_image(ClothAsset& asset);

}  // namespace geocloth
