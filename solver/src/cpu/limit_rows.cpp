// SPDX-License-Identifier: Apache-2.0
// Attachments in vectors.

#include "cpu/limit_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace geocloth::cpu {
namespace {

void find_neighbouring_anchors(const RowSource& source, RowStream& stream) {
  for (size_t y = 0; y < source.height; ++y) {
    bool beside = true;
    for (size_t n = size_t{stream.row_first[y]} * source.lanes; n < size_t{stream.row_first[y + 1]} * source.lanes;
         ++n) {
      const bool held = std::isfinite(stream.constants[n]);
      beside = beside && (!held || stream.anchors[n] == static_cast<int32_t>(n % source.lanes));
    }
    stream.beside.push_back(beside ? 1 : 0);
  }
}

/// From which on a vector's anchors are chosen: the one that is the first lane's if all lie beside each other, else
/// the smallest one; below 0: there are none.
int32_t first_of_anchors(const std::vector<int32_t>& anchors) {
  int32_t smallest = -1, first = -1;
  bool beside = true;
  for (size_t lane = 0; lane < anchors.size(); ++lane) {
    if (anchors[lane] < 0) continue;
    const int32_t own = anchors[lane] - static_cast<int32_t>(lane);
    if (smallest < 0) first = own;
    smallest = smallest < 0 ? anchors[lane] : std::min(smallest, anchors[lane]);
    beside = beside && own == first;
  }
  return beside && first >= 0 ? first : smallest;
}

/// Lays out one block for each range of anchors that its lanes need, and takes them out of the list.
void add_limits(const RowSource& source, RowStream& stream, uint32_t pixel, std::vector<int32_t>& anchors) {
  for (;;) {
    const int32_t first = first_of_anchors(anchors);
    if (first < 0) return;
    stream.pixel.push_back(pixel);
    stream.first_anchor.push_back(static_cast<uint32_t>(first));
    for (uint32_t lane = 0; lane < source.lanes; ++lane) {
      const bool taken = anchors[lane] >= 0 && anchors[lane] - first < static_cast<int32_t>(source.lanes);
      stream.constants.push_back(taken
                                     ? source.state.attachments[pixel + lane].reach * source.cloth.params.stretch_limit
                                     : std::numeric_limits<float>::infinity());
      stream.anchors.push_back(taken ? anchors[lane] - first : 0);
      if (taken) anchors[lane] = -1;
    }
  }
}

}  // namespace

std::vector<uint32_t> order_anchors(const RowSource& source) {
  const auto column_first = [&](uint32_t k) {
    const uint32_t pixel = source.cloth.pins[k].pixel.x;
    return std::pair(pixel % source.width, pixel);
  };
  std::vector<uint32_t> pins(source.cloth.pins.size());
  std::iota(pins.begin(), pins.end(), 0U);
  std::sort(pins.begin(), pins.end(), [&](uint32_t a, uint32_t b) { return column_first(a) < column_first(b); });
  std::vector<uint32_t> anchor_of_pin(pins.size());
  for (uint32_t n = 0; n < pins.size(); ++n) anchor_of_pin[pins[n]] = n;
  return anchor_of_pin;
}

SweepOp limit_rows(const RowSource& source, const std::vector<uint32_t>& anchor_of_pin, RowStream& stream) {
  std::vector<int32_t> anchor_at(source.state.pixel_count(), -1);
  for (size_t k = 0; k < source.cloth.pins.size(); ++k) {
    const uint32_t pixel = source.cloth.pins[k].pixel.x;
    if (source.state.inverse_mass[pixel] > 0) continue;  // drawn along softly: nobody's anchor
    anchor_at[pixel] = static_cast<int32_t>(anchor_of_pin[k]);
  }
  const auto anchor_of = [&](size_t i) {
    const uint32_t anchor = source.state.attachments[i].anchor;
    return anchor == shader::kNoAnchor || source.state.inverse_mass[i] == 0 ? -1 : anchor_at[anchor];
  };
  const BlockShape shape = vectors(RowKernel::limit, source.lanes, source.width);
  std::vector<int32_t> anchors(source.lanes, -1);  // of the block that is laid out
  for (uint32_t y = 0; y < source.height; ++y) {
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    uint32_t block = 0;
    cover_row(
        source, shape, y, [&](uint32_t x) { return anchor_of(size_t{y} * source.width + x) >= 0; },
        [&](uint32_t first) {
          add_limits(source, stream, block, anchors);
          block = first;
        },
        [&](uint32_t lane, uint32_t x) { anchors[lane] = anchor_of(size_t{y} * source.width + x); });
    add_limits(source, stream, block, anchors);
  }
  stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
  find_neighbouring_anchors(source, stream);
  return SweepOp{.kernel = RowKernel::limit, .stream = &stream};
}

}  // namespace geocloth::cpu
