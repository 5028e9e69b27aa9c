// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "develop/develop.h"

namespace geocloth {

constexpr size_t kNoStrips = SIZE_MAX;  ///< are to be cut off a component

/// Cuts strips that are not much wider than a pixel, such as fringes, tassels and ties, off at their roots. Two pixels
/// wide each, neighbours would lie on each other where they are; as charts of their own they lie anywhere. Everything
/// else keeps its place in the plane, and every strip its shape.
/// @param least    per component of the cut surface: how many strips it must have for that
/// @param spacing  [m] of a pixel
/// @returns whether there was any
[[nodiscard]] bool cut_off_strips(DevelopedSurface& developed, std::span<const size_t> least, double spacing);

}  // namespace geocloth
