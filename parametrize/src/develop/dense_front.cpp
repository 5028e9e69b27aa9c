// SPDX-License-Identifier: GPL-3.0-or-later
// Cholesky's factorisation of small and middle-sized matrices in vectors, for every instruction set that Highway knows;
// the best one is chosen when the program runs. Tiles of 8 rows and 4 columns stay in registers while all columns
// before them are subtracted (Goto, van de Geijn 2008, without their packing, which small matrices do not repay). Every
// entry sees the same operations in the same order whatever the vectors' length: products are not fused with sums.
#include "develop/dense_front.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "develop/dense_front.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef GEOCLOTH_DENSE_FRONT_ONCE
#define GEOCLOTH_DENSE_FRONT_ONCE
namespace geocloth {

constexpr size_t kTileRows = 8, kTileColumns = 4;
constexpr size_t kDepth = 96;              // columns that are subtracted at once
constexpr size_t kRowsAtOnce = 192;        // so many rows of those stay in the cache
constexpr size_t kWorthTasks = 4'000'000;  // products

constexpr size_t rounded_down(size_t n) {
  return n / kTileRows * kTileRows;
}
constexpr size_t rounded_up(size_t n) {
  return rounded_down(n + kTileRows - 1);
}

/// Columns of which products are subtracted from the columns of another matrix.
struct RankUpdate {
  const double* from;  // row 0 of the first of them
  size_t from_stride, depth;
  double* into;  // row 0 of column 0
  size_t into_stride, first, last, rows;
};

}  // namespace geocloth
#endif

HWY_BEFORE_NAMESPACE();
namespace geocloth::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kTileRows>;
constexpr size_t kLanes = hn::MaxLanes(D());
constexpr size_t kVectors = kTileRows / kLanes;  // in a column of a tile

constexpr size_t kTilesAtOnce = kVectors == 1 ? 2 : 1;  // as many as registers hold

/// Rows `row`... and columns `column`... of what is updated, less the products of these rows and rows `column`....
template <size_t kTiles, size_t kColumns>
HWY_INLINE void update_tile(const RankUpdate& u, size_t row, size_t column) {
  constexpr size_t kHigh = kTiles * kVectors;
  const D d;
  const double *a = u.from + row, *b = u.from + column;
  double* c = u.into + column * u.into_stride + row;
  hn::Vec<D> sum[kHigh][kColumns];
  for (size_t j = 0; j < kColumns; ++j) {
    for (size_t i = 0; i < kHigh; ++i) sum[i][j] = hn::LoadU(d, c + j * u.into_stride + i * kLanes);
  }
  for (size_t k = 0; k < u.depth; ++k, a += u.from_stride, b += u.from_stride) {
    hn::Vec<D> left[kHigh];
    for (size_t i = 0; i < kHigh; ++i) left[i] = hn::LoadU(d, a + i * kLanes);
    for (size_t j = 0; j < kColumns; ++j) {
      const auto right = hn::Set(d, b[j]);
      for (size_t i = 0; i < kHigh; ++i) sum[i][j] = hn::Sub(sum[i][j], hn::Mul(left[i], right));
    }
  }
  for (size_t j = 0; j < kColumns; ++j) {
    for (size_t i = 0; i < kHigh; ++i) hn::StoreU(sum[i][j], d, c + j * u.into_stride + i * kLanes);
  }
}

template <size_t kColumns>
HWY_INLINE void update_columns(const RankUpdate& u, size_t column, size_t first_row, size_t last_row) {
  size_t row = first_row;
  for (; row + kTilesAtOnce * kTileRows <= last_row; row += kTilesAtOnce * kTileRows) {
    update_tile<kTilesAtOnce, kColumns>(u, row, column);
  }
  for (; row < last_row; row += kTileRows) update_tile<1, kColumns>(u, row, column);
}

/// The lower half between two rows, in whole tiles.
void update_rows(const RankUpdate& u, size_t first_row, size_t last_row) {
  for (size_t column = u.first; column < std::min(u.last, last_row); column += kTileColumns) {
    const size_t row = std::max(first_row, rounded_down(column));
    switch (std::min(u.last - column, kTileColumns)) {
      case 4:
        update_columns<4>(u, column, row, last_row);
        break;
      case 3:
        update_columns<3>(u, column, row, last_row);
        break;
      case 2:
        update_columns<2>(u, column, row, last_row);
        break;
      default:
        update_columns<1>(u, column, row, last_row);
    }
  }
}

