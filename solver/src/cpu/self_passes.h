// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/passes.h"

namespace geocloth::cpu {

// The passes of self-collision; see pass.h.
void self_drift(const PassContext& context, ClothState& state);
void self_clear(const PassContext& context, ClothState& state);
void self_insert(const PassContext& context, ClothState& state);
void self_find(const PassContext& context, ClothState& state);
void self_push(const PassContext& context, ClothState& state);
void self_move(const PassContext& context, ClothState& state);

}  // namespace geocloth::cpu
