// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/passes.h"

namespace geocloth::cpu {

/// Pass spans: those of one group.
void spans(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass ties: those of one group.
void ties(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass whole_ties: those of one colour.
void whole_ties(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass seam_spans: those of one colour.
void seam_spans(const PassContext& context, ClothState& state, const PassStep& step);

/// Pass sew: those threads of one colour.
void sew(const PassContext& context, ClothState& state, const PassStep& step);

/// [m] of the group's span that starts at a pixel, whose end lies in the image; 0 where one of its springs is missing.
[[nodiscard]] float span_length(const ClothState& state, uint32_t group, size_t pixel);

}  // namespace geocloth::cpu
