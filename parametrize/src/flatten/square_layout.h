// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// Layout::square of flatten().
[[nodiscard]] FlatSurface lay_out_squares(const CutSurface& cut, const FlattenOptions& options,
                                          const Progress& progress);

}  // namespace geocloth
