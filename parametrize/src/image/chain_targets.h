// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Where the pixels of a closed outline should lie: at its samples, but where the chart is narrow a little to the
/// outside, and where it is slit a little to the inside, so that opposite sides get pixels of their own.
/// @param inside  [pixels] that opposite sides of a narrow place are to have between them
/// @param sample  [pixels] counter-clockwise seen with v up; v runs down
[[nodiscard]] std::vector<Point2> chain_targets(std::span<const Point2> sample, double inside = 1);

}  // namespace geocloth
