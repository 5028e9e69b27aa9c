// SPDX-License-Identifier: Apache-2.0
// Line relaxation in vectors.

#include "cpu/line_stream.h"

#include <algorithm>

#include "lib/lines.h"

namespace geocloth::cpu {
namespace {

size_t pixel_of_line(const RowSource& source, uint32_t group, uint32_t line, uint32_t k) {
  return group == 0 ? size_t{line} * source.width + k : size_t{k} * source.width + line;
}

/// A spring begins or ends there.
bool is_in_line(const RowSource& source, uint32_t group, uint32_t line, uint32_t k) {
  const std::vector<float>& rest = source.state.rest[group];
  return rest[pixel_of_line(source, group, line, k)] > 0 ||
         (k > 0 && rest[pixel_of_line(source, group, line, k - 1)] > 0);
}

void add_line_points(const RowSource& source, LineStream& stream, uint32_t group, uint32_t line, uint32_t count,
                     uint32_t k) {
  const size_t place = stream.constants.size();
  stream.constants.resize(place + size_t{kLineFloats} * source.lanes, 0.F);
  for (uint32_t lane = 0; lane < count; ++lane) {
    if (!is_in_line(source, group, line + lane, k)) continue;
    const size_t pixel = pixel_of_line(source, group, line + lane, k);
    stream.constants[place + lane] =
        shader::line_weight(source.state.inverse_mass[pixel], source.state.data.cell[pixel]);
    const float rest = source.state.rest[group][pixel], longest = rest * source.cloth.params.stretch_limit;
    stream.constants[place + source.lanes + lane] = rest > 0 ? longest * longest : 0.F;
    stream.constants[place + size_t{2} * source.lanes + lane] = source.state.inverse_mass[pixel] > 0 ? 1.F : 0.F;
  }
}

}  // namespace

LineStream line_stream(const RowSource& source, uint32_t group) {
  LineStream stream;
  stream.diagonal = shader::line_diagonal(source.cloth.params.inverse_dt2);
  const bool along = group == 0;
  const uint32_t lines = along ? source.height : source.width, length = along ? source.width : source.height;
  const uint32_t at_once = along ? kTurned : 1;
  for (uint32_t line = 0; line < lines; line += source.lanes) {
    const uint32_t count = std::min(source.lanes, lines - line);
    bool goes_on = false;
    for (uint32_t k = 0; k < length; k += at_once) {
      bool any = false;
      for (uint32_t n = 0; n < at_once * count; ++n)
        any = any || is_in_line(source, group, line + n % count, k + n / count);
      if (any && !goes_on) {
        const uint32_t first = along ? line * source.width + k : k * source.width + line;
        stream.blocks.push_back({first, 0, count, stream.constants.size()});
      }
      goes_on = any;
      if (!any) continue;
      stream.blocks.back().points += at_once;
      stream.most_points = std::max(stream.most_points, stream.blocks.back().points);
      for (uint32_t i = k; i < k + at_once; ++i) add_line_points(source, stream, group, line, count, i);
    }
  }
  // Two blocks are gone through at a time, and what one has more than the other goes alone.
  std::stable_sort(stream.blocks.begin(), stream.blocks.end(),
                   [](const LineBlock& a, const LineBlock& b) { return a.points > b.points; });
  return stream;
}

}  // namespace geocloth::cpu
