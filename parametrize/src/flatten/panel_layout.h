// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "develop/develop.h"
#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// Layout::panels of flatten(): charts with free outlines, nearly isometric, grain up, one spacing for all.
/// @param cuts  as develop() takes them
[[nodiscard]] FlatSurface lay_out_panels(std::span<const CutSurface> cuts, const FlattenOptions& options,
                                         const Progress& progress);

/// Gives the charts of a developed surface their pixels: one spacing for all, seams point by point. Packs them.
[[nodiscard]] FlatSurface lay_out_developed(DevelopedSurface developed, const FlattenOptions& options,
                                            const Progress& progress);

/// Sets the metres per pixel of every chart, by its areas in space and in the plane.
void set_spacing(FlatSurface& flat);

}  // namespace geocloth
