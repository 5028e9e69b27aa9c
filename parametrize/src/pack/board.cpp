// SPDX-License-Identifier: GPL-3.0-or-later
// A shape is tried at all columns of a row at once: the columns that one of its runs forbids are a window over the bits
// taken, and windows whose length is a power of two are kept per row. Rows are looked at in vectors, for every
// instruction set that Highway knows; the best one is chosen when the program runs.
#include "pack/board.h"

#include <algorithm>
#include <bit>

#include "vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pack/board.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef GEOCLOTH_BOARD_ONCE
#define GEOCLOTH_BOARD_ONCE
namespace geocloth {

constexpr uint32_t kMostLanes = 4;

/// A shape and the rows of a board among which it is to find its place.
struct BoardSearch {
  const Grown& shape;
  const uint64_t* window;        // of row 0 at level 0, with kMostLanes words behind the last one
  size_t row_stride, stride;     // [words] from row to row, and from level to level
  uint32_t width, words, rows;   // of the board
  uint32_t first_row, last_row;  // for the shape's corner
};

/// The row and the first free column in it; kNone where there is none.
struct BoardPlace {
  uint32_t column, row;
};

/// Ones where the shape would stand out.
inline uint64_t beyond(const BoardSearch& s, uint32_t word) {
  const uint32_t last = s.width - s.shape.width, first = 64 * word;
  const uint32_t free = last + 1 > first ? std::min(last + 1 - first, 64U) : 0;
  return free == 64 ? 0 : ~uint64_t{0} << free;
}

}  // namespace geocloth
#endif

HWY_BEFORE_NAMESPACE();
namespace geocloth::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<uint64_t, kMostLanes>;
using V = hn::Vec<D>;
constexpr uint32_t kLanes = hn::MaxLanes(D());

/// Bits `by` .. of a row, a vector of them.
HWY_INLINE V shifted(const uint64_t* row, uint32_t by) {
  const uint64_t* word = row + by / 64;
  const int bits = static_cast<int>(by % 64);
  const V low = hn::ShiftRightSame(hn::LoadU(D(), word), bits);
  const V high = hn::ShiftLeftSame(hn::ShiftLeft<1>(hn::LoadU(D(), word + 1)), 63 - bits);
  return hn::Or(low, high);
}

/// @tparam kVectors  that hold the board's words
template <uint32_t kVectors>
HWY_INLINE BoardPlace find_among(const BoardSearch& s, uint64_t& work) {
  constexpr uint32_t kHeld = kVectors * kLanes;
  alignas(64) uint64_t word[kHeld];
  for (uint32_t k = 0; k < kHeld; ++k) word[k] = k < s.words ? beyond(s, k) : ~uint64_t{0};
  V forbidden[kVectors];
  for (uint32_t i = 0; i < kVectors; ++i) forbidden[i] = hn::Load(D(), word + i * kLanes);
  const V full = hn::Set(D(), ~uint64_t{0});
  for (uint32_t y = s.first_row; y <= s.last_row; ++y) {
    V blocked[kVectors];
    for (uint32_t i = 0; i < kVectors; ++i) blocked[i] = forbidden[i];
    bool is_full = false;
    for (const Grown::Run& run : s.shape.run) {
      if (y + run.row >= s.rows) continue;
      const uint64_t* taken = s.window + (y + run.row) * s.row_stride + run.level * s.stride;
      const uint32_t second = run.last + 1 - (1U << run.level);
      V all = full;
      for (uint32_t i = 0; i < kVectors; ++i) {
        const V by_run = hn::Or(shifted(taken + i * kLanes, run.first), shifted(taken + i * kLanes, second));
        blocked[i] = hn::Or(blocked[i], by_run);
        all = hn::And(all, blocked[i]);
      }
      work += s.words;
      is_full = hn::AllTrue(D(), hn::Eq(all, full));
      if (is_full) break;
    }
    if (is_full) continue;
    for (uint32_t i = 0; i < kVectors; ++i) hn::Store(blocked[i], D(), word + i * kLanes);
    for (uint32_t k = 0; k < kHeld; ++k) {
      if (~word[k] != 0) return {64 * k + static_cast<uint32_t>(std::countr_one(word[k])), y};
    }
  }
  return {kNone, kNone};
}

BoardPlace find_among_few(const BoardSearch& s, uint64_t& work) {
  constexpr uint32_t kMost = (kMostLanes + kLanes - 1) / kLanes;
  switch ((s.words + kLanes - 1) / kLanes) {
    case 1:
      return find_among<1>(s, work);
    case 2:
      return find_among<std::min(2U, kMost)>(s, work);
    case 3:
      return find_among<std::min(3U, kMost)>(s, work);
    default:
      return find_among<kMost>(s, work);
  }
}

}  // namespace geocloth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth {
namespace {

HWY_EXPORT(find_among_few);

/// Bits `by` .. `by` + 63 of a row.
uint64_t shifted(const uint64_t* row, uint32_t by) {
  const uint64_t *word = row + by / 64, bits = by % 64;
  return word[0] >> bits | word[1] << 1 << (63 - bits);
}

BoardPlace find_among_many(const BoardSearch& s, uint64_t& work) {
  std::vector<uint64_t> forbidden(s.words), blocked(s.words);
  for (uint32_t k = 0; k < s.words; ++k) forbidden[k] = beyond(s, k);
  for (uint32_t y = s.first_row; y <= s.last_row; ++y) {
    blocked = forbidden;
    uint64_t all = 0;
    for (const Grown::Run& run : s.shape.run) {
      if (y + run.row >= s.rows) continue;
      const uint64_t* taken = s.window + (y + run.row) * s.row_stride + run.level * s.stride;
      const uint32_t second = run.last + 1 - (1U << run.level);
      all = ~uint64_t{0};
      for (uint32_t k = 0; k < s.words; ++k) {
        all &= blocked[k] |= shifted(taken + k, run.first) | shifted(taken + k, second);
      }
      work += s.words;
      if (~all == 0) break;
    }
    if (~all == 0) continue;
    for (uint32_t k = 0; k < s.words; ++k) {
      if (~blocked[k] != 0) return {64 * k + static_cast<uint32_t>(std::countr_one(blocked[k])), y};
    }
  }
  return {kNone, kNone};
}

}  // namespace

