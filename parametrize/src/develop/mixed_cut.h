// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "develop/chart.h"

namespace geocloth {

/// A surface that was cut in several ways, its parts taken from one or the other.
/// @param choice  per chart: the cut that it is of; all charts of a part have the same
/// @param charts  of every part; renumbered to those of the result
[[nodiscard]] CutSurface put_together(std::span<const CutSurface> cuts, std::span<const size_t> choice,
                                      std::span<Chart> charts);

}  // namespace geocloth
