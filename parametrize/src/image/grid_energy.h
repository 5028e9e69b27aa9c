// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"

namespace geocloth {

/// A right angle of the grid: of a cell, or of half a cell where the outline cuts it.
struct GridCorner {
  uint32_t middle, beside, below;  ///< pixels: the corner's, its neighbour in the row, its neighbour in the column
  double turn;                     ///< sign of the angle from `beside` to `below` on the lattice
};

/// The corners of a grid, and those that each pixel is part of.
class GridCorners {
 public:
  GridCorners() = default;
  GridCorners(std::vector<GridCorner> corner, size_t pixel_count);

  [[nodiscard]] const GridCorner& operator[](uint32_t k) const { return corner_[k]; }
  [[nodiscard]] auto begin() const { return corner_.begin(); }
  [[nodiscard]] auto end() const { return corner_.end(); }
  [[nodiscard]] std::span<const uint32_t> around(uint32_t pixel) const {
    return {around_.data() + first_[pixel], around_.data() + first_[pixel + 1]};
  }

 private:
  std::vector<GridCorner> corner_;
  std::vector<uint32_t> first_, around_;  // rows and entries
};

/// First and second derivative of the energy with respect to the place of one pixel.
struct GridSlope {
  Point2 gradient{0, 0};
  std::array<double, 3> hessian{0, 0, 0};  ///< uu, uv, vv; never indefinite

  /// Adds w r J and w J J^T of a residual r with derivative J.
  void add(double weight, double r, const Point2& j);
  /// The Gauss-Newton step; nothing where the energy does not say.
  [[nodiscard]] Point2 step() const;
};

/// The energy of an edge in the plane, and its slope.
/// @param tail  how much more those far off count, by the square of their strain
/// @param sign  1: the pixel is the edge's end, -1: its start
[[nodiscard]] double length_energy(const Point2& edge, double tail = 0);
void add_length(GridSlope& slope, double sign, const Point2& edge, double tail = 0);

/// The energy of an angle between two edges about a unit long. @param cosine  their product, with its derivative
[[nodiscard]] double angle_energy(double cosine);
void add_angle(GridSlope& slope, double cosine, const Point2& derivative, double weight = 1);

/// A penalty for an angle that is nearly closed or turned over. @param a, b  edges in the plane to `beside` and `below`
[[nodiscard]] double area_energy(const GridCorner& corner, const Point2& a, const Point2& b);
void add_area(GridSlope& slope, const GridCorner& corner, uint32_t pixel, const Point2& a, const Point2& b);

/// Share of a pixel in the edge from the corner's middle to `end`: 1 at its end, -1 at its start.
[[nodiscard]] inline double share_in_edge(const GridCorner& corner, uint32_t end, uint32_t pixel) {
  return pixel == end ? 1 : pixel == corner.middle ? -1 : 0;
}

}  // namespace geocloth
