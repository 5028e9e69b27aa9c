// SPDX-License-Identifier: GPL-3.0-or-later
// Sampling of the charts at the pixels (Gu, Gortler, Hoppe 2002, section 3.3). Every flat triangle is scan-converted;
// a pixel on an edge or a vertex goes to exactly one triangle because the signs are exact and ties are broken as if
// the pixel were moved by an infinitesimal step (the rule that graphics hardware calls "top-left"). So a pixel that
// two triangles claim is a true overlap. Outline pixels are not interpolated at all: they are their vertex.
#include "geocloth/parametrize/rasterize.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <tbb/parallel_for.h>

#include "geocloth/asset/error.h"
#include "image/chart_outline.h"
#include "image/chart_sampling.h"
#include "mesh/point_math.h"
#include "mesh/predicates.h"

namespace geocloth {
namespace {

struct FlatTriangle {
  std::array<Point2, 3> uv;
};

/// The part of row v that the triangle may cover, widened by a rounding margin; empty when first > second.
std::array<double, 2> row_span(const FlatTriangle& t, double v) {
  constexpr double kTouch = 1e-6;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point2 &a = t.uv[k], &b = t.uv[(k + 1) % 3];
    if (std::min(a[1], b[1]) > v || std::max(a[1], b[1]) < v) continue;
    const double height = b[1] - a[1];
    if (height == 0) {
      low = std::min({low, a[0], b[0]});
      high = std::max({high, a[0], b[0]});
    } else {
      const double u = a[0] + (b[0] - a[0]) * ((v - a[1]) / height);
      low = std::min(low, u);
      high = std::max(high, u);
    }
  }
  return {low - kTouch, high + kTouch};
}

/// The lattice positions from `first` up to but without `end`; none when first >= end.
struct LatticeSpan {
  uint32_t first;
  uint32_t end;
};

/// Those of 0 .. count - 1 that lie in [low, high].
LatticeSpan lattice_span(double low, double high, uint32_t count) {
  const auto within = [count](double x) {
    return static_cast<uint32_t>(std::clamp(x, 0.0, static_cast<double>(count)));
  };
  return {within(std::ceil(low)), within(std::floor(high) + 1)};
}

/// Does the triangle, of orientation `sign`, own the pixel p?
bool owns(const FlatTriangle& t, int sign, const Point2& p) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Point2 &a = t.uv[k], &b = t.uv[(k + 1) % 3];
    const int side = sign * orientation(a, b, p);
    if (side < 0) return false;
    if (side > 0) continue;
    const double du = sign * (b[0] - a[0]), dv = sign * (b[1] - a[1]);
    if (dv < 0 || (dv == 0 && du < 0)) return false;
  }
  return true;
}

/// Barycentric coordinates of a point that lies in the triangle up to rounding: none is negative, their sum is 1.
Point3 weights_inside(const FlatTriangle& t, const Point2& p) {
  const double whole = signed_area_twice(t.uv[0], t.uv[1], t.uv[2]);
  Point3 w{signed_area_twice(p, t.uv[1], t.uv[2]) / whole, signed_area_twice(t.uv[0], p, t.uv[2]) / whole,
           signed_area_twice(t.uv[0], t.uv[1], p) / whole};
  for (double& x : w) x = std::max(x, 0.0);
  return w * (1 / (w[0] + w[1] + w[2]));
}

class Rasterizer {
 public:
  explicit Rasterizer(const FlatSurface& flat) : flat_(flat) {
    if (flat.charts.size() >= kNoChart) {
      throw Error(ErrorCode::limit, "the surface falls into " + std::to_string(flat.charts.size()) +
                                        " charts; an image holds at most " + std::to_string(kNoChart - 1) +
                                        ": remove loose parts from the mesh");
    }
    const std::size_t count = std::size_t{flat.width} * flat.height;
    out_.width = flat.width;
    out_.height = flat.height;
    out_.position.assign(count, Point3{});
    out_.chart.assign(count, kNoChart);
    out_.triangle.assign(count, kNone);
    out_.point.assign(count, kNone);
    out_.vertex.assign(count, kNone);
    out_.place.assign(count, Point2{});
    overlapping_.assign(count, false);
  }

