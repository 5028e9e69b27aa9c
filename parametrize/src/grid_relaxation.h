// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"
#include "pixel_chain.h"

namespace geocloth {

/// Where the pixels of one chart sample its plane. Outline pixels stand off the lattice, at their samples; pixels in
/// the rings beside them are moved so that the grid's edges stay about a pixel long and meet at right angles.
class GridRelaxation {
 public:
  /// First and second derivative of the energy with respect to the place of one pixel.
  struct Slope {
    Point2 gradient{0, 0};
    std::array<double, 3> hessian{0, 0, 0};  ///< uu, uv, vv; never indefinite
  };

  /// @param chain  the pixels of the outline, closed, anticlockwise or clockwise
  /// @param place  per outline pixel: where it samples the plane [pixels]
  GridRelaxation(std::span<const Pixel> chain, std::span<const Point2> place);

  [[nodiscard]] uint32_t index(const Pixel& p) const {
    return static_cast<uint32_t>(p[1] - low_[1]) * width_ + static_cast<uint32_t>(p[0] - low_[0]);
  }
  /// Per pixel of the chain's rectangle, row by row; those outside the chain are at their lattice place.
  [[nodiscard]] const std::vector<Point2>& places() const { return place_; }
  void move(uint32_t pixel, const Point2& to) { place_[pixel] = to; }

  /// The energy of all cell corners that a pixel is part of.
  [[nodiscard]] double energy(uint32_t pixel) const;
  [[nodiscard]] Slope slope(uint32_t pixel) const;

  /// Moves every pixel of the rings beside the outline once to where its own energy is less.
  void sweep();

 private:
  /// A right angle of the grid: of a cell, or of half a cell where the outline cuts it.
  struct Corner {
    uint32_t middle, beside, below;  // pixels: the corner's, its neighbour in the row, its neighbour in the column
    double turn;                     // sign of the angle from `beside` to `below` on the lattice
  };

  void add_corners(std::span<const Pixel> chain);
  void index_corners();
  void find_rings(std::span<const Pixel> chain);
  void diffuse();
  [[nodiscard]] double energy_of(const Corner& corner) const;

  Pixel low_{}, high_{};
  uint32_t width_ = 0;
  std::vector<Point2> place_;
  std::vector<Corner> corner_;
  std::vector<uint32_t> first_, around_;  // corners that a pixel is part of, rows and entries
  std::vector<uint32_t> free_;            // pixels of the rings, from the outline inwards
};

}  // namespace geocloth
