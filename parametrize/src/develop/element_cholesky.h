// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>

#include <Eigen/Core>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Solves symmetric positive definite systems on the vertices of a triangle mesh whose matrix is a sum over triangles.
/// The order of elimination is found once. Same input, same bits, on any number of threads.
class ElementCholesky {
 public:
  /// @param unknown  per vertex: its number 0, 1, ..., negative when it is fixed
  /// @param place    per vertex, in the plane: where neighbours lie near each other, solving is fast (dissection.h)
  /// @param width    scalars per vertex, 1 or 2
  ElementCholesky(std::span<const Triangle> triangle, std::span<const int32_t> unknown, std::span<const Point2> place,
                  Eigen::Index width);
  ElementCholesky(ElementCholesky&&) noexcept;
  ElementCholesky& operator=(ElementCholesky&&) noexcept;
  ~ElementCholesky();

  /// @param element   lower halves of the triangles' matrices by rows, one after the other; row and column `width` *
  ///   corner + scalar
  /// @param diagonal  added to the whole diagonal
  /// @returns false when the matrix is not positive definite
  [[nodiscard]] bool factorise(std::span<const double> element, double diagonal);

  /// Gives the factor's memory back until it is factorised again.
  void forget_factor();

  /// Replaces right sides, one a column, rows `width` * unknown + scalar, by their solutions.
  void solve(Eigen::MatrixXd& right) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geocloth
