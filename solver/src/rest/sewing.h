// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "backend.h"

namespace geocloth {

/// [m] between two pixels of ClothAsset::sewing.
[[nodiscard]] float sewing_thread(const ClothAsset& asset, float scale, uint32_t a, uint32_t b);

/// Appends the threads between points that are to be sewn together, by colour after all others, and those that take
/// more rounds, and says how many colours they take.
/// @throws Error(limit) for more than a thousand threads that follow each other at one point
void add_sewing(const ClothAsset& asset, float scale, ClothData& data);

}  // namespace geocloth
