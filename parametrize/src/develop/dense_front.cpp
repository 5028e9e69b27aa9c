// SPDX-License-Identifier: GPL-3.0-or-later
// Cholesky's factorisation of small and middle-sized matrices in vectors, for every instruction set that Highway knows;
// the best one is chosen when the program runs. Tiles of 8 rows and 4 columns stay in registers while all columns
// before them are subtracted (Goto, van de Geijn 2008, without their packing, which small matrices do not repay). Every
// entry sees the same operations in the same order whatever the vectors' length: products are not fused with sums.
#include "develop/dense_front.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

// Vectors whose length is not known when compiling cannot be members of an array.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
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

using D = hn::CappedTag<double, 4>;
constexpr size_t kLanes = hn::MaxLanes(D());
constexpr size_t kVectors = kTileRows / kLanes;  // in a column of a tile

/// Rows `row`... and columns `column`... of what is updated, less the products of these rows and rows `column`....
template <size_t kColumns>
HWY_INLINE void update_tile(const RankUpdate& u, size_t row, size_t column) {
  const D d;
  const double *a = u.from + row, *b = u.from + column;
  double* c = u.into + column * u.into_stride + row;
  hn::Vec<D> sum[kVectors][kColumns];
  for (size_t j = 0; j < kColumns; ++j) {
    for (size_t i = 0; i < kVectors; ++i) sum[i][j] = hn::LoadU(d, c + j * u.into_stride + i * kLanes);
  }
  for (size_t k = 0; k < u.depth; ++k, a += u.from_stride, b += u.from_stride) {
    hn::Vec<D> left[kVectors];
    for (size_t i = 0; i < kVectors; ++i) left[i] = hn::LoadU(d, a + i * kLanes);
    for (size_t j = 0; j < kColumns; ++j) {
      const auto right = hn::Set(d, b[j]);
      for (size_t i = 0; i < kVectors; ++i) sum[i][j] = hn::Sub(sum[i][j], hn::Mul(left[i], right));
    }
  }
  for (size_t j = 0; j < kColumns; ++j) {
    for (size_t i = 0; i < kVectors; ++i) hn::StoreU(sum[i][j], d, c + j * u.into_stride + i * kLanes);
  }
}

/// The lower half between two rows, in whole tiles.
void update_rows(const RankUpdate& u, size_t first_row, size_t last_row) {
  for (size_t column = u.first; column < std::min(u.last, last_row); column += kTileColumns) {
    for (size_t row = std::max(first_row, rounded_down(column)); row < last_row; row += kTileRows) {
      switch (std::min(u.last - column, kTileColumns)) {
        case 4:
          update_tile<4>(u, row, column);
          break;
        case 3:
          update_tile<3>(u, row, column);
          break;
        case 2:
          update_tile<2>(u, row, column);
          break;
        default:
          update_tile<1>(u, row, column);
      }
    }
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

/// x less a column's product with a number.
void subtract(const double* column, double factor, size_t first, size_t last, double* x) {
  const D d;
  size_t row = first;
  for (; row + kLanes <= last; row += kLanes) {
    hn::StoreU(hn::Sub(hn::LoadU(d, x + row), hn::Mul(hn::LoadU(d, column + row), hn::Set(d, factor))), d, x + row);
  }
  for (; row < last; ++row) x[row] -= column[row] * factor;
}

/// The scalar product of two columns, whose number of rows is a multiple of kTileRows.
double product(const double* a, const double* b, size_t rows) {
  const D d;
  hn::Vec<D> sum[kVectors];
  for (auto& s : sum) s = hn::Zero(d);
  for (size_t row = 0; row < rows; row += kTileRows) {
    for (size_t i = 0; i < kVectors; ++i) {
      const size_t at = row + i * kLanes;
      sum[i] = hn::Add(sum[i], hn::Mul(hn::LoadU(d, a + at), hn::LoadU(d, b + at)));
    }
  }
  double part[kTileRows];
  for (size_t i = 0; i < kVectors; ++i) hn::StoreU(sum[i], d, part + i * kLanes);
  return ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
}

}  // namespace geocloth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth {
namespace {

HWY_EXPORT(update_rows);
HWY_EXPORT(finish_columns);
HWY_EXPORT(subtract);
HWY_EXPORT(product);

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

void DenseFront::set_size(size_t own, size_t rest) {
  own_ = own;
  rest_ = rest;
  stride_ = rounded_up(own + rounded_up(rest));
  constexpr size_t kCacheSets = 64;  // strides of so many numbers let columns displace each other
  if (stride_ % kCacheSets == 0) stride_ += kTileRows;
}

DenseFront::Rest DenseFront::clear() {
  factor_.assign(stride_ * own_, 0.0);
  Rest rest{rounded_up(rest_), {}};
  rest.value.assign(rest.stride * ((rest_ + kTileColumns - 1) / kTileColumns * kTileColumns), 0.0);
  return rest;
}

bool DenseFront::eliminate(Rest& rest) {
  const auto rows = HWY_DYNAMIC_DISPATCH(update_rows);
  double* matrix = factor_.data();
  for (size_t begin = 0; begin < own_; begin += kDepth) {
    const size_t end = std::min(own_, begin + kDepth);
    const double* from = matrix + begin * stride_;
    for (size_t j = begin; j < end; j += kTileColumns) {
      const size_t last = std::min(end, j + kTileColumns);
      if (j > begin) rows({from, stride_, j - begin, matrix, stride_, j, last, stride_}, 0, stride_);
      if (!HWY_DYNAMIC_DISPATCH(finish_columns)(matrix, stride_, j, last)) return false;
    }
    if (end < own_) update({from, stride_, end - begin, matrix, stride_, end, own_, stride_});
    if (rest_ > 0) update({from + own_, stride_, end - begin, rest.value.data(), rest.stride, 0, rest_, rest.stride});
  }
  return true;
}

void DenseFront::solve_forwards(double* x) const {
  for (size_t k = 0; k < own_; ++k) {
    const double* column = factor_.data() + k * stride_;
    x[k] /= column[k];
    HWY_DYNAMIC_DISPATCH(subtract)(column, x[k], k + 1, own_ + rest_, x);
  }
}

void DenseFront::solve_backwards(double* x) const {
  for (size_t k = own_; k-- > 0;) {
    const double* column = factor_.data() + k * stride_;
    const size_t whole = std::min(rounded_up(k + 1), stride_);
    double sum = HWY_DYNAMIC_DISPATCH(product)(column + whole, x + whole, stride_ - whole);
    for (size_t row = k + 1; row < whole; ++row) sum += column[row] * x[row];
    x[k] = (x[k] - sum) / column[k];
  }
}

}  // namespace geocloth
#endif
