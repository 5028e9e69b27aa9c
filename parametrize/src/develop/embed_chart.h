// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "develop/chart.h"

namespace geocloth {

/// Gives the chart coordinates without a flipped triangle: Tutte's embedding with the outline on a circle of the
/// surface's area. A tube or bag is cut open to its far end first, as often as that takes.
/// @throws Error(verification) when double precision does not suffice
void embed(Chart& chart);

/// Gives the chart the coordinates that it has in space where that is a plane: a long ribbon, or a sheet of very uneven
/// triangles, takes long to get there from a circle, and may not arrive.
/// @returns false where it is bent, or overlaps itself; it has no coordinates then
bool embed_flat(Chart& chart);

/// Tutte's embedding alone, without cuts.
/// @returns false when a triangle is flipped, which double precision makes possible
bool embed_on_circle(Chart& chart);

/// True when every triangle is counter-clockwise.
[[nodiscard]] bool flip_free(const Chart& chart);

}  // namespace geocloth
