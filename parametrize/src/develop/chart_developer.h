// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "develop/chart.h"
#include "develop/develop.h"
#include "develop/trial_memory.h"

namespace geocloth {

/// Cuts are chosen one after the other, and what is best at the time need not be in the end: several ways to choose are
/// tried.
struct Taste {
  enum class Likes {
    most_gain,            ///< the greatest fall of the energy beyond the price
    most_for_its_length,  ///< the greatest fall by length
    most_of_what_lacks,   ///< the same, but what falls below the target does not count
  } likes = Likes::most_gain;
  size_t places = 6;           ///< places tried at once, at most
  double crease_discount = 0;  ///< for cuts along creases (edge_wishes.h)
  bool both_sides = false;     ///< of the mirror plane are cut alike
};

/// A component of the cut surface in the plane without cuts of its own: where all tastes start.
[[nodiscard]] Chart laid_out(const CutSurface& cut, std::vector<uint32_t> triangles);

/// Cuts a component that is laid out until it lies well.
/// @param discount  as of wished_discounts(), for the mirror plane; may be empty
/// @param memory  of what was tried on this component; null where nothing else starts from it
/// @returns its charts
[[nodiscard]] std::vector<Chart> develop_component(const Chart& component, const DevelopOptions& options,
                                                   const Taste& taste, std::span<const double> discount,
                                                   TrialMemory* memory = nullptr);

}  // namespace geocloth