  void sample_outlines() {
    for (std::size_t c = 0; c < flat_.charts.size(); ++c) {
      const FlatChart& chart = flat_.charts[c];
      if (chart.x0 + chart.width > flat_.width || chart.y0 + chart.height > flat_.height) {
        throw Error(ErrorCode::invalid_argument, "chart " + std::to_string(c) + " leaves the atlas");
      }
      for_outline_steps(chart, [&](const OutlineSample& sample, const OutlineSample&) {
        if (sample.x >= chart.width || sample.y >= chart.height || sample.vertex >= flat_.position.size()) {
          throw Error(ErrorCode::invalid_argument, "an outline sample of chart " + std::to_string(c) + " leaves it");
        }
        const std::size_t pixel = pixel_of(chart, sample.x, sample.y);
        if (out_.chart[pixel] != kNoChart) {
          overlapping_[pixel] = true;
          return;
        }
        out_.chart[pixel] = static_cast<uint16_t>(c);
        out_.position[pixel] = flat_.position[sample.vertex];
        out_.point[pixel] = flat_.point[sample.vertex];
        out_.vertex[pixel] = sample.vertex;
      });
    }
    give_outlines_a_triangle();
  }

  /// Gives the pixels inside every chart's outline polygon to it.
  void fill_outlines() {
    for (std::size_t c = 0; c < flat_.charts.size(); ++c) {
      const FlatChart& chart = flat_.charts[c];
      const std::vector<std::vector<uint32_t>> crossing = row_crossings(chart);
      for (uint32_t y = 0; y < chart.height; ++y) {
        for (std::size_t k = 0; k + 1 < crossing[y].size(); k += 2) {
          for (uint32_t x = crossing[y][k]; x <= crossing[y][k + 1]; ++x) take(pixel_of(chart, x, y), c);
        }
      }
    }
  }

  void sample_triangle(uint32_t index) {
    const uint32_t c = flat_.chart[index];
    const FlatChart& chart = flat_.charts[c];
    const Triangle& corners = flat_.triangle[index];
    const FlatTriangle t{{flat_.uv[corners[0]], flat_.uv[corners[1]], flat_.uv[corners[2]]}};
    const int sign = orientation(t.uv[0], t.uv[1], t.uv[2]);
    if (sign == 0) return;
    const auto [low, high] = std::minmax({t.uv[0][1], t.uv[1][1], t.uv[2][1]});
    const LatticeSpan rows = lattice_span(low, high, chart.height);
    for (uint32_t y = rows.first; y < rows.end; ++y) {
      const double v = y;
      const auto [left, right] = row_span(t, v);
      const LatticeSpan columns = lattice_span(left, right, chart.width);
      for (uint32_t x = columns.first; x < columns.end; ++x) {
        const Point2 p{static_cast<double>(x), v};
        if (!owns(t, sign, p)) continue;
        claim(pixel_of(chart, x, y), c, index, t, p);
      }
    }
  }

  /// Samples anew what stands off the lattice, and what no triangle covers because the outline cuts a corner there.
  void sample_displaced() {
    std::vector<std::vector<uint32_t>> triangles(flat_.charts.size());
    for (uint32_t t = 0; t < flat_.triangle.size(); ++t) triangles[flat_.chart[t]].push_back(t);
    tbb::parallel_for(std::size_t{0}, flat_.charts.size(), [&](std::size_t c) {  // no pixel belongs to two
      const FlatChart& chart = flat_.charts[c];
      const std::vector<Point2> places = sampling_places(flat_, chart);
      std::optional<PlaneLocator> locator;
      for_pixels(chart, [&](uint32_t x, uint32_t y, std::size_t pixel) {
        if (out_.chart[pixel] != c) return;
        const Point2& place = places[std::size_t{y} * chart.width + x];
        out_.place[pixel] = place;
        const bool at_itself = place[0] == x && place[1] == y;
        if (out_.vertex[pixel] != kNone || (at_itself && out_.triangle[pixel] != kNone)) return;
        if (!locator) locator.emplace(flat_, chart, triangles[c]);
        const auto [found, at] = locate_inside(*locator, places, chart.width, std::size_t{y} * chart.width + x);
        out_.place[pixel] = at;
        sample(pixel, found.triangle, found.weight);
      });
    });
  }

  Raster finish() {
    for (uint32_t pixel = 0; pixel < overlapping_.size(); ++pixel) {
      if (overlapping_[pixel]) out_.overlapping.push_back(pixel);
    }
    return std::move(out_);
  }

