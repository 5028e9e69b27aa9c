// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geocloth/parametrize/mesh.h"
#include "image/grid_energy.h"
#include "image/pixel_chain.h"

namespace geocloth {

/// Where the pixels of one chart sample its plane. Outline pixels stand off the lattice, at their samples; pixels in
/// the rings beside them are moved so that the grid's edges stay about a pixel long and meet at right angles.
class GridRelaxation {
 public:
  /// @param chain  the pixels of the outline, closed, anticlockwise or clockwise
  /// @param place  per outline pixel: where it samples the plane [pixels]
  GridRelaxation(const std::vector<Pixel>& chain, const std::vector<Point2>& place)
      : GridRelaxation(std::span(&chain, 1), std::span(&place, 1)) {}
  /// @param chains  the outline's, and those around the holes inside of it
  GridRelaxation(std::span<const std::vector<Pixel>> chains, std::span<const std::vector<Point2>> places);

  [[nodiscard]] uint32_t index(const Pixel& p) const {
    return static_cast<uint32_t>(p[1] - low_[1]) * width_ + static_cast<uint32_t>(p[0] - low_[0]);
  }
  /// Per pixel of the chain's rectangle, row by row; those outside the chain are at their lattice place.
  [[nodiscard]] const std::vector<Point2>& places() const { return place_; }
  void move(uint32_t pixel, const Point2& to) { place_[pixel] = to; }

  /// The energy of all cell corners that a pixel is part of.
  [[nodiscard]] double energy(uint32_t pixel) const;
  [[nodiscard]] GridSlope slope(uint32_t pixel) const;

  /// Moves every pixel of the rings beside the outline once to where its own energy is less.
  void sweep();

 private:
  void add_corners(std::span<const std::vector<Pixel>> chains);
  void find_rings(std::span<const std::vector<Pixel>> chains);
  void diffuse();
  [[nodiscard]] double energy_of(const GridCorner& corner) const;

  Pixel low_{}, high_{};
  uint32_t width_ = 0;
  std::vector<Point2> place_;
  GridCorners corners_;
  std::vector<uint32_t> free_;  // pixels of the rings, from the outline inwards
};

}  // namespace geocloth
