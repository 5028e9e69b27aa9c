// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "backend.h"

namespace geocloth {

/// Appends to the list over seams, sorted by colour: each entry takes the lowest colour that none of its pixels has
/// yet, in order, so entries of one colour are projected in any order. An entry that would need more colours is left
/// out.
/// @returns number of colours added
uint32_t append_by_color(std::span<const shader::SeamSpring> entries, uint32_t most_colors, ClothData& data);

}  // namespace geocloth
