// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "cpu/cloth_state.h"
#include "cpu/threads.h"
#include "lib/normal.h"
#include "lib/pin.h"
#include "lib/yield.h"
#include "pass.h"

namespace geocloth::cpu {

inline constexpr uint32_t kPixelGrain = 4096;  ///< pixels that are worth a thread of their own
inline constexpr uint32_t kRowGrain = 512;     ///< split rows, pins, seam bends

/// Largest values met by the check passes [m].
struct Measures {
  float copy_gap = 0, penetration = 0;
  std::array<float, 2> longest_way{};     ///< in the last substep of even and odd frames
  std::array<uint32_t, 2> left_behind{};  ///< points that a carrier left behind, the same
};

/// Where in the frame a pass runs.
struct PassContext {
  const FrameInput& frame;
  const ClothFrame& cloth;
  const Threads& threads;
  uint32_t substep = 0;
  uint32_t relaxation_steps = 1;
};

// Parts of passes, for whoever goes through a cloth in another order: the result is the same.

/// out_of_cleft() of lib/collide.h, which few points need.
[[nodiscard]] shader::vec3 out_of_cleft(const PassContext& context, const shader::vec3& start,
                                        const shader::vec3& position);
void normal_pixels(ClothState& state, uint32_t first, uint32_t last);
/// Where the pins pass puts a pin that is at `position`; a held one from wherever it was before.
[[nodiscard]] inline shader::vec3 pinned_position(const PassContext& context, const shader::PinTarget& pin,
                                                  const shader::vec3& position, const shader::vec3& previous) {
  const shader::Substep& step = context.frame.substeps[context.substep];
  return shader::pinned_position(pin, step.pin_fraction, step.frame_fraction, step.substep_share, position, previous);
}

/// Pixels of the corners of a triangle between pixels.
struct CellTriangle {
  uint32_t a, b, c;
  bool is_cloth;  ///< of the four corners of a cell three make a triangle in any case
};
/// @param pixel  the cell's first corner
[[nodiscard]] inline CellTriangle triangle_of_cell(const ClothState& state, uint32_t pixel, bool is_first) {
  const uint32_t p1 = pixel + 1, p2 = pixel + state.data.width, p3 = p2 + 1;
  const uint32_t bits = state.data.cell[pixel];
  const bool left = (bits & shader::kCellDiagonalLeftBit) != 0;
  if (is_first) return {pixel, p2, left ? p1 : p3, (bits & shader::kCellFirstBit) != 0};
  return {left ? p1 : pixel, left ? p2 : p3, left ? p3 : p1, (bits & shader::kCellSecondBit) != 0};
}
/// Moves a triangle's corner, as its contact with colliders wants.
inline void move_corner(const shader::ClothParams& params, ClothState& state, uint32_t pixel, const shader::vec3& to,
                        const shader::vec3& start) {
  const shader::vec3 way = to - state.position.at(pixel);
  state.set_yield(pixel, shader::lessened_yield(state.yield[pixel], way, params.spacing));
  state.position.set(pixel, to);
  state.previous.set(pixel, start);
}

/// Runs one entry of a schedule over one cloth, but for those of collision between cloth, which SelfRunner runs.
void run_pass(const PassStep& step, const PassContext& context, ClothState& state, Measures& measures);

}  // namespace geocloth::cpu
