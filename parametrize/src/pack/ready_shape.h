// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pack/board.h"
#include "pack/pack.h"

namespace geocloth {

/// A shape as packing sees it, for those that are packed many times.
struct ReadyShape {
  ChartShape shape;
  Grown upright, turned;  ///< in blocks of one pixel
};
[[nodiscard]] ReadyShape make_ready(ChartShape shape);

}  // namespace geocloth
