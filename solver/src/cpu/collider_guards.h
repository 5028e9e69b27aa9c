// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cpu/sweep.h"

namespace geocloth::cpu {

/// Guards of the colliders that a cloth meets, for every substep; see ColliderGuard.
void guard_colliders(const FrameInput& frame, const shader::ClothParams& params, std::vector<ColliderGuard>& guards);

}  // namespace geocloth::cpu
