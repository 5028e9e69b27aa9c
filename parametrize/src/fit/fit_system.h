// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "fit/grid_holds.h"
#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// A triangle of the grid to be moved towards the surface.
struct FitTriangle {
  Triangle point;
  Point3 normal;     ///< of unit length, or nothing
  double slack = 1;  ///< how much moves along the triangle count beside those across it, > 0
  double area = 0;   ///< in the plane, by its weight [pixels^2]
};

/// The least squares problem of moving a grid: its mass matrix, and wishes on top. The same bits for any number of
/// threads.
class FitSystem {
 public:
  FitSystem(size_t points, std::vector<FitTriangle> triangles);

  /// Wishes from index `begin` on are new.
  void add(std::span<const MoveWish> wishes, size_t begin);

  /// The moves for a right side of the fit, sought from x on.
  /// @param wishes  all that were added
  /// @param enough  of the right side that may be left, squared
  void solve(const std::vector<Point3>& pull, std::span<const MoveWish> wishes, double enough,
             std::vector<Point3>& x) const;

 private:
  using Symmetric = std::array<double, 6>;  // xx, xy, xz, yy, yz, zz
  /// Which corners of triangles or wishes each point is. Corner k of the n-th of them is 3 n + k.
  struct CornersOfPoints {
    std::vector<uint32_t> first, corner;  // per point: where its corners begin; those

    template <class Item>
    void list(size_t points, std::span<const Item> items);
    [[nodiscard]] std::span<const uint32_t> of(size_t i) const {
      return std::span(corner).subspan(first[i], first[i + 1] - first[i]);
    }
  };

  [[nodiscard]] static bool moves(const Symmetric& block);
  static void add_square(Symmetric& m, const Point3& v, double weight);
  static Point3 solved(const Symmetric& m, const Point3& r);
  [[nodiscard]] Point3 triangles_pull(size_t i, const std::vector<Point3>& x) const;
  /// Adds to v what the wishes of a point pull by. @param pull  of each wish
  void add_wishes(size_t i, std::span<const MoveWish> wishes, const std::vector<double>& pull, Point3& v) const;
  /// y = matrix x. @param pull  room for one number a wish @returns x . y
  double multiply(const std::vector<Point3>& x, std::span<const MoveWish> wishes, std::vector<double>& pull,
                  std::vector<Point3>& y) const;

  std::vector<FitTriangle> triangle_;
  CornersOfPoints of_triangles_, of_wishes_;
  std::vector<Symmetric> block_;  // of the matrix's diagonal; zero for points of no triangle, which stay
};

}  // namespace geocloth
