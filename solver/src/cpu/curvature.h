// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/passes.h"

namespace geocloth::cpu {

/// Pass::curvature: one group of bends over three pixels in a row.
void curvature(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass::seam_curvature: one colour of bends over seams.
void seam_curvature(const PassContext& context, ClothState& state, const PassStep& step);

}  // namespace geocloth::cpu
