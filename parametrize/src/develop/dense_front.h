// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace geocloth {

/// A dense symmetric matrix, lower half, whose first unknowns are eliminated: Cholesky's factor takes their columns,
/// and what is left of the others, the rest, is for someone else. Columns lie one after the other, filled up with
/// zeros; what lies above the diagonal means nothing. The numbers are the user's, at begins of cache lines. Same input,
/// same bits, on every processor and any number of threads.
class DenseFront {
 public:
  DenseFront() = default;
  /// @param own   unknowns that are eliminated; they come first
  /// @param rest  unknowns that are not
  DenseFront(size_t own, size_t rest);

  [[nodiscard]] size_t own() const { return own_; }
  [[nodiscard]] size_t rest() const { return rest_; }
  /// Rows of a column of the factor, with those that fill it up.
  [[nodiscard]] size_t stride() const { return stride_; }
  [[nodiscard]] size_t rest_stride() const { return rest_stride_; }
  /// Numbers that the user has to have room for.
  [[nodiscard]] size_t factor_size() const { return own_ * stride_; }
  [[nodiscard]] size_t rest_size() const { return rest_ * rest_stride_; }

  /// Everything to zero, but the diagonal of the eliminated unknowns.
  void clear(double* factor, double diagonal, double* rest) const;

  /// Adds what is left of another front.
  /// @param to     where its unknowns are here, in groups of `width`, ascending
  /// @param width  1 or 2
  void add(const DenseFront& child, const double* left, std::span<const uint32_t> to, size_t width, double* factor,
           double* rest) const;

  /// @param factor  the eliminated unknowns' columns, of all rows
  /// @param rest    matrix of the unknowns that stay
  /// @returns false when the matrix is not positive definite
  [[nodiscard]] bool eliminate(double* factor, double* rest) const;

  /// Both halves of a solution, for a right side of stride() rows, zeros at its end. The first changes all of it, the
  /// second its own unknowns.
  void solve_forwards(const double* factor, double* x) const;
  void solve_backwards(const double* factor, double* x) const;

 private:
  size_t own_ = 0, rest_ = 0, stride_ = 0, rest_stride_ = 0;
};

}  // namespace geocloth