/// Adds column entries, two numbers each, to where they belong in two columns.
void add_pairs(const double* from, size_t from_stride, const uint32_t* to, size_t count, double* into,
               size_t into_stride) {
  const hn::CappedTag<double, 2> d;
  constexpr size_t kPair = 2, kPairLanes = hn::MaxLanes(d);
  const auto add = [&](const double* pair, double* place) {
    for (size_t a = 0; a < kPair; a += kPairLanes) {
      hn::StoreU(hn::Add(hn::LoadU(d, place + a), hn::LoadU(d, pair + a)), d, place + a);
    }
  };
  for (size_t i = 0; i < count; ++i) {
    double* const place = into + kPair * to[i];
    add(from + kPair * i, place);
    add(from + from_stride + kPair * i, place + into_stride);
  }
}

/// Columns first to last, from which all before them have been subtracted, become the factor's.
bool finish_columns(double* matrix, size_t stride, size_t first, size_t last) {
  const D d;
  for (size_t j = first; j < last; ++j) {
    double* column = matrix + j * stride;
    double pivot = column[j];
    for (size_t p = first; p < j; ++p) pivot -= matrix[p * stride + j] * matrix[p * stride + j];
    if (!(pivot > 0)) return false;
    const double root = std::sqrt(pivot);
    const auto inverse = hn::Set(d, 1 / root);
    for (size_t row = rounded_down(first); row < stride; row += kLanes) {
      auto value = hn::LoadU(d, column + row);
      for (size_t p = first; p < j; ++p) {
        const double* before = matrix + p * stride;
        value = hn::Sub(value, hn::Mul(hn::LoadU(d, before + row), hn::Set(d, before[j])));
      }
      hn::StoreU(hn::Mul(value, inverse), d, column + row);
    }
    column[j] = root;
  }
  return true;
}

/// x less the products of some columns with numbers, one after the other.
template <size_t kColumns>
HWY_INLINE void subtract(const double* column, size_t stride, const double* factor, size_t first, size_t last,
                         double* x) {
  const D d;
  size_t row = first;
  for (; row + kLanes <= last; row += kLanes) {
    auto value = hn::LoadU(d, x + row);
    for (size_t j = 0; j < kColumns; ++j) {
      value = hn::Sub(value, hn::Mul(hn::LoadU(d, column + j * stride + row), hn::Set(d, factor[j])));
    }
    hn::StoreU(value, d, x + row);
  }
  for (; row < last; ++row) {
    for (size_t j = 0; j < kColumns; ++j) x[row] -= column[j * stride + row] * factor[j];
  }
}

void solve_forwards(const double* factor, size_t stride, size_t own, size_t rows, double* x) {
  constexpr size_t kAtOnce = 4;
  size_t k = 0;
  for (; k + kAtOnce <= own; k += kAtOnce) {
    const double* column = factor + k * stride;
    for (size_t j = 0; j < kAtOnce; ++j) {
      x[k + j] /= column[j * stride + k + j];
      for (size_t i = j + 1; i < kAtOnce; ++i) x[k + i] -= column[j * stride + k + i] * x[k + j];
    }
    subtract<kAtOnce>(column, stride, x + k, k + kAtOnce, rows, x);
  }
  for (; k < own; ++k) {
    const double* column = factor + k * stride;
    x[k] /= column[k];
    subtract<1>(column, stride, x + k, k + 1, rows, x);
  }
}

/// The scalar products of some columns with x, from `first` on, which is a multiple of kTileRows, as is the last.
template <size_t kColumns>
HWY_INLINE void products(const double* column, size_t stride, const double* x, size_t first, size_t last,
                         double* result) {
  const D d;
  hn::Vec<D> sum[kColumns][kVectors];
  for (auto& of_column : sum) {
    for (auto& s : of_column) s = hn::Zero(d);
  }
  for (size_t row = first; row < last; row += kTileRows) {
    for (size_t i = 0; i < kVectors; ++i) {
      const size_t at = row + i * kLanes;
      const auto value = hn::LoadU(d, x + at);
      for (size_t j = 0; j < kColumns; ++j) {
        sum[j][i] = hn::Add(sum[j][i], hn::Mul(hn::LoadU(d, column + j * stride + at), value));
      }
    }
  }
  for (size_t j = 0; j < kColumns; ++j) {
    double part[kTileRows];
    for (size_t i = 0; i < kVectors; ++i) hn::StoreU(sum[j][i], d, part + i * kLanes);
    result[j] = ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
  }
}

