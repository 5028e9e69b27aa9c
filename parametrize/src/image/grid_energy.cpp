// SPDX-License-Identifier: GPL-3.0-or-later
// The energy of an elastic grid: every right angle of it has one for the length of its two edges and for its angle.
// Angles are counted by a norm that gives up on the few that cannot be mended (Cauchy): where the outline runs askew
// some cell has to be askew too, and one such cell is better than four that are so a little.
#include "image/grid_energy.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr double kAngle = 4;           // weight of angles beside lengths
constexpr double kBend = 0.1;          // [cosine] from here on an angle counts less and less
constexpr double kLeastArea = 0.5;     // [pixels^2] of an angle's parallelogram; below, a penalty sets in
constexpr double kAreaWeight = 4;      // of that penalty
constexpr double kLeastSquare = 0.01;  // [pixels^2] of an edge's length, against division by nothing

double lacking_area(const GridCorner& corner, const Point2& a, const Point2& b) {
  return kLeastArea - corner.turn * (a[0] * b[1] - a[1] * b[0]);
}

}  // namespace

GridCorners::GridCorners(std::vector<GridCorner> corner, size_t pixel_count)
    : corner_(std::move(corner)), first_(pixel_count + 1, 0) {
  for (const GridCorner& c : corner_) {
    for (const uint32_t p : {c.middle, c.beside, c.below}) ++first_[p + 1];
  }
  for (size_t i = 0; i < pixel_count; ++i) first_[i + 1] += first_[i];
  around_.resize(first_.back());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (uint32_t k = 0; k < corner_.size(); ++k) {
    for (const uint32_t p : {corner_[k].middle, corner_[k].beside, corner_[k].below}) around_[next[p]++] = k;
  }
}

void GridSlope::add(double weight, double r, const Point2& j) {
  gradient = {gradient[0] + weight * r * j[0], gradient[1] + weight * r * j[1]};
  hessian = {hessian[0] + weight * j[0] * j[0], hessian[1] + weight * j[0] * j[1], hessian[2] + weight * j[1] * j[1]};
}

Point2 GridSlope::step() const {
  const auto [uu, uv, vv] = hessian;
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 0)) return {0, 0};
  return {(uv * gradient[1] - vv * gradient[0]) / determinant, (uv * gradient[0] - uu * gradient[1]) / determinant};
}

/// ((l - 1 / l) / 2)^2 of an edge's length is the symmetric Dirichlet energy of one direction.
double length_energy(const Point2& edge, double tail) {
  const double l = std::sqrt(std::max(dot(edge, edge), kLeastSquare)), strain = (l - 1 / l) / 2;
  return strain * strain * (1 + tail * strain * strain);
}

void add_length(GridSlope& slope, double sign, const Point2& edge, double tail) {
  const double squared = std::max(dot(edge, edge), kLeastSquare), l = std::sqrt(squared);
  const double rise = sign * (1 + 1 / squared) / (2 * l);
  const double strain = (l - 1 / l) / 2;
  slope.add(1 + 2 * tail * strain * strain, strain, {rise * edge[0], rise * edge[1]});
}

double angle_energy(double cosine) {
  return kAngle * kBend * kBend * std::log1p(cosine * cosine / (kBend * kBend));
}

void add_angle(GridSlope& slope, double cosine, const Point2& derivative, double weight) {
  slope.add(weight * kAngle / (1 + cosine * cosine / (kBend * kBend)), cosine, derivative);
}

double area_energy(const GridCorner& corner, const Point2& a, const Point2& b) {
  const double lack = std::max(0.0, lacking_area(corner, a, b));
  return kAreaWeight * lack * lack;
}

void add_area(GridSlope& slope, const GridCorner& corner, uint32_t pixel, const Point2& a, const Point2& b) {
  const double lack = lacking_area(corner, a, b);
  if (lack <= 0) return;
  const double in_a = share_in_edge(corner, corner.beside, pixel), in_b = share_in_edge(corner, corner.below, pixel);
  slope.add(kAreaWeight, lack,
            {-corner.turn * (in_a * b[1] - in_b * a[1]), -corner.turn * (in_b * a[0] - in_a * b[0])});
}

}  // namespace geocloth
