// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// How many pixel steps every seam gets, and the rectangle that every component's outline then fills exactly.
struct SquarePlan {
  std::vector<uint32_t> seam_steps;           ///< per seam
  std::vector<std::array<uint32_t, 2>> size;  ///< per component: width, height [pixels]; they differ by 1 at most
};

/// @param area  per component [m^2]
[[nodiscard]] SquarePlan plan_squares(const CutSurface& cut, std::span<const Outline> outlines,
                                      std::span<const double> area, const FlattenOptions& options);

}  // namespace geocloth
