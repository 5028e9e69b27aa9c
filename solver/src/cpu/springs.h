// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/passes.h"

namespace geocloth::cpu {

/// Passes structural, shear and bending: springs of one group.
void springs(const PassContext& context, ClothState& state, const PassStep& step);
/// Pass seam_bends: springs over seams, of one colour.
void seam_bends(const PassContext& context, ClothState& state, const PassStep& step);
/// Share of the error that a projection of the component's springs removes.
[[nodiscard]] float share_of(const shader::ClothParams& params, uint32_t component);

}  // namespace geocloth::cpu
