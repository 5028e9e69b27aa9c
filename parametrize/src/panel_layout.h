// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// Layout::panels of flatten(): charts with free outlines, nearly isometric, grain up, one spacing for all.
[[nodiscard]] FlatSurface lay_out_panels(const CutSurface& cut, const FlattenOptions& options,
                                         const Progress& progress);

}  // namespace geocloth