void solve_backwards(const double* factor, size_t stride, size_t own, double* x) {
  constexpr size_t kAtOnce = 4;  // columns that begin in the same rows of a tile
  double sum[kAtOnce];
  for (size_t end = own; end > 0;) {
    const size_t begin = (end - 1) / kAtOnce * kAtOnce;
    const double* column = factor + begin * stride;
    const size_t whole = std::min(rounded_up(end), stride);
    switch (end - begin) {
      case 4:
        products<4>(column, stride, x, whole, stride, sum);
        break;
      case 3:
        products<3>(column, stride, x, whole, stride, sum);
        break;
      case 2:
        products<2>(column, stride, x, whole, stride, sum);
        break;
      default:
        products<1>(column, stride, x, whole, stride, sum);
    }
    for (size_t k = end; k-- > begin;) {
      const double* own_column = factor + k * stride;
      for (size_t row = k + 1; row < whole; ++row) sum[k - begin] += own_column[row] * x[row];
      x[k] = (x[k] - sum[k - begin]) / own_column[k];
    }
    end = begin;
  }
}

}  // namespace geocloth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth {
namespace {

HWY_EXPORT(add_pairs);
HWY_EXPORT(update_rows);
HWY_EXPORT(finish_columns);
HWY_EXPORT(solve_forwards);
HWY_EXPORT(solve_backwards);

void update(const RankUpdate& u) {
  const auto rows = HWY_DYNAMIC_DISPATCH(update_rows);
  const size_t start = rounded_down(u.first), blocks = (u.rows - start + kRowsAtOnce - 1) / kRowsAtOnce;
  const auto block = [&](size_t i) {
    rows(u, start + i * kRowsAtOnce, std::min(u.rows, start + (i + 1) * kRowsAtOnce));
  };
  if (u.rows * (u.last - u.first) * u.depth > kWorthTasks) {
    tbb::parallel_for(size_t{0}, blocks, block);
  } else {
    for (size_t i = 0; i < blocks; ++i) block(i);
  }
}

}  // namespace

DenseFront::DenseFront(size_t own, size_t rest)
    : own_(own), rest_(rest), stride_(rounded_up(own + rounded_up(rest))), rest_stride_(rounded_up(rest)) {
  constexpr size_t kCacheSets = 64;  // strides of so many numbers let columns displace each other
  if (stride_ % kCacheSets == 0) stride_ += kTileRows;
}

void DenseFront::clear(double* factor, double diagonal, double* rest) const {
  for (size_t c = 0; c < own_; ++c) {
    std::fill(factor + c * stride_ + rounded_down(c), factor + (c + 1) * stride_, 0.0);
    factor[c * stride_ + c] = diagonal;
  }
  for (size_t c = 0; c < rest_; ++c) {
    std::fill(rest + c * rest_stride_ + rounded_down(c), rest + (c + 1) * rest_stride_, 0.0);
  }
}

void DenseFront::add(const DenseFront& child, const double* left, std::span<const uint32_t> to, size_t width,
                     double* factor, double* rest) const {
  const auto pairs = HWY_DYNAMIC_DISPATCH(add_pairs);
  for (size_t k = 0; k < to.size(); ++k) {
    const double* const from = left + k * width * child.rest_stride_;
    const size_t column = to[k] * width;
    const bool is_own = column < own_;
    // Row 0 of the column; that of what is left has no rows of own unknowns.
    double* const into = is_own ? factor + column * stride_ : rest + (column - own_) * rest_stride_ - own_;
    const size_t stride = is_own ? stride_ : rest_stride_;
    if (width == 2) {
      pairs(from + 2 * k, child.rest_stride_, to.data() + k, to.size() - k, into, stride);
    } else {
      for (size_t i = k; i < to.size(); ++i) into[to[i]] += from[i];
    }
  }
}

bool DenseFront::eliminate(double* factor, double* rest) const {
  const auto rows = HWY_DYNAMIC_DISPATCH(update_rows);
  const auto finish = HWY_DYNAMIC_DISPATCH(finish_columns);
  for (size_t begin = 0; begin < own_; begin += kDepth) {
    const size_t end = std::min(own_, begin + kDepth);
    const double* from = factor + begin * stride_;
    for (size_t j = begin; j < end; j += kTileColumns) {
      const size_t last = std::min(end, j + kTileColumns);
      if (j > begin) rows({from, stride_, j - begin, factor, stride_, j, last, stride_}, 0, stride_);
      if (!finish(factor, stride_, j, last)) return false;
    }
    if (end < own_) update({from, stride_, end - begin, factor, stride_, end, own_, stride_});
    if (rest_ > 0) update({from + own_, stride_, end - begin, rest, rest_stride_, 0, rest_, rest_stride_});
  }
  return true;
}

void DenseFront::solve_forwards(const double* factor, double* x) const {
  HWY_DYNAMIC_DISPATCH(solve_forwards)(factor, stride_, own_, own_ + rest_, x);
}

void DenseFront::solve_backwards(const double* factor, double* x) const {
  HWY_DYNAMIC_DISPATCH(solve_backwards)(factor, stride_, own_, x);
}

}  // namespace geocloth
#endif
