// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "cpu/cloth_state.h"
#include "cpu/sweep.h"

namespace geocloth::cpu {

/// Floats of a pin among those of a block, each for all lanes; x, y and z follow each other. As in shader::PinTarget.
enum PinFloat : uint32_t {
  kPinTarget = 0,
  kPinSoft = 3,
  kPinStart = 4,
  kPinBraked = 7,
  kPinBehind = 8,
  kPinRadius = 11,
  kPinBehindStart = 12,
  kPinLimit = 15,
  kPinBow = 16,
  kPinBows = 19,
  kPinLean = 20,
  kPinFloats = 23
};

/// Blocks of pins whose pixels lie beside each other in a row, as many as a vector has lanes or fewer.
/// @param pins  ascending by pixel
[[nodiscard]] std::vector<Run> pin_blocks(std::span<const shader::PinTarget> pins, uint32_t width, uint32_t lanes);

/// What a frame says of the pins: for each block kPinFloats for each lane, 0 in those that have no pin.
void lay_out_pins(std::span<const shader::PinTarget> pins, std::span<const Run> blocks, uint32_t lanes, Floats& floats);

}  // namespace geocloth::cpu
