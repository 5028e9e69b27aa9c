// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "backend.h"

namespace geocloth::cpu {

/// The cpu's images have rows that begin at cache lines: columns without cloth follow on the right. So vectors of a row
/// lie within lines, which makes them a tenth to a quarter faster. At least two columns follow: threes of columns from
/// the first one on then hold all cloth. Only the backend knows; whoever uses it counts
/// pixels as the asset does.
class WideRows {
 public:
  explicit WideRows(uint32_t width);

  /// The same cloth in a wide image.
  [[nodiscard]] ClothData widened(const ClothData& data) const;
  /// Fills `wide`, whose memory is used again; lists of pixels only when the pins have changed.
  void widen(const ClothFrame& frame, ClothFrame& wide) const;

  [[nodiscard]] uint32_t pixel(uint32_t narrow) const { return narrow / width_ * wide_ + narrow % width_; }

 private:
  template <class T>
  void widen(std::span<const T> from, const T& nothing, std::vector<T>& to) const;

  uint32_t width_, wide_;
};

}  // namespace geocloth::cpu
