// SPDX-License-Identifier: Apache-2.0
// Bends over three pixels in vectors.

#include "cpu/bend_rows.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "lib/bend.h"
#include "lib/bend_groups.h"

namespace geocloth::cpu {
namespace {

struct BendConstants {
  float rest = 0, inverse = 0, chord = 0, compliance = 0;
};

/// The weights as bend.h has them, for a middle point that carries all of its mass.
/// @param times  of the compliance
BendConstants bend_constants(const RowSource& source, uint32_t component, size_t a, uint32_t offset, uint32_t times) {
  const float unclamped = source.scaled_compliance(component, a) * static_cast<float>(times);
  if (!(unclamped > 0)) return {};
  const std::vector<float>& along = source.state.rest[component - 4];
  const float chord = shader::chord_share(along[a], along[a + offset]);
  const float wa = source.state.inverse_mass[a], wm = source.state.inverse_mass[a + offset];
  const float wb = source.state.inverse_mass[a + 2 * size_t{offset}];
  const float compliance = unclamped * shader::clamped_share(wa, wm, wb, chord);
  return {source.state.rest[component][a], 1.F / (shader::bend_weight(wa, wm, wb, chord) + compliance), chord,
          compliance};
}

/// @param constants_of  of the bend that starts in a column, or with the inverse 0
template <class ConstantsOf>
void cover_bends(const RowSource& source, RowStream& stream, const BlockShape& shape, uint32_t y,
                 const ConstantsOf& constants_of) {
  cover_row(
      source, shape, y, [&](uint32_t x) { return constants_of(x).inverse > 0; },
      [&](uint32_t first) { add_block(stream, first, source.several ? 4 : 3, source.lanes); },
      [&](uint32_t lane, uint32_t x) {
        const BendConstants c = constants_of(x);
        float* block = &stream.constants[stream.constants.size() - size_t{source.several ? 4U : 3U} * source.lanes];
        block[lane] = c.rest;
        block[source.lanes + lane] = c.inverse;
        block[2 * source.lanes + lane] = c.chord;
        if (source.several) block[3 * source.lanes + lane] = c.compliance;
      });
}

/// Of each row the vectors of thirds that bends reach.
class ReachedThirds {
 public:
  ReachedThirds(uint32_t lanes, uint32_t thirds, uint32_t height)
      : lanes_(lanes),
        thirds_(thirds),
        height_(height),
        vectors_((thirds + lanes - 1) / lanes),
        reached_(size_t{vectors_} * height) {}

  void add(uint32_t y, uint32_t third) { reached_[size_t{y} * vectors_ + third / lanes_] = true; }
  void lay_out(RowStream& stream) const {
    for (uint32_t y = 0; y < height_; ++y) {
      const auto row = static_cast<uint32_t>(stream.thirds.size());
      stream.third_first.push_back(row);
      for (uint32_t v = 0; v < vectors_; ++v) {
        if (!reached_[size_t{y} * vectors_ + v]) continue;
        const uint32_t first = v * lanes_;
        if (stream.thirds.size() == row || stream.thirds.back().last != first) stream.thirds.push_back({first, first});
        stream.thirds.back().last = std::min(first + lanes_, thirds_);
      }
    }
    stream.third_first.push_back(static_cast<uint32_t>(stream.thirds.size()));
  }

 private:
  uint32_t lanes_, thirds_, height_, vectors_;
  std::vector<bool> reached_;
};

/// Columns of a group are 0 for its first one, 1 for the third one after it, ...
SweepOp bends_along(const RowSource& source, BendOrder order, RowStream& stream) {
  const uint32_t thirds = source.width / 3;  // complete ones; WideRows keeps cloth out of the columns behind
  const BlockShape shape = vectors(RowKernel::bends_along, source.lanes, thirds);
  // A line of the scratch holds the vectors of thirds, and where the last block begins at the next one, one more.
  const uint32_t line = (thirds / source.lanes + 2) * source.lanes;
  ReachedThirds reached(source.lanes, thirds, source.height);
  stream.row_first.assign(source.height + 1, 0);
  for (uint32_t group = 0; group < 3; ++group) {
    const uint32_t times = compliance_times({Pass::curvature, group, 0, order});
    for (uint32_t y = 0; y < source.height; ++y) {
      const size_t before = stream.pixel.size();
      stream.group_first.push_back(static_cast<uint32_t>(before));
      cover_bends(source, stream, shape, 0, [&](uint32_t n) {
        const uint32_t x = 3 * n + group;
        if (x + 2 >= 3 * thirds) return BendConstants{};
        const BendConstants bend = bend_constants(source, 4, y * source.width + x, 1, times);
        if (bend.inverse > 0) {
          reached.add(y, n);
          reached.add(y, (x + 2) / 3);
        }
        return bend;
      });
      const auto blocks = std::span(stream.pixel).subspan(before);
      stream.row_first[y + 1] += static_cast<uint32_t>(blocks.size());
      for (uint32_t& block : blocks) block += third_row(y, source.strip, line, source.on_offsets);
    }
    stream.group_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
  }
  reached.lay_out(stream);
  std::partial_sum(stream.row_first.begin(), stream.row_first.end(), stream.row_first.begin());
  return {.kernel = RowKernel::bends_along, .offset = line, .stream = &stream};
}

}  // namespace

SweepOp bend_rows(const RowSource& source, const PassStep& step, RowStream& stream) {
  const uint32_t group = step.group, times = compliance_times(step);
  if (shader::bend_component(group) == 4) return bends_along(source, step.order, stream);
  const BlockShape shape = vectors(RowKernel::bends_across, source.lanes, source.width);
  for (uint32_t y = 0; y < source.height; ++y) {
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    if (y % 3 == group % 3 && y + 2 < source.height)
      cover_bends(source, stream, shape, y,
                  [&](uint32_t x) { return bend_constants(source, 5, y * source.width + x, source.width, times); });
  }
  stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
  return {.kernel = RowKernel::bends_across, .offset = source.width, .stream = &stream};
}

}  // namespace geocloth::cpu
