// SPDX-License-Identifier: GPL-3.0-or-later
// An elastic grid: every right angle of it has an energy for the length of its two edges and for its angle, which is
// minimised pixel by pixel with Gauss-Newton steps. Angles are counted by an almost linear norm (Charbonnier): where
// the outline runs askew some cell has to be askew too, and one such cell is better than four that are so a little.

#include "grid_relaxation.h"

#include <algorithm>
#include <cmath>

#include "cell_halves.h"

namespace geocloth {
namespace {

constexpr double kAngle = 2;           // weight of angles beside lengths
constexpr double kBend = 0.1;          // [cosine] from here on the norm is linear
constexpr double kLeastArea = 0.5;     // [pixels^2] of an angle's parallelogram; below, a penalty sets in
constexpr double kAreaWeight = 4;      // of that penalty
constexpr double kLeastSquare = 0.01;  // [pixels^2] of an edge's length, against division by nothing
constexpr int kBand = 8;               // [rings] that move
constexpr int kDiffusionSteps = 12;

/// Sum of w r J and of w J J^T over residuals r with derivative J.
void add_residual(GridRelaxation::Slope& s, double weight, double r, const Point2& j) {
  s.gradient = {s.gradient[0] + weight * r * j[0], s.gradient[1] + weight * r * j[1]};
  s.hessian = {s.hessian[0] + weight * j[0] * j[0], s.hessian[1] + weight * j[0] * j[1],
               s.hessian[2] + weight * j[1] * j[1]};
}

Point2 operator-(const Point2& a, const Point2& b) {
  return {a[0] - b[0], a[1] - b[1]};
}

double dot(const Point2& a, const Point2& b) {
  return a[0] * b[0] + a[1] * b[1];
}

/// (l - 1 / l) / 2 of an edge's length: its square is the symmetric Dirichlet energy of one direction.
double strain(const Point2& edge) {
  const double l = std::sqrt(std::max(dot(edge, edge), kLeastSquare));
  return (l - 1 / l) / 2;
}

void add_strain(GridRelaxation::Slope& s, double sign, const Point2& edge) {
  const double squared = std::max(dot(edge, edge), kLeastSquare), l = std::sqrt(squared);
  const double slope = sign * (1 + 1 / squared) / (2 * l);
  add_residual(s, 1, (l - 1 / l) / 2, {slope * edge[0], slope * edge[1]});
}

}  // namespace

GridRelaxation::GridRelaxation(std::span<const Pixel> chain, std::span<const Point2> place) {
  low_ = high_ = chain[0];
  for (const Pixel& p : chain) {
    low_ = {std::min(low_[0], p[0]), std::min(low_[1], p[1])};
    high_ = {std::max(high_[0], p[0]), std::max(high_[1], p[1])};
  }
  width_ = static_cast<uint32_t>(high_[0] - low_[0] + 1);
  for (int32_t y = low_[1]; y <= high_[1]; ++y) {
    for (int32_t x = low_[0]; x <= high_[0]; ++x) place_.push_back({static_cast<double>(x), static_cast<double>(y)});
  }
  for (size_t i = 0; i < chain.size(); ++i) place_[index(chain[i])] = place[i];
  add_corners(chain);
  index_corners();
  find_rings(chain);
  diffuse();
}

void GridRelaxation::add_corners(std::span<const Pixel> chain) {
  const CellHalves cells(chain);
  const auto add = [&](const Pixel& at, int32_t dx, int32_t dy) {
    corner_.push_back(
        {index(at), index({at[0] + dx, at[1]}), index({at[0], at[1] + dy}), static_cast<double>(dx * dy)});
  };
  // Only those beside the pixels that move: the others take no part.
  std::vector<uint8_t> near(place_.size(), 0);
  for (const Pixel& p : chain) {
    const int32_t right = std::min(p[0] + kBand, high_[0] - 1), bottom = std::min(p[1] + kBand, high_[1] - 1);
    for (int32_t y = std::max(p[1] - kBand - 1, low_[1]); y <= bottom; ++y) {
      for (int32_t x = std::max(p[0] - kBand - 1, low_[0]); x <= right; ++x) near[index({x, y})] = 1;
    }
  }
  for (int32_t y = low_[1]; y < high_[1]; ++y) {
    for (int32_t x = low_[0]; x < high_[0]; ++x) {
      if (near[index({x, y})] == 0) continue;
      const CellHalves::Cell cell = cells.get({x, y});
      // Of the half below a diagonal that falls, only the lower left corner is a right angle, and so on.
      using Diagonal = CellHalves::Diagonal;
      if (cell.left && cell.diagonal != Diagonal::right) add({x, y}, 1, 1);
      if (cell.left && cell.diagonal != Diagonal::left) add({x, y + 1}, 1, -1);
      if (cell.right && cell.diagonal != Diagonal::left) add({x + 1, y}, -1, 1);
      if (cell.right && cell.diagonal != Diagonal::right) add({x + 1, y + 1}, -1, -1);
    }
  }
}

void GridRelaxation::index_corners() {
  first_.assign(place_.size() + 1, 0);
  for (const Corner& c : corner_) {
    for (const uint32_t p : {c.middle, c.beside, c.below}) ++first_[p + 1];
  }
  for (size_t i = 0; i < place_.size(); ++i) first_[i + 1] += first_[i];
  around_.resize(first_.back());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (uint32_t k = 0; k < corner_.size(); ++k) {
    for (const uint32_t p : {corner_[k].middle, corner_[k].beside, corner_[k].below}) around_[next[p]++] = k;
  }
}

void GridRelaxation::find_rings(std::span<const Pixel> chain) {
  std::vector<uint8_t> met(place_.size(), 0);
  std::vector<uint32_t> ring;
  for (const Pixel& p : chain) {
    ring.push_back(index(p));
    met[ring.back()] = 1;
  }
  for (int k = 0; k < kBand && !ring.empty(); ++k) {
    std::vector<uint32_t> next;
    for (const uint32_t p : ring) {
      for (uint32_t a = first_[p]; a < first_[p + 1]; ++a) {
        const Corner& c = corner_[around_[a]];
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

double GridRelaxation::energy_of(const Corner& corner) const {
  const Point2 a = place_[corner.beside] - place_[corner.middle], b = place_[corner.below] - place_[corner.middle];
  const double along = strain(a), down = strain(b), cosine = dot(a, b);
  const double lack = std::max(0.0, kLeastArea - corner.turn * (a[0] * b[1] - a[1] * b[0]));
  return along * along + down * down + kAreaWeight * lack * lack +
         kAngle * 2 * kBend * (std::sqrt(cosine * cosine + kBend * kBend) - kBend);
}

double GridRelaxation::energy(uint32_t pixel) const {
  double sum = 0;
  for (uint32_t k = first_[pixel]; k < first_[pixel + 1]; ++k) sum += energy_of(corner_[around_[k]]);
  return sum;
}

GridRelaxation::Slope GridRelaxation::slope(uint32_t pixel) const {
  Slope s;
  for (uint32_t k = first_[pixel]; k < first_[pixel + 1]; ++k) {
    const Corner& c = corner_[around_[k]];
    const Point2 a = place_[c.beside] - place_[c.middle], b = place_[c.below] - place_[c.middle];
    // Share of the pixel in either edge: 1 at its end, -1 at its start.
    const double in_a = pixel == c.beside ? 1 : pixel == c.middle ? -1 : 0;
    const double in_b = pixel == c.below ? 1 : pixel == c.middle ? -1 : 0;
    if (in_a != 0) add_strain(s, in_a, a);
    if (in_b != 0) add_strain(s, in_b, b);
    const double cosine = dot(a, b);
    const double weight = kAngle * kBend / std::sqrt(cosine * cosine + kBend * kBend);
    add_residual(s, weight, cosine, {in_a * b[0] + in_b * a[0], in_a * b[1] + in_b * a[1]});
    const double lack = kLeastArea - c.turn * (a[0] * b[1] - a[1] * b[0]);
    if (lack > 0) {
      add_residual(s, kAreaWeight, lack,
                   {-c.turn * (in_a * b[1] - in_b * a[1]), -c.turn * (in_b * a[0] - in_a * b[0])});
    }
  }
  return s;
}

void GridRelaxation::sweep() {
  for (const uint32_t pixel : free_) {
    const Slope s = slope(pixel);
    const auto [uu, uv, vv] = s.hessian;
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 0)) continue;
    const Point2 step{(uv * s.gradient[1] - vv * s.gradient[0]) / determinant,
                      (uv * s.gradient[0] - uu * s.gradient[1]) / determinant};
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
