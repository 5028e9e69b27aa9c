// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

struct TermsView;

/// What each triangle of a planar map adds to the symmetric Dirichlet energy, and its derivatives, several triangles at
/// a time. Same input, same bits, on every processor.
class DirichletTerms {
 public:
  static constexpr size_t kUnknowns = 6;    ///< of a triangle: x and y of its corners
  static constexpr size_t kLowerHalf = 21;  ///< entries of a symmetric matrix of these

  /// @param position  vertices of the surface [m]
  /// @param share     per triangle: of its area that counts; empty: all of it
  DirichletTerms(std::span<const Point3> position, std::span<const Triangle> triangle,
                 std::span<const double> share = {});

  [[nodiscard]] size_t size() const { return count_; }
  /// Weights are shares of the area.
  void multiply_weights(std::span<const double> times);

  /// s1^2 + s2^2 + 1/s1^2 + 1/s2^2 of every triangle, infinite where it is flipped.
  [[nodiscard]] std::vector<double> densities(std::span<const Point2> uv) const;

  /// The sum over all triangles, in their order, of weight * (density + shear_price * shear^2).
  [[nodiscard]] double cost(std::span<const Point2> uv, double shear_price) const;

  static constexpr size_t kAtOnce = 4;  ///< triangles

  /// Gradient and projected Hessian of what triangles first..last-1 add to the cost, kUnknowns and kLowerHalf numbers
  /// for each of all triangles; the latter's lower half by rows.
  /// @param first  a multiple of kAtOnce
  void differentiate(size_t first, size_t last, std::span<const Point2> uv, double shear_price,
                     std::span<double> gradient, std::span<double> hessian) const;

  /// The largest step along `direction` before a triangle's determinant becomes zero.
  [[nodiscard]] double largest_step(std::span<const Point2> uv, std::span<const Point2> direction) const;

 private:
  [[nodiscard]] TermsView view(std::span<const Point2> uv, double shear_price) const;

  size_t count_ = 0;
  // Per triangle, filled up with copies of the last one to whole vectors:
  std::array<std::vector<int64_t>, 3> corner_;           // where its x is among all coordinates
  std::array<std::vector<double>, kUnknowns> gradient_;  // by corner, of x and y on the surface: as the map's
  std::vector<double> weight_;
};

}  // namespace geocloth
