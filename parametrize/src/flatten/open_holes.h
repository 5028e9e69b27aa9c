// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "geocloth/parametrize/flatten.h"

namespace geocloth {

/// The holes whose filling or rim a cut meets, ascending.
[[nodiscard]] std::vector<uint32_t> holes_on_cuts(const CutSurface& cut);

/// Takes the fillings out of a surface that was laid flat with its holes filled: every hole gets a closed chain of
/// pixels inside its chart, as near to its rim as the lattice allows, which sample the rim.
/// @param hole  per triangle of the clean surface: the hole that it fills, kNone for cloth
/// @returns the holes for which that cannot be, ascending: a cut runs through them, or they lie so near to an outline
///   or to each other that there are no pixels between; then `flat` is as it was
[[nodiscard]] std::vector<uint32_t> open_holes(FlatSurface& flat, std::span<const uint32_t> hole);

}  // namespace geocloth
