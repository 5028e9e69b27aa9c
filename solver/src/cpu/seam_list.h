// SPDX-License-Identifier: Apache-2.0
// The list of bends across seams, colour by colour.
#pragma once

#include <cstdint>

#include "cpu/line.h"
#include "cpu/passes.h"

namespace geocloth::cpu {

/// Projects every entry of the step's colour; entries of one colour share no pixel.
/// @param project  gives the new multiplier: float(const PointLine& pixels, const SeamSpring&, float multiplier,
///                 Fine<...>), the line being that of all pixels
template <class Project>
void for_seam_list(const PassContext& context, ClothState& state, const PassStep& step, const Project& project) {
  const bool accumulate = context.relaxation_steps > 1;
  const uint32_t begin = state.data.seam_color_offset[step.group], fine = context.cloth.params.fine;
  const uint32_t count = state.data.seam_color_offset[step.group + 1] - begin;
  const shader::SeamSpring* const springs = state.data.seam_springs.data() + begin;
  float* const multipliers = accumulate ? state.seam_multiplier.data() + begin : nullptr;
  context.threads.for_range(count, kRowGrain, [&](uint32_t first, uint32_t last) {
    const PointLine pixels(state, 0, fine);
    with_fine(fine, [&](auto mode) {
      for (uint32_t k = first; k < last; ++k) {
        const float multiplier = accumulate && step.relaxation > 0 ? multipliers[k] : 0.F;
        const float next = project(pixels, springs[k], multiplier, mode);
        if (accumulate) multipliers[k] = next;
      }
    });
  });
}

}  // namespace geocloth::cpu
