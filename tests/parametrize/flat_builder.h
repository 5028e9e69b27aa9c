// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "geocloth/parametrize/flatten.h"

namespace geocloth::test {

/// Surfaces that are flat already, made by hand: squares of n x n pixels side by side in one atlas, each with a flat
/// mesh that has a vertex on every outline pixel. What is glued to what is said by labels of the outline pixels.
class FlatBuilder {
 public:
  /// Equal labels are one surface point. A label also says which sheet of the clean surface the pixel is on.
  struct Label {
    int64_t point;
    int sheet = 0;
    auto operator<=>(const Label&) const = default;
  };
  using Labels = std::function<Label(uint32_t x, uint32_t y)>;  ///< asked for outline pixels only
  using Shape = std::function<Point3(double u, double v)>;      ///< chart position to space

  /// @param jitter  how far interior vertices stand from the pixels [pixels], below 0.3
  void add_square(uint32_t n, const Labels& labels, const Shape& shape, double jitter = 0.2) {
    const auto index = static_cast<uint32_t>(flat.charts.size());
    FlatChart chart;
    chart.x0 = flat.width;
    chart.width = chart.height = n;
    flat.width += n;
    flat.height = std::max(flat.height, n);
    const auto first = static_cast<uint32_t>(flat.position.size());
    for (uint32_t y = 0; y < n; ++y) {
      for (uint32_t x = 0; x < n; ++x) {
        const bool border = x == 0 || y == 0 || x + 1 == n || y + 1 == n;
        Point2 uv{static_cast<double>(x), static_cast<double>(y)};
        if (!border) {
          uv[0] += jitter * std::sin(12.9 * x + 78.2 * y);
          uv[1] += jitter * std::sin(39.3 * x + 11.1 * y);
        }
        add_vertex(uv, shape, border ? labels(x, y) : Label{--interior_});
      }
    }
    for (uint32_t y = 0; y + 1 < n; ++y) {
      for (uint32_t x = 0; x + 1 < n; ++x) {
        const uint32_t a = first + y * n + x, b = a + 1, c = a + n, d = c + 1;
        add_triangle({a, c, d}, index);
        add_triangle({a, d, b}, index);
      }
    }
    const auto sample = [&](uint32_t x, uint32_t y) { chart.outline.push_back({x, y, first + y * n + x}); };
    for (uint32_t y = 0; y + 1 < n; ++y) sample(0, y);  // down the left side: counter-clockwise seen with v up
    for (uint32_t x = 0; x + 1 < n; ++x) sample(x, n - 1);
    for (uint32_t y = n - 1; y > 0; --y) sample(n - 1, y);
    for (uint32_t x = n - 1; x > 0; --x) sample(x, 0);
    flat.charts.push_back(chart);
  }

  FlatSurface flat;
  CleanSurface clean;

 private:
  void add_vertex(const Point2& uv, const Shape& shape, const Label& label) {
    const auto [point, is_new] = points_.try_emplace(label.point, static_cast<uint32_t>(points_.size()));
    if (is_new) position_.push_back(shape(uv[0], uv[1]));
    const auto [vertex, is_new_vertex] = vertices_.try_emplace(label, static_cast<uint32_t>(vertices_.size()));
    if (is_new_vertex) {
      clean.position.push_back(position_[point->second]);
      clean.point.push_back(point->second);
    }
    flat.uv.push_back(uv);
    flat.position.push_back(position_[point->second]);
    flat.point.push_back(point->second);
    flat.clean_vertex.push_back(vertex->second);
    flat.point_count = clean.point_count = static_cast<uint32_t>(points_.size());
  }

  void add_triangle(const Triangle& t, uint32_t chart) {
    flat.clean_triangle.push_back(static_cast<uint32_t>(flat.triangle.size()));
    flat.triangle.push_back(t);
    flat.chart.push_back(chart);
    clean.triangle.push_back({flat.clean_vertex[t[0]], flat.clean_vertex[t[1]], flat.clean_vertex[t[2]]});
    clean.component.push_back(0);
    clean.component_count = 1;
    clean.source_triangle.push_back(flat.clean_triangle.back());
  }

