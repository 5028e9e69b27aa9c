// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/convert.h"

namespace geocloth {

/// Refuses a result that is not what the surface was, so that no wrong asset is ever written.
/// @throws Error(verification) naming the part of the mesh and the remedy
void verify(const TriangleMesh& mesh, const CleanSurface& clean, const FlatSurface& flat, const Raster& raster,
            const ClothAsset& asset, const ConvertReport& report);

}  // namespace geocloth
