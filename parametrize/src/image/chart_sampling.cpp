// SPDX-License-Identifier: GPL-3.0-or-later
//
// A free-form chart's outline pixels stand for samples of the seam that lie up to a pixel off the lattice. The grid
// beside them is relaxed (grid_relaxation.h), so that it is nearly as even there as inside. Where nothing is displaced
// (square layout) every pixel samples itself.

#include "image/chart_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "image/grid_relaxation.h"
#include "mesh/point_math.h"

namespace geocloth {
namespace {

constexpr int32_t kMargin = 4;  // [pixels] the plane may reach beyond the chain of outline pixels
constexpr int kSweeps = 20;     // over the pixels beside the outline

/// Nearest point of segment a-b to p, as its parameter.
double nearest_on_segment(const Point2& a, const Point2& b, const Point2& p) {
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double l = dx * dx + dy * dy;
  return l > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / l, 0.0, 1.0) : 0.0;
}

/// Weights of a point in a triangle of the plane; nothing outside of it.
std::optional<Point3> weights_in(const std::array<Point2, 3>& t, const Point2& p) {
  const double whole = signed_area_twice(t[0], t[1], t[2]);
  if (!(whole > 0)) return std::nullopt;
  const Point3 w{signed_area_twice(p, t[1], t[2]) / whole, signed_area_twice(t[0], p, t[2]) / whole,
                 signed_area_twice(t[0], t[1], p) / whole};
  if (w[0] >= 0 && w[1] >= 0 && w[2] >= 0) return w;
  return std::nullopt;
}

/// Weights of the point of a triangle's outline that is nearest to p in the plane, and its squared distance.
std::pair<Point3, double> nearest_on_outline(const std::array<Point2, 3>& t, const Point2& p) {
  std::pair<Point3, double> best{{1, 0, 0}, std::numeric_limits<double>::infinity()};
  for (size_t k = 0; k < 3; ++k) {
    const Point2 &a = t[k], &b = t[(k + 1) % 3];
    const double s = nearest_on_segment(a, b, p);
    const double dx = a[0] + (b[0] - a[0]) * s - p[0], dy = a[1] + (b[1] - a[1]) * s - p[1];
    if (dx * dx + dy * dy >= best.second) continue;
    Point3 w{0, 0, 0};
    w[k] = 1 - s;
    w[(k + 1) % 3] = s;
    best = {w, dx * dx + dy * dy};
  }
  return best;
}

}  // namespace

PlaneLocator::PlaneLocator(const FlatSurface& flat, const FlatChart& chart, const std::vector<uint32_t>& triangles)
    : flat_(flat),
      width_(static_cast<int32_t>(chart.width) + 2 * kMargin),
      height_(static_cast<int32_t>(chart.height) + 2 * kMargin),
      bin_(static_cast<size_t>(width_) * static_cast<size_t>(height_)) {
  const auto clamp_to = [](double x, int32_t count) {
    return std::clamp(static_cast<int32_t>(std::clamp(std::floor(x), -1e6, 1e6)) + kMargin, 0, count - 1);
  };
  for (const uint32_t t : triangles) {
    const Point2 &a = flat.uv[flat.triangle[t][0]], &b = flat.uv[flat.triangle[t][1]],
                 &c = flat.uv[flat.triangle[t][2]];
    const auto [left, right] = std::minmax({a[0], b[0], c[0]});
    const auto [top, bottom] = std::minmax({a[1], b[1], c[1]});
    for (int32_t y = clamp_to(top, height_); y <= clamp_to(bottom, height_); ++y) {
      for (int32_t x = clamp_to(left, width_); x <= clamp_to(right, width_); ++x) {
        bin_[static_cast<size_t>(y * width_ + x)].push_back(t);
      }
    }
  }
}

const std::vector<uint32_t>& PlaneLocator::bin(int32_t x, int32_t y) const {
  return bin_[static_cast<size_t>(y * width_ + x)];
}

PlanePlace PlaneLocator::locate(const Point2& place) const {
  const auto column = std::clamp(static_cast<int32_t>(std::floor(place[0])) + kMargin, 0, width_ - 1);
  const auto row = std::clamp(static_cast<int32_t>(std::floor(place[1])) + kMargin, 0, height_ - 1);
  const auto corners = [&](uint32_t t) {
    const Triangle& k = flat_.triangle[t];
    return std::array{flat_.uv[k[0]], flat_.uv[k[1]], flat_.uv[k[2]]};
  };
  for (const uint32_t t : bin(column, row)) {
    if (const auto weight = weights_in(corners(t), place)) return {t, *weight};
  }
  PlanePlace best;
  double least = std::numeric_limits<double>::infinity();
  // Rings of bins around the place, until no further ring can hold anything nearer.
  for (int32_t radius = 0; radius <= std::max(width_, height_); ++radius) {
    if (radius > 0 && least <= (radius - 1.0) * (radius - 1.0)) break;
    for (int32_t y = std::max(row - radius, 0); y <= std::min(row + radius, height_ - 1); ++y) {
      for (int32_t x = std::max(column - radius, 0); x <= std::min(column + radius, width_ - 1); ++x) {
        if (std::max(std::abs(x - column), std::abs(y - row)) != radius) continue;
        for (const uint32_t t : bin(x, y)) {
          const auto [weight, squared] = nearest_on_outline(corners(t), place);
          if (squared >= least) continue;
          least = squared;
          best = {t, weight};
          if (squared == 0) return best;
        }
      }
    }
  }
  return best;
}

std::optional<Point3> surface_point(const FlatSurface& flat, const PlanePlace& found, const Point2& place,
                                    double beside) {
  const Triangle& t = flat.triangle[found.triangle];
  Point3 position{};
  Point2 at{};
  for (size_t k = 0; k < 3; ++k) {
    position = position + flat.position[t[k]] * found.weight[k];
    for (size_t x = 0; x < 2; ++x) at[x] += found.weight[k] * flat.uv[t[k]][x];
  }
  if (std::hypot(at[0] - place[0], at[1] - place[1]) > beside) return std::nullopt;
  return position;
}

std::vector<Point2> sampling_places(const FlatSurface& flat, const FlatChart& chart) {
  std::vector<std::vector<Pixel>> chains;
  std::vector<std::vector<Point2>> places;
  bool displaced = false;
  const auto add = [&](const std::vector<OutlineSample>& loop) {
    std::vector<Pixel>& chain = chains.emplace_back();
    std::vector<Point2>& place = places.emplace_back();
    for (const OutlineSample& s : loop) {
      chain.push_back({static_cast<int32_t>(s.x), static_cast<int32_t>(s.y)});
      place.push_back(flat.uv[s.vertex]);
      displaced = displaced || place.back()[0] != s.x || place.back()[1] != s.y;
    }
  };
  add(chart.outline);
  for (const std::vector<OutlineSample>& hole : chart.holes) add(hole);
  if (!displaced) {
    std::vector<Point2> lattice;
    lattice.reserve(size_t{chart.width} * chart.height);
    for (uint32_t y = 0; y < chart.height; ++y) {
      for (uint32_t x = 0; x < chart.width; ++x) lattice.push_back({static_cast<double>(x), static_cast<double>(y)});
    }
    return lattice;
  }
  GridRelaxation grid(chains, places);
  for (int k = 0; k < kSweeps; ++k) grid.sweep();
  return grid.places();
}

}  // namespace geocloth
