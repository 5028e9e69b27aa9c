// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "backend.h"

namespace geocloth {

/// Fills what self-collision needs of a cloth: points, words and numbers of ClothData.
/// @throws Error(limit) for more points than their words can be counted
void add_self_points(const ClothDesc& cloth, ClothData& data);

void set_self_numbers(const SelfNumbers& numbers, shader::ClothParams& params);

}  // namespace geocloth
