// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"
#include "repair/upright.h"

namespace geocloth {

/// Renumbers components, triangles, their first corners, vertices and points by the shape alone, so that nothing that
/// comes later depends on the order in which a file lists them, nor on its scale or on how it is turned (as far as the
/// shape is not symmetric). Only `source_triangle` and `source_point` tell of the file's order afterwards.
/// @param upright  turns the surface so that up is +y
void put_in_canonical_order(CleanSurface& surface, const Upright& upright = {});

}  // namespace geocloth
