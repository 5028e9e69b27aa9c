// SPDX-License-Identifier: Apache-2.0
// Pins in vectors. What they are told changes from frame to frame, which pixels they have seldom does.

#include "cpu/pin_rows.h"

#include <array>

namespace geocloth::cpu {
namespace {

std::array<float, kPinFloats> floats_of(const shader::PinTarget& pin) {
  return {pin.target.x,       pin.target.y,       pin.target.z,       pin.target.w, pin.start.x,  pin.start.y,
          pin.start.z,        pin.start.w,        pin.behind.x,       pin.behind.y, pin.behind.z, pin.behind.w,
          pin.behind_start.x, pin.behind_start.y, pin.behind_start.z, pin.limit.x,  pin.bow.x,    pin.bow.y,
          pin.bow.z,          pin.bow.w,          pin.lean.x,         pin.lean.y,   pin.lean.z};
}

}  // namespace

std::vector<Run> pin_blocks(std::span<const shader::PinTarget> pins, uint32_t width, uint32_t lanes) {
  std::vector<Run> blocks;
  for (const shader::PinTarget& pin : pins) {
    const uint32_t i = pin.pixel.x;
    const bool goes_on =
        !blocks.empty() && blocks.back().last == i && i % width != 0 && i - blocks.back().first < lanes;
    if (!goes_on) blocks.push_back({i, i});
    blocks.back().last = i + 1;
  }
  return blocks;
}

void lay_out_pins(std::span<const shader::PinTarget> pins, std::span<const Run> blocks, uint32_t lanes,
                  Floats& floats) {
  floats.assign(blocks.size() * kPinFloats * lanes, 0.F);
  const shader::PinTarget* pin = pins.data();
  for (size_t k = 0; k < blocks.size(); ++k) {
    float* const block = &floats[k * kPinFloats * lanes];
    for (uint32_t lane = 0; lane < blocks[k].last - blocks[k].first; ++lane) {
      const std::array<float, kPinFloats> all = floats_of(*pin++);
      for (uint32_t n = 0; n < kPinFloats; ++n) block[n * lanes + lane] = all[n];
    }
  }
}

}  // namespace geocloth::cpu
