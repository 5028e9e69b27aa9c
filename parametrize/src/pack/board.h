// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pack/pack.h"

namespace geocloth {

/// A shape in blocks, with the gap below and to the right of every pixel: two shapes so grown are disjoint exactly when
/// no two of their pixels are 8-neighbours.
struct Grown {
  struct Run {
    uint32_t row, first, last;  // columns first..last
    uint32_t level;             // of the longest windows (Board) that are no longer than the run

    friend bool operator==(const Run&, const Run&) = default;
  };
  uint32_t width = 0, height = 0;
  std::vector<Run> run;  // one or more per row, disjoint, the widest first: they exclude most columns
};

/// @param block  [pixels] side of a block
[[nodiscard]] Grown grown(const ChartShape& shape, uint32_t block);

/// The blocks taken, for columns 0..width-1 and as many rows as needed.
class Board {
 public:
  /// Everything is free.
  /// @param levels  more than any run's of the shapes
  void reset(uint32_t width, uint32_t levels);

  /// The first row, from one on up to another, and the first column in it, where the shape fits: as column and row.
  /// @param work  grows by the words looked at
  [[nodiscard]] std::optional<std::array<uint32_t, 2>> find(const Grown& shape, uint32_t first_row, uint32_t last_row,
                                                            uint64_t& work) const;

  /// @param levels  more than that of any run of the shapes that are looked for from now on
  void take(const Grown& shape, const std::array<uint32_t, 2>& corner, uint32_t levels);

 private:
  /// Of a row at one level [words]: zeros follow its bits, so that whatever is shifted in from beyond its end is free.
  [[nodiscard]] size_t stride() const { return 2 * size_t{words_}; }
  /// Bit x of a level: one of the 2^level columns from x on is taken.
  [[nodiscard]] uint64_t* window(uint32_t row, uint32_t level) {
    return &window_[(size_t{row} * levels_ + level) * stride()];
  }
  void widen(uint32_t row, uint32_t level);
  template <uint32_t kWords>
  void widen_among(uint32_t row, uint32_t levels);

  uint32_t width_ = 0, words_ = 0, levels_ = 1;
  uint32_t rows_ = 0;
  std::vector<uint64_t> window_;  // of rows_ rows, and more that were taken before
};

}  // namespace geocloth
