// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// The shift of a chart against the pixels, below one pixel each way, with which those stretches of its outline that
/// run along rows and columns come to lie on them; of shifts about as good the one with which the chart takes up the
/// fewest rows and columns.
/// @param outline  [pixels] closed
[[nodiscard]] Point2 shift_to_lattice(std::span<const Point2> outline);

}  // namespace geocloth
