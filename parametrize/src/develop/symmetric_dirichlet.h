// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Minimises the symmetric Dirichlet energy of a planar map without ever flipping a triangle. The mesh is given once;
/// the factorisation's pattern is kept, so that warm starts are cheap.
/// Planar coordinates are mathematical: y up, triangles counter-clockwise. Unit: the same metres as the surface, since
/// the energy prefers isometry; scale a map to the surface's area first.
class SymmetricDirichlet {
 public:
  /// @param position  vertices of the surface [m]
  /// @param triangle  its triangles, area > 0
  /// @param fixed     per vertex: non-zero keeps it where it is; empty: all are free
  /// @param share     per triangle: of its area that counts, > 0; empty: all of it
  SymmetricDirichlet(std::span<const Point3> position, std::span<const Triangle> triangle,
                     std::span<const uint8_t> fixed, std::span<const double> share = {});
  SymmetricDirichlet(SymmetricDirichlet&&) noexcept;
  SymmetricDirichlet& operator=(SymmetricDirichlet&&) noexcept;
  ~SymmetricDirichlet();

  /// Area-weighted mean of s1^2 + s2^2 + 1/s1^2 + 1/s2^2 (4 is isometric); infinite when a triangle is flipped.
  [[nodiscard]] double energy(std::span<const Point2> uv) const;

  /// The same per triangle.
  [[nodiscard]] std::vector<double> energy_per_triangle(std::span<const Point2> uv) const;

  /// Adds `price` times the squared cosine of the angle at which the plane's x and y meet on the surface to what
  /// minimise() makes small: the threads of a woven cloth stay orthogonal at the cost of a little stretch.
  void set_shear_price(double price);

  /// Triangles count so many times their area in what minimise() makes small, and in the energies.
  void set_weights(std::span<const double> times);

  /// Projected Newton steps until the energy falls by less than `tolerance` of itself in a step.
  /// @param uv  flip-free start; left flip-free and no worse
  /// @returns the energy reached
  double minimise(std::vector<Point2>& uv, uint32_t max_iterations, double tolerance = 1e-5);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geocloth
