// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>

#include "develop/chart.h"

namespace geocloth {

/// Two outline edges (by their places in the loop) that properly cross in the plane, or none.
[[nodiscard]] std::optional<std::array<size_t, 2>> crossing_edges(const Chart& chart,
                                                                  const std::vector<uint32_t>& loop);

/// A path that parts the two crossing edges: from the middle of the outline between them to the middle of the rest.
/// Empty when there is none.
[[nodiscard]] std::vector<uint32_t> parting_path(const Chart& chart, const std::vector<uint32_t>& loop,
                                                 std::array<size_t, 2> crossing);

}  // namespace geocloth