 private:
  [[nodiscard]] Point2 plane_point(const PlanePlace& place) const {
    Point2 p{0, 0};
    for (std::size_t k = 0; k < 3; ++k) {
      const Point2& corner = flat_.uv[flat_.triangle[place.triangle][k]];
      p = {p[0] + place.weight[k] * corner[0], p[1] + place.weight[k] * corner[1]};
    }
    return p;
  }

  /// What a pixel strictly inside the outline's pixels samples, and where. Its place may lie beyond the plane's own
  /// edge, where the nearest point would be an outline sample itself: then it moves towards its neighbours.
  [[nodiscard]] std::pair<PlanePlace, Point2> locate_inside(const PlaneLocator& locator,
                                                            const std::vector<Point2>& places, std::size_t width,
                                                            std::size_t i) const {
    constexpr double kBeyond = 0.05;  // [pixels]
    const Point2 place = places[i];
    const auto beyond = [&](const PlanePlace& found, const Point2& wanted) {
      const Point2 p = plane_point(found);
      return std::hypot(p[0] - wanted[0], p[1] - wanted[1]) > kBeyond;
    };
    const PlanePlace nearest = locator.locate(place);
    if (!beyond(nearest, place)) return {nearest, place};
    Point2 middle{0, 0};
    for (const std::size_t k : {i - 1, i + 1, i - width, i + width}) {
      middle = {middle[0] + places[k][0] / 4, middle[1] + places[k][1] / 4};
    }
    for (const double share : {0.5, 1.0}) {
      const Point2 trial{place[0] + share * (middle[0] - place[0]), place[1] + share * (middle[1] - place[1])};
      const PlanePlace found = locator.locate(trial);
      if (!beyond(found, trial)) return {found, trial};
    }
    return {nearest, place};
  }

  [[nodiscard]] std::size_t pixel_of(const FlatChart& chart, uint32_t x, uint32_t y) const {
    return std::size_t{chart.y0 + y} * flat_.width + chart.x0 + x;
  }

  /// An outline pixel lies in any of the triangles around its vertex; the first is as good as another.
  void give_outlines_a_triangle() {
    std::vector<uint32_t> first(flat_.position.size(), kNone);
    for (uint32_t t = 0; t < flat_.triangle.size(); ++t) {
      for (const uint32_t v : flat_.triangle[t]) first[v] = std::min(first[v], t);
    }
    for (std::size_t pixel = 0; pixel < out_.vertex.size(); ++pixel) {
      if (out_.vertex[pixel] != kNone) out_.triangle[pixel] = first[out_.vertex[pixel]];
    }
  }

  template <class Visit>
  void for_pixels(const FlatChart& chart, const Visit& visit) const {
    for (uint32_t y = 0; y < chart.height; ++y) {
      for (uint32_t x = 0; x < chart.width; ++x) visit(x, y, pixel_of(chart, x, y));
    }
  }

  void take(std::size_t pixel, std::size_t chart) {
    if (out_.chart[pixel] == kNoChart) {
      out_.chart[pixel] = static_cast<uint16_t>(chart);
    } else if (out_.chart[pixel] != chart) {
      overlapping_[pixel] = true;
    }
  }

  void claim(std::size_t pixel, uint32_t chart, uint32_t index, const FlatTriangle& t, const Point2& p) {
    if (out_.chart[pixel] != chart || out_.vertex[pixel] != kNone) return;
    if (out_.triangle[pixel] != kNone) {
      overlapping_[pixel] = true;
      return;
    }
    sample(pixel, index, weights_inside(t, p));
  }

  void sample(std::size_t pixel, uint32_t index, const Point3& w) {
    const Triangle& corners = flat_.triangle[index];
    out_.triangle[pixel] = index;
    out_.position[pixel] =
        flat_.position[corners[0]] * w[0] + flat_.position[corners[1]] * w[1] + flat_.position[corners[2]] * w[2];
  }

  const FlatSurface& flat_;
  Raster out_;
  std::vector<bool> overlapping_;
};

}  // namespace

Raster rasterize(const FlatSurface& flat, const Progress& progress) {
  Rasterizer rasterizer(flat);
  rasterizer.sample_outlines();
  rasterizer.fill_outlines();
  constexpr uint32_t kReportEvery = 1U << 14U;
  for (uint32_t t = 0; t < flat.triangle.size(); ++t) {
    if (progress && t % kReportEvery == 0) progress("rasterize", t / static_cast<double>(flat.triangle.size()));
    rasterizer.sample_triangle(t);
  }
  rasterizer.sample_displaced();
  return rasterizer.finish();
}

}  // namespace geocloth
