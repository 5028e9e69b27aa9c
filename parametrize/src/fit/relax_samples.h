// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/rasterize.h"

namespace geocloth {

/// Moves the samples of the pixels inside the charts along the surface, so that the grid's edges have about the length
/// of a spring in space and meet at right angles there. Outline pixels stay, and every sample stays on the surface.
/// For layouts whose charts are about isometric; `place`, `triangle` and `position` change.
void relax_samples(const FlatSurface& flat, Raster& raster);

}  // namespace geocloth
