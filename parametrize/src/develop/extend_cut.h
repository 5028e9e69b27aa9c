// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/cut.h"

namespace geocloth {

/// Lengthens the cuts of components that a disk cannot hold well (long tubes, heads, limbs): as long as that lowers the
/// stretch of a map to the circle notably, the vertex of greatest stretch is joined to the outline by a cut.
/// @param good_stretch  per component: the L2 stretch below which no cut is worth while
[[nodiscard]] CutSurface extend_cuts(CutSurface cut, const std::vector<double>& good_stretch, const Progress& progress);

}  // namespace geocloth