Grown grown(const ChartShape& shape, uint32_t block) {
  Grown result;
  result.width = shape.width / block + 1;
  result.height = shape.height / block + 1;
  std::vector<std::vector<std::array<uint32_t, 2>>> row(result.height);
  for (const ChartShape::Run& r : shape.run) {
    for (uint32_t y = r.row / block; y <= (r.row + 1) / block; ++y) {
      row[y].push_back({r.first / block, (r.last + 1) / block});
    }
  }
  for (uint32_t y = 0; y < result.height; ++y) {
    std::sort(row[y].begin(), row[y].end());
    const size_t first_of_row = result.run.size();
    for (const auto& [first, last] : row[y]) {
      if (result.run.size() > first_of_row && first <= result.run.back().last + 1) {
        result.run.back().last = std::max(result.run.back().last, last);
      } else {
        result.run.push_back({y, first, last, 0});
      }
    }
  }
  for (Grown::Run& r : result.run) r.level = static_cast<uint32_t>(std::bit_width(r.last - r.first + 1)) - 1;
  std::stable_sort(result.run.begin(), result.run.end(),
                   [](const auto& a, const auto& b) { return a.last - a.first > b.last - b.first; });
  return result;
}

void Board::reset(uint32_t width, uint32_t levels) {
  width_ = width;
  words_ = (width + 63) / 64;
  levels_ = levels;
  rows_ = 0;
}

std::optional<std::array<uint32_t, 2>> Board::find(const Grown& shape, uint32_t first_row, uint32_t last_row,
                                                   uint64_t& work) const {
  const BoardSearch search{shape,  window_.data(), levels_ * stride(), stride(), width_,
                           words_, rows_,          first_row,          last_row};
  const BoardPlace found =
      words_ <= kMostLanes ? HWY_DYNAMIC_DISPATCH(find_among_few)(search, work) : find_among_many(search, work);
  if (found.row == kNone) return std::nullopt;
  return std::array{found.column, found.row};
}

void Board::take(const Grown& shape, const std::array<uint32_t, 2>& corner, uint32_t levels) {
  const uint32_t rows = std::max(rows_, corner[1] + shape.height);
  const size_t row_stride = levels_ * stride();
  if (window_.size() < rows * row_stride + kMostLanes + 1) window_.resize(2 * rows * row_stride + kMostLanes + 1);
  std::fill(window_.begin() + static_cast<std::ptrdiff_t>(rows_ * row_stride),
            window_.begin() + static_cast<std::ptrdiff_t>(rows * row_stride), uint64_t{0});
  rows_ = rows;
  for (const Grown::Run& r : shape.run) {
    uint64_t* taken = window(corner[1] + r.row, 0);
    const uint32_t first = corner[0] + r.first, last = corner[0] + r.last;
    for (uint32_t k = first / 64; k <= last / 64; ++k) {
      const uint32_t from = k == first / 64 ? first % 64 : 0, to = k == last / 64 ? last % 64 : 63;
      taken[k] |= (~uint64_t{0} >> (63 - (to - from))) << from;
    }
  }
  for (uint32_t y = corner[1]; y < corner[1] + shape.height; ++y) {
    switch (words_) {
      case 1:
        widen_among<1>(y, levels);
        break;
      case 2:
        widen_among<2>(y, levels);
        break;
      case 3:
        widen_among<3>(y, levels);
        break;
      case 4:
        widen_among<4>(y, levels);
        break;
      default:
        for (uint32_t level = 1; level < levels; ++level) widen(y, level);
    }
  }
}

void Board::widen(uint32_t row, uint32_t level) {
  const uint64_t* half = window(row, level - 1);
  uint64_t* whole = window(row, level);
  for (uint32_t k = 0; k < words_; ++k) whole[k] = half[k] | shifted(half + k, 1U << (level - 1));
}

/// Fills in the levels of a row. What is stored is not read again at once: words that straddle two stored ones would
/// have to wait for both.
template <uint32_t kWords>
void Board::widen_among(uint32_t row, uint32_t levels) {
  std::array<uint64_t, kWords + 1> half{};
  std::copy_n(window(row, 0), kWords, half.begin());
  const uint32_t within_words = std::min(levels, 7U);
  for (uint32_t level = 1; level < within_words; ++level) {
    const uint32_t by = 1U << (level - 1);
    uint64_t* whole = window(row, level);
    for (uint32_t k = 0; k < kWords; ++k) whole[k] = half[k] |= half[k] >> by | half[k + 1] << (64 - by);
  }
  for (uint32_t level = within_words; level < levels; ++level) widen(row, level);
}

}  // namespace geocloth
#endif