  int64_t interior_ = 0;
  std::map<int64_t, uint32_t> points_;
  std::map<Label, uint32_t> vertices_;
  std::vector<Point3> position_;
};

/// Labels that glue nothing.
inline FlatBuilder::Labels apart(int64_t base = 0) {
  return [=](uint32_t x, uint32_t y) { return FlatBuilder::Label{base + int64_t{y} * 100000 + x}; };
}
inline int64_t outline_label(int64_t x, int64_t y) {
  return y * 100000 + x;
}

inline FlatBuilder sheet(uint32_t n, double size = 1, double jitter = 0.2) {
  FlatBuilder b;
  b.add_square(
      n, apart(),
      [=](double u, double v) {
        return Point3{u * size / (n - 1), -v * size / (n - 1), 0};
      },
      jitter);
  return b;
}

/// Tube around the y axis, cut open along a line: left and right side are mates.
inline FlatBuilder tube(uint32_t n, double radius = 1, double height = 2) {
  FlatBuilder b;
  b.add_square(
      n, [=](uint32_t x, uint32_t y) { return FlatBuilder::Label{outline_label(x + 1 == n ? 0 : x, y)}; },
      [=](double u, double v) {
        const double angle = 2 * std::numbers::pi * u / (n - 1);
        return Point3{radius * std::cos(angle), -height * v / (n - 1), -radius * std::sin(angle)};
      });
  return b;
}

/// Left and right side are mates, top and bottom are folded on themselves: two cut ends, in the middle of top and
/// bottom. n must be odd.
inline FlatBuilder closed_sphere(uint32_t n) {
  FlatBuilder b;
  b.add_square(
      n,
      [=](uint32_t x, uint32_t y) {
        if (y == 0 || y + 1 == n) return FlatBuilder::Label{outline_label(std::min(x, n - 1 - x), y)};
        return FlatBuilder::Label{outline_label(x + 1 == n ? 0 : x, y)};
      },
      [=](double u, double v) {
        // The fold is a straight edge of length pi / 2 on the sphere's top: a pillow of two sides.
        const double s = 2 * u / (n - 1) - 1, t = 2 * v / (n - 1) - 1;
        const double half = 1 - std::abs(s), side = s < 0 ? 1 : -1;
        return Point3{half, -t, side * std::sin(std::numbers::pi * half) * (1 - t * t)};
      });
  return b;
}

inline FlatBuilder torus(uint32_t n) {
  FlatBuilder b;
  b.add_square(
      n,
      [=](uint32_t x, uint32_t y) { return FlatBuilder::Label{outline_label(x + 1 == n ? 0 : x, y + 1 == n ? 0 : y)}; },
      [=](double u, double v) {
        const double p = 2 * std::numbers::pi * u / (n - 1), q = 2 * std::numbers::pi * v / (n - 1);
        return Point3{(2 + std::cos(q)) * std::cos(p), std::sin(q), (2 + std::cos(q)) * std::sin(p)};
      });
  return b;
}

/// Left and right side are mates upside down.
inline FlatBuilder moebius(uint32_t n) {
  FlatBuilder b;
  b.add_square(
      n,
      [=](uint32_t x, uint32_t y) {
        return FlatBuilder::Label{x + 1 == n ? outline_label(0, n - 1 - y) : outline_label(x, y)};
      },
      [=](double u, double v) {
        const double p = 2 * std::numbers::pi * u / (n - 1), q = v / (n - 1) - 0.5;
        return Point3{(2 + q * std::cos(p / 2)) * std::cos(p), q * std::sin(p / 2),
                      (2 + q * std::cos(p / 2)) * std::sin(p)};
      });
  return b;
}

/// `wings` sheets that hang on one edge x = z = 0, fanned out. The first two belong to one sheet of the clean surface.
inline FlatBuilder fan(uint32_t n, uint32_t wings) {
  FlatBuilder b;
  for (uint32_t w = 0; w < wings; ++w) {
    const double angle = std::numbers::pi * w;
    const double lift = w < 2 ? 0 : 0.5 * w;
    b.add_square(
        n,
        [=](uint32_t x, uint32_t y) {
          const bool seam = w == 0 ? x + 1 == n : x == 0;
          const int sheet = w < 2 ? 0 : static_cast<int>(w);
          return seam ? FlatBuilder::Label{y, sheet}
                      : FlatBuilder::Label{int64_t{w + 1} * 100000000 + outline_label(x, y), sheet};
        },
        [=](double u, double v) {
          const double out = w == 0 ? (n - 1 - u) / (n - 1) : u / (n - 1);
          return Point3{-out * std::cos(angle), -v / (n - 1), out * lift};
        });
  }
  return b;
}

}  // namespace geocloth::test
