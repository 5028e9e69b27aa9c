// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/passes.h"

namespace geocloth::cpu {

/// What only pulls is certainly slack where the square of its length is not above that of its longest by this factor:
/// most of it is, and no root is needed to see that.
inline constexpr float kSurelySlack = 1 - 1e-6F;

/// Pass spans: those of one group.
void spans(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass ties: those of one group.
void ties(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass whole_ties: those of one colour.
void whole_ties(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass seam_spans: those of one colour.
void seam_spans(const PassContext& context, ClothState& state, const PassStep& step);

/// [m] of the group's span that starts at a pixel, whose end lies in the image; 0 where one of its springs is missing.
[[nodiscard]] float span_length(const ClothState& state, uint32_t group, size_t pixel);

}  // namespace geocloth::cpu
