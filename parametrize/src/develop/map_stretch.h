// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// Metres per pixel at which the charts have in all as much area as the surface; 0 when there is none.
[[nodiscard]] double map_unit(const FlatSurface& flat);

/// Singular values of the map from the chart to space at a triangle, largest first; zero when the flat triangle has no
/// area.
/// @param unit  metres per pixel
[[nodiscard]] std::array<double, 2> singular_values(const FlatSurface& flat, const Triangle& t, double unit);

}  // namespace geocloth
