// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// Maps a disk into the plane over a convex outline by solving a Laplace equation with positive weights (Tutte 1963,
/// Floater 1997). Planar coordinates are mathematical: y up, triangles counter-clockwise. The factorisation's pattern
/// and the geometry are kept for repeated solves.
class DiskEmbedding {
 public:
  enum class Weights { mean_value, uniform };

  /// @param position  vertices of the surface [m]
  /// @param triangle  a disk without interior edges between two outline vertices
  /// @param fixed     per vertex: non-zero on the outline
  DiskEmbedding(std::span<const Point3> position, std::span<const Triangle> triangle, std::span<const uint8_t> fixed,
                Weights weights);
  DiskEmbedding(DiskEmbedding&&) noexcept;
  DiskEmbedding& operator=(DiskEmbedding&&) noexcept;
  ~DiskEmbedding();

  /// Places the vertices that are not fixed; `uv` holds the fixed ones.
  void solve(std::vector<Point2>& uv) const;

  /// Takes the mean-value weights from a flip-free planar map instead of the surface: a solve over the same outline
  /// then about reproduces it, and over another outline keeps its proportions.
  void weigh_by(std::span<const Point2> uv);

  /// Area-weighted root mean square of the stretch (Sander et al. 2001) after scaling to equal areas; 1 is best,
  /// infinite when a triangle is flipped or empty.
  [[nodiscard]] double l2_stretch(std::span<const Point2> uv) const;

  /// The square of the stretch per triangle, not scaled; infinite when it is flipped or empty.
  [[nodiscard]] std::vector<double> stretch_per_triangle(std::span<const Point2> uv) const;

  /// Divides the weights by the vertices' stretch and solves again while that lowers the L2 stretch (Yoshizawa,
  /// Belyaev, Seidel 2004). The embedding stays valid, since the weights stay positive.
  /// @return the L2 stretch reached
  double relax_stretch(std::vector<Point2>& uv, int rounds);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geocloth
