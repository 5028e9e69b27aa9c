// SPDX-License-Identifier: Apache-2.0
// What the constants of a sweep's passes are laid out from, and how blocks of them lie over the rows of the image.
#pragma once

#include <cstdint>

#include "cpu/sweep.h"

namespace geocloth::cpu {

/// A cloth as its passes are laid out.
struct RowSource {
  const ClothState& state;
  const ClothFrame& cloth;
  uint32_t lanes;  ///< of a vector
  uint32_t width, height;
  bool several;     ///< relaxation steps: constants hold compliances, too
  uint32_t strip;   ///< rows that a pass works on at once
  bool on_offsets;  ///< constraints are, see lib/fine.h

  /// [s^2/kg] of the component's constraint that starts at a pixel.
  [[nodiscard]] float scaled_compliance(uint32_t component, size_t pixel) const;
};

/// How the lanes of a block lie in the image. The last one of a row may reach over its end.
struct BlockShape {
  RowKernel kernel;
  uint32_t span;           ///< columns that a block reads and writes
  uint32_t period, phase;  ///< its first column is `phase` modulo `period`
  uint32_t end;            ///< columns before this one may have constraints' first ends
};

/// Vectors of neighbouring columns. They lie within cache lines: that is worth more than the lanes that it leaves idle.
[[nodiscard]] inline BlockShape vectors(RowKernel kernel, uint32_t lanes, uint32_t end) {
  return {kernel, lanes, lanes, 0, end};
}

/// Lane of the constraint that starts `column` columns after its block, or the first half of it; see even_columns() in
/// constraints_inl.h.
[[nodiscard]] uint32_t lane_of(RowKernel kernel, uint32_t column);
/// By so much larger it is in the second half.
inline constexpr uint32_t kSecondHalf = 2;

/// Appends a block whose constants are 0: without a constraint.
void add_block(RowStream& stream, uint32_t first, uint32_t constants, uint32_t lanes);
/// The same of what only pulls: endless longest lengths, which are never reached, and inverses.
void add_pull_block(RowStream& stream, uint32_t first, uint32_t lanes);

/// Lays blocks over the constraints of a row, each where the first one is that is not covered yet. They do not overlap:
/// what a block has just written and the next one reads in other pieces keeps the processor waiting.
/// @param has   has(x): a constraint starts in the column
/// @param add   add(pixel) begins a block
/// @param fill  fill(lane, x) writes a lane's constants
template <class Has, class Add, class Fill>
void cover_row(const RowSource& source, const BlockShape& shape, uint32_t y, const Has& has, const Add& add,
               const Fill& fill) {
  for (uint32_t x = shape.phase; x < shape.end;) {
    if (!has(x)) {
      ++x;
      continue;
    }
    const uint32_t start = x - (x - shape.phase) % shape.period;
    add(y * source.width + start);
    uint32_t covered = x;
    for (; covered < start + shape.span; ++covered) {
      if (covered < shape.end && has(covered)) fill(lane_of(shape.kernel, covered - start), covered);
    }
    x = covered;
  }
}

}  // namespace geocloth::cpu
