// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Edges where two layers of cloth meet, as those of a cushion, a belt or a jacket's rims do: folded sharply, and in
/// lines that close, or that end on borders, and so part what is on one side from what is on the other. Parts that are
/// all folds, such as pleated ones, have none; neither has a part of more than `most_triangles`.
/// @param surface  upright or not
/// @returns vertex pairs, each sorted, in ascending order
[[nodiscard]] std::vector<std::array<uint32_t, 2>> fold_loops(const CleanSurface& surface, size_t most_triangles);

}  // namespace geocloth
