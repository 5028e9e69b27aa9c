// SPDX-License-Identifier: GPL-3.0-or-later
//
// A free-form chart's outline pixels stand for samples of the seam that lie up to a pixel off the lattice. Carried into
// the chart by diffusion, that displacement fades out over a few rings; sampled so, the grid beside a seam is as even
// as inside. Where nothing is displaced (square layout) every pixel samples itself.

#include "chart_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "point_math.h"

namespace geocloth {
namespace {

constexpr int32_t kMargin = 4;       // [pixels] the plane may reach beyond the chain of outline pixels
constexpr int kDiffusionSteps = 12;  // displacement fades over about as many square roots of rings

/// Moves pixels inside so that no spring to a neighbour in row or column is much shorter or longer than a pixel: sweeps
/// over the springs that are, as constraints are projected in position based dynamics (Mueller et al. 2007).
/// @param place  per pixel of a rectangle `width` wide: where it samples the plane
void limit_springs(std::vector<Point2>& place, const std::vector<uint8_t>& inside, size_t width) {
  constexpr double kShortest = 0.7, kLongest = 1.4;  // [pixels]
  constexpr int kSweeps = 12;
  // Springs from inside pixels; those to the left and above belong to the neighbour when that is inside as well.
  std::vector<std::array<size_t, 2>> springs;
  for (size_t i = 0; i < place.size(); ++i) {
    if (inside[i] == 0) continue;
    springs.push_back({i, i + 1});
    springs.push_back({i, i + width});
    if (inside[i - 1] == 0) springs.push_back({i, i - 1});
    if (inside[i - width] == 0) springs.push_back({i, i - width});
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [a, b] : springs) {
      Point2 &p = place[a], &q = place[b];
      const double dx = q[0] - p[0], dy = q[1] - p[1], l = std::hypot(dx, dy);
      const double wanted = std::clamp(l, kShortest, kLongest);
      if (wanted == l || !(l > 0)) continue;
      const double share = (l - wanted) / l / (inside[b] != 0 ? 2 : 1);
      p = {p[0] + share * dx, p[1] + share * dy};
      if (inside[b] != 0) q = {q[0] - share * dx, q[1] - share * dy};
    }
  }
}

/// Nearest point of segment a-b to p, as its parameter.
double nearest_on_segment(const Point2& a, const Point2& b, const Point2& p) {
  const double dx = b[0] - a[0], dy = b[1] - a[1];
  const double l = dx * dx + dy * dy;
  return l > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / l, 0.0, 1.0) : 0.0;
}

/// Weights of the point of a triangle that is nearest to p in the plane, and its squared distance.
std::pair<Point3, double> nearest_in_triangle(const std::array<Point2, 3>& t, const Point2& p) {
  const double whole = signed_area_twice(t[0], t[1], t[2]);
  if (whole > 0) {
    const Point3 w{signed_area_twice(p, t[1], t[2]) / whole, signed_area_twice(t[0], p, t[2]) / whole,
                   signed_area_twice(t[0], t[1], p) / whole};
    if (w[0] >= 0 && w[1] >= 0 && w[2] >= 0) return {w, 0.0};
  }
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
  PlanePlace best;
  double least = std::numeric_limits<double>::infinity();
  // Rings of bins around the place, until no further ring can hold anything nearer.
  for (int32_t radius = 0; radius <= std::max(width_, height_); ++radius) {
    if (radius > 0 && least <= (radius - 1.0) * (radius - 1.0)) break;
    for (int32_t y = std::max(row - radius, 0); y <= std::min(row + radius, height_ - 1); ++y) {
      for (int32_t x = std::max(column - radius, 0); x <= std::min(column + radius, width_ - 1); ++x) {
        if (std::max(std::abs(x - column), std::abs(y - row)) != radius) continue;
        for (const uint32_t t : bin(x, y)) {
          const Triangle& k = flat_.triangle[t];
          const auto [weight, squared] = nearest_in_triangle({flat_.uv[k[0]], flat_.uv[k[1]], flat_.uv[k[2]]}, place);
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

std::vector<Point2> sampling_places(const FlatSurface& flat, const FlatChart& chart,
                                    const std::vector<uint8_t>& inside) {
  const size_t width = chart.width, height = chart.height;
  std::vector<Point2> shift(width * height, Point2{0, 0});
  bool displaced = false;
  std::vector<uint8_t> outline(shift.size(), 0);
  for (const OutlineSample& s : chart.outline) {
    const size_t i = s.y * width + s.x;
    shift[i] = {flat.uv[s.vertex][0] - s.x, flat.uv[s.vertex][1] - s.y};
    outline[i] = 1;
    displaced = displaced || shift[i][0] != 0 || shift[i][1] != 0;
  }
  if (displaced) {
    std::vector<Point2> next = shift;
    for (int step = 0; step < kDiffusionSteps; ++step) {
      for (size_t y = 1; y + 1 < height; ++y) {
        for (size_t x = 1; x + 1 < width; ++x) {
          const size_t i = y * width + x;
          if (inside[i] == 0) continue;
          // All four neighbours of a pixel strictly inside are inside or on the outline.
          for (size_t k = 0; k < 2; ++k) {
            next[i][k] = (shift[i - 1][k] + shift[i + 1][k] + shift[i - width][k] + shift[i + width][k]) / 4;
          }
        }
      }
      shift.swap(next);
    }
  }
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      Point2& p = shift[y * width + x];
      p = {static_cast<double>(x) + p[0], static_cast<double>(y) + p[1]};
    }
  }
  if (displaced) limit_springs(shift, inside, width);
  return shift;
}

}  // namespace geocloth
