// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/passes.h"

namespace geocloth::cpu {

/// One of the passes self_drift .. self_move of a cloth; see pass.h.
void run_self_pass(Pass pass, const PassContext& context, ClothState& state);

/// One of the passes inter_drift .. inter_push over the points of all cloths that collide with each other.
void run_inter_pass(Pass pass, const shader::ClothParams& params, const Threads& threads, SelfData& points);
/// The passes inter_gather and inter_move of one of these cloths.
/// @param part  its points and pixels
void inter_gather(const InterPart& part, const PassContext& context, ClothState& state, SelfData& points);
void inter_move(const InterPart& part, const PassContext& context, ClothState& state, SelfData& points);

}  // namespace geocloth::cpu
