// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

namespace geocloth {

/// A dense symmetric matrix, lower half, whose first unknowns are eliminated: Cholesky's factor takes their columns,
/// and what is left of the others is for someone else. Columns lie one after the other, filled up with zeros. Same
/// input, same bits, on every processor and any number of threads.
class DenseFront {
 public:
  /// What is left of the unknowns that are not eliminated: lower half; what lies above means nothing.
  struct Rest {
    size_t stride = 0;  ///< from column to column
    std::vector<double> value;
  };

  /// @param own   unknowns that are eliminated; they come first
  /// @param rest  unknowns that are not
  void set_size(size_t own, size_t rest);
  [[nodiscard]] size_t own() const { return own_; }
  [[nodiscard]] size_t rest() const { return rest_; }
  /// Rows of a column, with those that fill it up.
  [[nodiscard]] size_t stride() const { return stride_; }

  /// Everything to zero. @returns the remainder, also zero
  Rest clear();
  /// The eliminated unknowns' columns, of all rows.
  [[nodiscard]] double* column(size_t c) { return factor_.data() + c * stride_; }

  /// @param rest  matrix of the unknowns that stay, which is changed
  /// @returns false when the matrix is not positive definite
  [[nodiscard]] bool eliminate(Rest& rest);

  /// Both halves of a solution, for a right side of stride() rows, zeros at its end. The first changes all of it, the
  /// second its own unknowns.
  void solve_forwards(double* x) const;
  void solve_backwards(double* x) const;

 private:
  size_t own_ = 0, rest_ = 0, stride_ = 0;
  std::vector<double> factor_;
};

}  // namespace geocloth
