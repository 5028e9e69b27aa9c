// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "geocloth/parametrize/seams.h"
#include "mesh/point_math.h"

namespace geocloth {

/// An image as the triangles between its pixels, while its points move. Copies of a point are one point, named by the
/// first of them.
class ImageSurface {
 public:
  ImageSurface(const FlatSurface& flat, const ClothAsset& asset);

  [[nodiscard]] std::array<Point3, 3> corners(uint32_t t) const {
    return {place[points[t][0]], place[points[t][1]], place[points[t][2]]};
  }
  /// As long as the triangle's area, twice.
  [[nodiscard]] Point3 normal(uint32_t t) const;
  /// In which cell of the image a triangle lies: the pixel at its upper left corner.
  [[nodiscard]] uint32_t cell_of(uint32_t t) const;

  /// Calls visit(cell, position) for every vertex of the surface: they may be the tips of something.
  template <class Visit>
  void for_each_vertex(const Visit& visit) const {
    for (const CellVertex& v : vertex_) visit(v.cell, flat.position[v.vertex]);
  }
  /// Calls visit(position) for the vertices of the surface in one cell.
  template <class Visit>
  void for_each_vertex_in(uint32_t cell, const Visit& visit) const {
    const auto [begin, end] = std::equal_range(vertex_.begin(), vertex_.end(), CellVertex{cell, 0}, by_cell);
    for (auto v = begin; v != end; ++v) visit(flat.position[v->vertex]);
  }

  const FlatSurface& flat;
  const ClothAsset& asset;
  std::vector<uint32_t> first;           ///< per pixel its point
  std::vector<Triangle> pixels, points;  ///< of the triangles
  std::vector<Point3> place;             ///< [m] per point

 private:
  struct CellVertex {
    uint32_t cell, vertex;
  };
  static bool by_cell(const CellVertex& a, const CellVertex& b) { return a.cell < b.cell; }

  void find_vertices();
  [[nodiscard]] uint32_t cell_beside(uint32_t cell, const FlatChart& chart, const Point2& place_in_chart) const;

  std::vector<CellVertex> vertex_;  // by cell
};

/// The place in a triangle that has these weights.
[[nodiscard]] inline Point3 at(const std::array<Point3, 3>& corner, const Point3& weight) {
  return corner[0] * weight[0] + corner[1] * weight[1] + corner[2] * weight[2];
}

}  // namespace geocloth
