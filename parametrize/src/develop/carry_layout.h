// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "develop/chart.h"

namespace geocloth {

/// Where every corner of every triangle lay in the plane before triangles were split and cuts moved.
struct FormerLayout {
  std::vector<uint32_t> chart;                  ///< per former triangle
  std::vector<std::array<Point3, 3>> position;  ///< per former triangle, its corners in space
  std::vector<std::array<Point2, 3>> uv;        ///< and in the plane
};

/// Gives a chart the coordinates it had before; what came to it from elsewhere is unfolded beside it.
/// @param former_triangle  per triangle of the chart: the one it is part of
/// @returns false, and the chart without coordinates, where that flips a triangle
bool carry_layout(Chart& chart, const std::vector<uint32_t>& former_triangle, const FormerLayout& former);

}  // namespace geocloth
