// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "colliders/node_grid.h"
#include "colliders/winding_tree.h"
#include "geocloth/solver/solid.h"

namespace geocloth {

/// What a surface winds around, once or several times, either way. It may have holes, which are closed by cones over
/// their borders, go through itself and be in several parts. In a soup of triangles, most of whose edges are borders,
/// it is where the generalised winding number (Jacobson, Kavan, Sorkine-Hornung 2013, "Robust Inside-Outside
/// Segmentation") is above 1/2; a hole with a flat border is the same to both.
class Enclosure {
 public:
  /// @param grid  holds all of the surface
  Enclosure(const NodeGrid& grid, const TriangleSurface& surface);

  /// For each node of the grid whether it is inside.
  [[nodiscard]] std::vector<char> nodes_inside() const;

  /// Before points are asked for. @param triangles  no point is farther than 1 / 16 of a spacing from all of them
  void index(std::span<const TriangleCorners> triangles);
  /// A point in the grid, to a lattice of 1 / 1024 of a spacing.
  [[nodiscard]] bool encloses(const Vec3d& p) const;

 private:
  struct LatticePoint {
    int64_t x, y, z;
    friend bool operator==(const LatticePoint&, const LatticePoint&) = default;
  };
  /// A triangle that counts several times.
  struct Facet {
    LatticePoint a, b, c;
    int32_t times;
  };
  /// Where a facet is: rows along x that are beside it, and points before it, have nothing to do with it.
  struct FacetBox {
    int64_t x0, y0, y1, z0, z1;  ///< [steps]
    uint32_t facet;
  };
  /// An edge that has so many more triangles on its left than on its right.
  struct BorderEdge {
    uint32_t from, to;
    int32_t times;
  };

  [[nodiscard]] std::vector<std::array<uint32_t, 3>> join(const TriangleSurface& surface);
  [[nodiscard]] std::vector<BorderEdge> border_of(const std::vector<std::array<uint32_t, 3>>& triangle) const;
  void close(const std::vector<BorderEdge>& border);
  [[nodiscard]] LatticePoint on_lattice(const Vec3d& p) const;
  [[nodiscard]] Vec3d place(const LatticePoint& p) const;
  void count_turns(uint32_t first_layer, uint32_t last_layer, std::vector<int32_t>& turns) const;
  static FacetBox box_of(const Facet& f, uint32_t number);
  [[nodiscard]] int32_t turns_at(const LatticePoint& p) const;

  NodeGrid grid_;
  std::vector<LatticePoint> point_;
  std::vector<Facet> facets_;        ///< without a border, but for a soup's
  std::optional<WindingTree> tree_;  ///< of a soup
  // Columns along x with the facets in them, after index():
  int64_t column_ = 256;  ///< [steps] their sides
  uint32_t columns_along_y_ = 0, columns_along_z_ = 0;
  std::vector<uint32_t> column_first_;
  std::vector<FacetBox> in_column_;
};

}  // namespace geocloth
