// SPDX-License-Identifier: GPL-3.0-or-later
// The elastic grid of grid_energy.h, minimised pixel by pixel with Gauss-Newton steps.

#include "image/grid_relaxation.h"

#include <algorithm>
#include <cmath>

#include "image/cell_halves.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr int kBand = 8;  // [rings] that move
constexpr int kDiffusionSteps = 12;

}  // namespace

GridRelaxation::GridRelaxation(std::span<const std::vector<Pixel>> chains,
                               std::span<const std::vector<Point2>> places) {
  low_ = high_ = chains[0][0];
  for (const Pixel& p : chains[0]) {
    low_ = {std::min(low_[0], p[0]), std::min(low_[1], p[1])};
    high_ = {std::max(high_[0], p[0]), std::max(high_[1], p[1])};
  }
  width_ = static_cast<uint32_t>(high_[0] - low_[0] + 1);
  for (int32_t y = low_[1]; y <= high_[1]; ++y) {
    for (int32_t x = low_[0]; x <= high_[0]; ++x) place_.push_back({static_cast<double>(x), static_cast<double>(y)});
  }
  for (size_t c = 0; c < chains.size(); ++c) {
    for (size_t i = 0; i < chains[c].size(); ++i) place_[index(chains[c][i])] = places[c][i];
  }
  add_corners(chains);
  find_rings(chains);
  diffuse();
}

void GridRelaxation::add_corners(std::span<const std::vector<Pixel>> chains) {
  const CellHalves cells(chains);
  std::vector<GridCorner> corner;
  const auto add = [&](const Pixel& at, int32_t dx, int32_t dy) {
    corner.push_back({index(at), index({at[0] + dx, at[1]}), index({at[0], at[1] + dy}), static_cast<double>(dx * dy)});
  };
  // Only those beside the pixels that move: the others take no part.
  std::vector<uint8_t> near(place_.size(), 0);
  for (const std::vector<Pixel>& chain : chains) {
    for (const Pixel& p : chain) {
      const int32_t right = std::min(p[0] + kBand, high_[0] - 1), bottom = std::min(p[1] + kBand, high_[1] - 1);
      for (int32_t y = std::max(p[1] - kBand - 1, low_[1]); y <= bottom; ++y) {
        for (int32_t x = std::max(p[0] - kBand - 1, low_[0]); x <= right; ++x) near[index({x, y})] = 1;
      }
    }
  }
  for (int32_t y = low_[1]; y < high_[1]; ++y) {
    for (int32_t x = low_[0]; x < high_[0]; ++x) {
      if (near[index({x, y})] != 0) cells.for_right_angles({x, y}, add);
    }
  }
  corners_ = GridCorners(std::move(corner), place_.size());
}

void GridRelaxation::find_rings(std::span<const std::vector<Pixel>> chains) {
  std::vector<uint8_t> met(place_.size(), 0);
  std::vector<uint32_t> ring;
  for (const std::vector<Pixel>& chain : chains) {
    for (const Pixel& p : chain) {
      ring.push_back(index(p));
      met[ring.back()] = 1;
    }
  }
  for (int k = 0; k < kBand && !ring.empty(); ++k) {
    std::vector<uint32_t> next;
    for (const uint32_t p : ring) {
      for (const uint32_t corner : corners_.around(p)) {
        const GridCorner& c = corners_[corner];
        for (const uint32_t q : {c.middle, c.beside, c.below}) {
          if (met[q] == 0) next.push_back(q);
          met[q] = 1;
        }
      }
    }
    std::sort(next.begin(), next.end());
    free_.insert(free_.end(), next.begin(), next.end());
    ring = std::move(next);
  }
}

/// A start: the displacement of the outline fades out over a few rings.
void GridRelaxation::diffuse() {
  const auto lattice = [&](uint32_t i) -> Point2 {
    return {static_cast<double>(low_[0] + static_cast<int32_t>(i % width_)),
            static_cast<double>(low_[1] + static_cast<int32_t>(i / width_))};
  };
  std::vector<Point2> shift(place_.size());
  for (uint32_t i = 0; i < place_.size(); ++i) shift[i] = place_[i] - lattice(i);
  std::vector<Point2> next = shift;
  for (int step = 0; step < kDiffusionSteps; ++step) {
    for (const uint32_t i : free_) {
      // All four neighbours of a pixel strictly inside are inside or on the outline.
      for (size_t k = 0; k < 2; ++k) {
        next[i][k] = (shift[i - 1][k] + shift[i + 1][k] + shift[i - width_][k] + shift[i + width_][k]) / 4;
      }
    }
    for (const uint32_t i : free_) shift[i] = next[i];
  }
  for (const uint32_t i : free_) {
    const Point2 at = lattice(i);
    place_[i] = {at[0] + shift[i][0], at[1] + shift[i][1]};
  }
}

double GridRelaxation::energy_of(const GridCorner& corner) const {
  const Point2 a = place_[corner.beside] - place_[corner.middle], b = place_[corner.below] - place_[corner.middle];
  return length_energy(a) + length_energy(b) + area_energy(corner, a, b) + angle_energy(dot(a, b));
}

double GridRelaxation::energy(uint32_t pixel) const {
  double sum = 0;
  for (const uint32_t k : corners_.around(pixel)) sum += energy_of(corners_[k]);
  return sum;
}

GridSlope GridRelaxation::slope(uint32_t pixel) const {
  GridSlope s;
  for (const uint32_t k : corners_.around(pixel)) {
    const GridCorner& c = corners_[k];
    const Point2 a = place_[c.beside] - place_[c.middle], b = place_[c.below] - place_[c.middle];
    const double in_a = share_in_edge(c, c.beside, pixel), in_b = share_in_edge(c, c.below, pixel);
    if (in_a != 0) add_length(s, in_a, a);
    if (in_b != 0) add_length(s, in_b, b);
    add_angle(s, dot(a, b), {in_a * b[0] + in_b * a[0], in_a * b[1] + in_b * a[1]});
    add_area(s, c, pixel, a, b);
  }
  return s;
}

void GridRelaxation::sweep() {
  for (const uint32_t pixel : free_) {
    const Point2 step = slope(pixel).step();
    constexpr double kStill = 1e-3;
    if (std::abs(step[0]) + std::abs(step[1]) < kStill) continue;
    const Point2 old = place_[pixel];
    const double before = energy(pixel);
    for (const double share : {1.0, 0.5, 0.25, 0.125}) {
      place_[pixel] = {old[0] + share * step[0], old[1] + share * step[1]};
      if (energy(pixel) < before) break;
      place_[pixel] = old;
    }
  }
}

}  // namespace geocloth
