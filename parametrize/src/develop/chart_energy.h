// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "develop/chart.h"
#include "develop/symmetric_dirichlet.h"

namespace geocloth {

/// The energy of a chart's cloth. What fills its holes counts next to nothing: it follows, and must not flip.
[[nodiscard]] SymmetricDirichlet chart_energy(const Chart& chart);

}  // namespace geocloth
