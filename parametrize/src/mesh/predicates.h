// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Which side of the line from a to b the point c lies on, without rounding error, in chart coordinates (v runs down):
/// +1 when a, b, c is counter-clockwise seen with v up, -1 when clockwise, 0 when the three are collinear.
[[nodiscard]] int orientation(const Point2& a, const Point2& b, const Point2& c);

}  // namespace geocloth
