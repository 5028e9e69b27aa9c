// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

struct BorderLoop {
  std::vector<uint32_t> edge;  ///< half-edges in their order
  bool tied = false;           ///< somewhere to another border, or to itself
};
[[nodiscard]] std::vector<BorderLoop> all_border_loops(const CleanSurface& surface);

/// Border loops without ties, as half-edges in their order.
[[nodiscard]] std::vector<std::vector<uint32_t>> border_loops(const CleanSurface& surface);

/// [m]
[[nodiscard]] double length_around(const CleanSurface& surface, const std::vector<uint32_t>& loop);

/// Fills a hole with a fan around its middle; its triangles are the last ones then, one per edge of the loop.
/// @returns its area, or 0 and nothing done where that is larger than `most_area` or triangles would be needles
double fill_with_fan(CleanSurface& surface, const std::vector<uint32_t>& loop, double most_area);

}  // namespace geocloth
