// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cpu/passes.h"

namespace geocloth::cpu {

/// Pass lines: those along rows (group 0) or columns.
void lines(const PassContext& context, ClothState& state, const PassStep& step);

}  // namespace geocloth::cpu
