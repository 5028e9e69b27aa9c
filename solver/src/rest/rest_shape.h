// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geocloth/asset/cloth_asset.h"
#include "rest/fabrics.h"

namespace geocloth {

/// [m/N] Springs and bends are no softer: they do nothing even so, and over the square of the shortest step more would
/// leave single precision.
inline constexpr double kLargestCompliance = 1e20;

/// The structural springs of one cell and its diagonals, so that the lattice has the material's moduli.
struct CellModuli {
  double warp = 0, weft = 0;  ///< [N/m] of the structural springs
  double diagonal = 0;        ///< [N/m^3] stiffness of a diagonal / its length squared
};

/// One cell of the rest shape.
struct RestCell {
  std::array<double, 2> area{};  ///< [m^2] first and second triangle
  CellModuli moduli;
  [[nodiscard]] double triangles() const { return (area[0] > 0 ? 0.5 : 0) + (area[1] > 0 ? 0.5 : 0); }  ///< of two
};

/// The rest shape, scaled, and what each cell gives to the springs around it. Every triangle has one side of each
/// structural direction, so each direction's springs cover the surface once.
class RestShape {
 public:
  /// Keeps the references.
  RestShape(const ClothAsset& asset, float scale, const FabricMap& fabrics);

  [[nodiscard]] double rest_length(uint32_t a, uint32_t b) const;

  /// [N/m] of a structural spring from (x, y), component 0 (right) or 1 (down): K w / L, with K and w from its
  /// triangles.
  [[nodiscard]] double structural_stiffness(uint32_t component, uint32_t x, uint32_t y, double rest) const;
  /// [N/m] of a diagonal from (x, y), component 2 (down-right) or 3 (down-left).
  [[nodiscard]] double diagonal_stiffness(uint32_t component, uint32_t x, uint32_t y, double rest) const;

  [[nodiscard]] double pixel_area(uint32_t p) const {
    return static_cast<double>(asset_.area[p]) * static_cast<double>(scale_) * static_cast<double>(scale_);
  }

 private:
  [[nodiscard]] uint32_t pixel(uint32_t x, uint32_t y) const { return y * asset_.width + x; }
  [[nodiscard]] bool inside(uint32_t x, uint32_t y) const { return x < asset_.width && y < asset_.height; }
  /// x - 1 and y - 1 wrap to huge numbers at 0, which are outside.
  [[nodiscard]] RestCell cell(uint32_t x, uint32_t y) const { return inside(x, y) ? cells_[pixel(x, y)] : RestCell{}; }
  [[nodiscard]] bool diagonal_left(uint32_t x, uint32_t y) const {
    return inside(x, y) && (asset_.cell[pixel(x, y)] & kCellDiagonalLeft) != 0;
  }
  /// A spring without a triangle is a thin tongue of cloth.
  [[nodiscard]] double lone_area(uint32_t x, uint32_t y) const { return 0.25 * pixel_area(pixel(x, y)); }
  /// Calls visit(cell, triangle) for the triangles that have the structural spring from (x, y) as a side.
  template <class Visit>
  void for_triangles(uint32_t component, uint32_t x, uint32_t y, const Visit& visit) const;
  [[nodiscard]] RestCell make_cell(uint32_t x, uint32_t y) const;

  const ClothAsset& asset_;
  float scale_;
  const FabricMap& fabrics_;
  std::vector<RestCell> cells_;
};

}  // namespace geocloth
