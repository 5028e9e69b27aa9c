// SPDX-License-Identifier: Apache-2.0
// The list of bends across seams, colour by colour.
#pragma once

#include <cstdint>

#include "cpu/line.h"
#include "cpu/passes.h"

namespace geocloth::cpu {

/// Projects every entry of the step's colour; entries of one colour share no pixel.
/// @param project  gives the new multiplier: float(const SeamSpring&, float multiplier, Fine<...>)
template <class Project>
void for_seam_list(const PassContext& context, ClothState& state, const PassStep& step, const Project& project) {
  const bool accumulate = context.relaxation_steps > 1;
  const uint32_t begin = state.data.seam_color_offset[step.group];
  const uint32_t count = state.data.seam_color_offset[step.group + 1] - begin;
  context.threads.for_range(count, kRowGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t k = begin + first; k < begin + last; ++k) {
      const float multiplier = accumulate && step.relaxation > 0 ? state.seam_multiplier[k] : 0.F;
      with_fine(context.cloth.params.fine, [&](auto mode) {
        const float next = project(state.data.seam_springs[k], multiplier, mode);
        if (accumulate) state.seam_multiplier[k] = next;
      });
    }
  });
}

}  // namespace geocloth::cpu
