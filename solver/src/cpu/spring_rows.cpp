// SPDX-License-Identifier: Apache-2.0
// Structural, diagonal and bending springs in vectors, and those that only pull: ties and spans.

#include "cpu/spring_rows.h"

#include <algorithm>

#include "cpu/row_source.h"
#include "cpu/spans.h"
#include "cpu/springs.h"
#include "lib/spring_groups.h"

namespace geocloth::cpu {
namespace {

bool group_has_line(uint32_t group, uint32_t line) {
  const uint32_t odd = group % 2;
  return (group < 8 ? line % 2 : line / 2 % 2) == odd;
}

/// 1 / (w + compliance), as spring.h has it; 0 where the spring does not exist or cannot move.
float spring_inverse(const RowSource& source, uint32_t component, size_t a, uint32_t offset, bool compliant) {
  if (!(source.state.rest[component][a] > 0)) return 0;
  const float w = source.state.inverse_mass[a] + source.state.inverse_mass[a + offset];
  if (!(w > 0)) return 0;
  return 1.F / (compliant ? w + source.scaled_compliance(component, a) : w);
}

/// Springs along rows come in halves of a block. One that is left over at a row's end takes one of the next row with
/// it: rows seldom are as long as so many blocks.
class HalfBlocks {
 public:
  /// A half that begins at a pixel becomes the second one of the last block, if that has none yet.
  [[nodiscard]] bool take_second(RowStream& stream, uint32_t y, uint32_t first) {
    second_ = open_ && y <= row_ + 1;
    open_ = false;
    if (second_) stream.second.back() = first;
    return second_;
  }
  /// A block has been added.
  /// @param unused  where its second half lies as long as it has no springs: after the first one, where no other is
  void begin(RowStream& stream, uint32_t y, uint32_t unused) {
    stream.second.push_back(unused);
    row_ = y;
    open_ = true;
  }
  /// Whether the half that was begun last is the second one of its block.
  [[nodiscard]] bool is_second() const { return second_; }

 private:
  uint32_t row_ = 0;
  bool open_ = false, second_ = false;
};

SweepOp lay_out_springs(const RowSource& source, uint32_t group, bool tie, float tie_share, RowStream& stream) {
  const uint32_t component = shader::group_component(group), odd = group % 2;
  const bool along = shader::group_by_column(group) == 1;
  const RowKernel kernel = !along           ? RowKernel::springs_across
                           : component == 0 ? RowKernel::springs_along
                                            : RowKernel::springs_along_two;
  const shader::uvec2 end = shader::spring_end(component, 1, 0);
  const uint32_t offset = end.y * source.width + end.x - 1;
  BlockShape shape = vectors(kernel, source.lanes, source.width);
  if (component == 0) shape = {kernel, source.lanes, 2, odd, source.width};
  if (component == 4) shape = {kernel, source.lanes, 4, 2 * odd, source.width};
  const bool several = source.several && !tie;
  const uint32_t constants = several ? 3 : 2;
  HalfBlocks halves;
  const auto in_row = [&](uint32_t y) { return along || group_has_line(group, y); };
  const auto in_column = [&](uint32_t x) { return !along || group_has_line(group, x); };
  for (uint32_t y = 0; y < source.height; ++y) {
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    if (!in_row(y)) continue;
    const auto inverse_of = [&](uint32_t x) {
      return in_column(x) ? tie_share * spring_inverse(source, component, y * source.width + x, offset, !tie) : 0.F;
    };
    cover_row(
        source, shape, y, [&](uint32_t x) { return inverse_of(x) > 0; },
        [&](uint32_t first) {
          if (along && halves.take_second(stream, y, first)) return;
          if (tie) {
            add_pull_block(stream, first, source.lanes);
          } else {
            add_block(stream, first, constants, source.lanes);
          }
          if (along) halves.begin(stream, y, first + source.lanes);
        },
        [&](uint32_t lane_of_half, uint32_t x) {
          const uint32_t lane = lane_of_half + (halves.is_second() ? kSecondHalf : 0);
          float* block = &stream.constants[stream.constants.size() - size_t{constants} * source.lanes];
          block[lane] =
              source.state.rest[component][y * source.width + x] * (tie ? source.cloth.params.stretch_limit : 1.F);
          block[source.lanes + lane] = inverse_of(x);
          if (several) block[2 * source.lanes + lane] = source.scaled_compliance(component, y * source.width + x);
        });
  }
  stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
  return {.kernel = kernel, .offset = offset, .share = share_of(source.cloth.params, component), .stream = &stream};
}

}  // namespace

SweepOp spring_rows(const RowSource& source, uint32_t group, RowStream& stream) {
  return lay_out_springs(source, group, false, 1, stream);
}

SweepOp tie_rows(const RowSource& source, uint32_t group, bool last, RowStream& stream) {
  SweepOp op = lay_out_springs(source, group, true, last ? shader::kTieShare : 1, stream);
  op.kernel = op.kernel == RowKernel::springs_along ? RowKernel::ties_along : RowKernel::ties_across;
  op.share = 1;
  return op;
}

SweepOp span_rows(const RowSource& source, uint32_t group, RowStream& stream) {
  const uint32_t component = shader::span_component(group);
  const bool along = component == 0;
  const uint32_t pixels = shader::pixels_of_span(group);
  const RowKernel kernel = !along                          ? RowKernel::ties_across
                           : pixels == shader::kSpanPixels ? RowKernel::spans_along
                                                           : RowKernel::short_spans_along;
  const uint32_t lanes = along ? std::min(source.lanes, pixels) : source.lanes;
  const uint32_t offset = pixels * (along ? 1 : source.width);
  const BlockShape shape = vectors(kernel, lanes, source.width - (along ? pixels : 0));
  for (uint32_t y = 0; y < source.height; ++y) {
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    if (!along && y + pixels >= source.height) continue;
    const auto length_of = [&](uint32_t x) {
      const size_t a = size_t{y} * source.width + x;
      const bool moves = source.state.inverse_mass[a] + source.state.inverse_mass[a + offset] > 0;
      return shader::span_starts(group, x, y) && moves ? span_length(source.state, group, a) : 0.F;
    };
    cover_row(
        source, shape, y, [&](uint32_t x) { return length_of(x) > 0; },
        [&](uint32_t first) { add_pull_block(stream, first, lanes); },
        [&](uint32_t lane, uint32_t x) {
          const size_t a = size_t{y} * source.width + x;
          float* block = &stream.constants[stream.constants.size() - 2 * size_t{lanes}];
          block[lane] = length_of(x) * source.cloth.params.stretch_limit;
          block[lanes + lane] = shader::span_share(group) *
                                (1.F / (source.state.inverse_mass[a] + source.state.inverse_mass[a + offset]));
        });
  }
  stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
  return {.kernel = kernel, .offset = offset, .stream = &stream};
}

}  // namespace geocloth::cpu
