// SPDX-License-Identifier: Apache-2.0
// Stiffnesses of springs from the moduli of a sheet: k = K w / L (force per strain, width w, length L), with the width
// from the triangles on the spring's own side: a spring on a seam exists once for each copy and the copies' stiffnesses
// add up.

#include "rest/rest_shape.h"

#include <algorithm>

namespace geocloth {
namespace {

/// Share of a direction's modulus that shear springs may take over at most.
constexpr double kLargestShearShare = 0.5;

/// With the sides a (weft) and b (warp), strains e_u, e_v and the shear gamma, two diagonals with k = G L^2 / (2 a b)
/// have the energy per area
///   G ((e_u a/b + e_v b/a)^2 + gamma^2) / 2,
/// that is the shear modulus G, and moduli C_u = G a^2/b^2, C_v = G b^2/a^2 with the coupling G on top of the
/// structural springs'. Pulled along one direction and free across, K_v + C_v - G^2 / (K_u + C_u) must be the
/// material's modulus.
CellModuli cell_moduli(const Material& m, double a, double b) {
  const double ratio = std::clamp(a / b, 1e-3, 1e3);
  const double r2 = ratio * ratio;
  const double wanted_warp = m.stretch_warp, wanted_weft = m.stretch_weft;
  const double g =
      std::min(static_cast<double>(m.shear), kLargestShearShare * std::min(wanted_weft / r2, wanted_warp * r2));
  CellModuli c{wanted_warp, wanted_weft, g / (2 * a * b)};
  for (int i = 0; i < 20; ++i) {
    c.warp = wanted_warp - g / r2 + g * g / (c.weft + g * r2);
    c.weft = wanted_weft - g * r2 + g * g / (c.warp + g / r2);
  }
  return c;
}

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * static_cast<double>(length(cross(b - a, c - a)));
}

}  // namespace

RestShape::RestShape(const ClothAsset& asset, float scale, const FabricMap& fabrics)
    : asset_(asset), scale_(scale), fabrics_(fabrics), cells_(asset.pixel_count()) {
  for (uint32_t y = 0; y + 1 < asset.height; ++y)
    for (uint32_t x = 0; x + 1 < asset.width; ++x)
      if (asset.cell[pixel(x, y)] & (kCellFirst | kCellSecond)) cells_[pixel(x, y)] = make_cell(x, y);
}

double RestShape::rest_length(uint32_t a, uint32_t b) const {
  return static_cast<double>(scale_) * static_cast<double>(length(asset_.rest_position[b] - asset_.rest_position[a]));
}

template <class Visit>
void RestShape::for_triangles(uint32_t component, uint32_t x, uint32_t y, const Visit& visit) const {
  if (component == 0) {  // upper side of the cell below, lower side of the cell above
    visit(cell(x, y), size_t{diagonal_left(x, y) ? 0U : 1U});
    visit(cell(x, y - 1), size_t{diagonal_left(x, y - 1) ? 1U : 0U});
  } else {  // left side of the cell to the right, right side of the cell to the left
    visit(cell(x, y), size_t{0});
    visit(cell(x - 1, y), size_t{1});
  }
}

double RestShape::structural_stiffness(uint32_t component, uint32_t x, uint32_t y, double rest) const {
  const bool warp = component == 1;
  double sum = 0;
  for_triangles(component, x, y, [&](const RestCell& c, size_t triangle) {
    sum += c.area[triangle] * (warp ? c.moduli.warp : c.moduli.weft);
  });
  if (!(sum > 0)) {
    const Material lone = fabrics_.at(pixel(x, y));
    sum = lone_area(x, y) * static_cast<double>(warp ? lone.stretch_warp : lone.stretch_weft);
  }
  return sum / (rest * rest);
}

double RestShape::diagonal_stiffness(uint32_t component, uint32_t x, uint32_t y, double rest) const {
  const RestCell c = cell(component == 2 ? x : x - 1, y);
  if (c.triangles() > 0) return c.triangles() * c.moduli.diagonal * rest * rest;
  return static_cast<double>(fabrics_.at(pixel(x, y)).shear) * lone_area(x, y) / (rest * rest);
}

RestCell RestShape::make_cell(uint32_t x, uint32_t y) const {
  const uint8_t bits = asset_.cell[pixel(x, y)];
  const auto& p = asset_.rest_position;
  const Vec3 &p0 = p[pixel(x, y)], &p1 = p[pixel(x + 1, y)], &p2 = p[pixel(x, y + 1)], &p3 = p[pixel(x + 1, y + 1)];
  const bool left = (bits & kCellDiagonalLeft) != 0;
  const double s = static_cast<double>(scale_);
  RestCell c;
  if (bits & kCellFirst) c.area[0] = s * s * (left ? triangle_area(p0, p2, p1) : triangle_area(p0, p2, p3));
  if (bits & kCellSecond) c.area[1] = s * s * (left ? triangle_area(p1, p2, p3) : triangle_area(p0, p3, p1));
  // A cell with one triangle has only that triangle's sides.
  const double upper = length(p1 - p0), lower = length(p3 - p2), west = length(p2 - p0), east = length(p3 - p1);
  const bool first = c.area[0] > 0, second = c.area[1] > 0;
  const double a = first && second ? 0.5 * (upper + lower) : first == left ? upper : lower;
  const double b = first && second ? 0.5 * (west + east) : first ? west : east;
  if (a > 0 && b > 0) c.moduli = cell_moduli(fabrics_.of_cell(pixel(x, y)), s * a, s * b);
  return c;
}

}  // namespace geocloth
