// SPDX-License-Identifier: GPL-3.0-or-later
// Measures of a geometry image. Stretch of the map: Sander, Snyder, Gortler, Hoppe 2001 (L2) and the symmetric
// Dirichlet energy of Smith and Schaefer 2015, from the singular values of each flat triangle's map to space, with the
// chart scaled so that both areas agree. Accuracy of the resampled surface: root mean square of the distances of
// area-uniform samples, in both directions, as geometry images have been compared since Gu, Gortler, Hoppe 2002.
#include "geocloth/parametrize/quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include <tbb/parallel_invoke.h>

#include "develop/map_stretch.h"
#include "geocloth/asset/grid_mesh.h"
#include "image/chart_outline.h"
#include "mesh/point_math.h"
#include "mesh/triangle_tree.h"

namespace geocloth {
namespace {

constexpr std::size_t kSamples = 40'000;  ///< per direction, the least that the definition asks for

double ratio(double a, double b) {
  return b > 0 ? a / b : 0;
}

/// Sorted values with weights, asked for percentiles.
class Distribution {
 public:
  void add(double value, double weight = 1) { values_.emplace_back(value, weight); }
  void close() {
    std::sort(values_.begin(), values_.end());
    for (const auto& [value, weight] : values_) total_ += weight;
  }
  /// The least value at or below which the share lies. @param share 0..1
  [[nodiscard]] double percentile(double share) const {
    double below = 0;
    for (const auto& [value, weight] : values_) {
      below += weight;
      if (below >= share * total_) return value;
    }
    return values_.empty() ? 0 : values_.back().first;
  }

 private:
  std::vector<std::pair<double, double>> values_;
  double total_ = 0;
};

// ---------------------------------------------------------------------------------------------- the flat charts

void measure_flat(const FlatSurface& flat, Quality& q) {
  std::vector<double> chart_area(flat.charts.size(), 0);
  double area_3d = 0;
  for (std::size_t i = 0; i < flat.triangle.size(); ++i) {
    const Triangle& t = flat.triangle[i];
    const double uv = signed_area_twice(flat.uv[t[0]], flat.uv[t[1]], flat.uv[t[2]]) / 2;
    if (!(uv > 0)) ++q.flipped;
    chart_area[flat.chart[i]] += uv;
    area_3d += triangle_area(flat.position[t[0]], flat.position[t[1]], flat.position[t[2]]);
  }
  q.mirrored =
      static_cast<uint32_t>(std::count_if(chart_area.begin(), chart_area.end(), [](double a) { return a < 0; }));

  const double unit = map_unit(flat);
  double l2 = 0, dirichlet = 0;
  Distribution anisotropy;
  for (const Triangle& t : flat.triangle) {
    const auto [large, small] = singular_values(flat, t, unit);
    const double area = triangle_area(flat.position[t[0]], flat.position[t[1]], flat.position[t[2]]);
    if (!(small > 0)) continue;  // counted as flipped, or of no area in space
    l2 += area * (large * large + small * small) / 2;
    dirichlet += area * (large * large + small * small + 1 / (large * large) + 1 / (small * small));
    anisotropy.add(large / small, area);
  }
  anisotropy.close();
  q.l2_stretch = std::sqrt(ratio(l2, area_3d));
  q.symmetric_dirichlet = ratio(dirichlet, area_3d);
  q.anisotropy_p95 = anisotropy.percentile(0.95);

  // Every surface edge that the outline passes more than once is a seam, and counts once.
  std::vector<std::pair<std::array<uint32_t, 2>, double>> sides;
  for (const auto& border : chart_borders(flat)) {
    for (const auto& [from, to] : border) {
      const uint32_t a = flat.point[from], b = flat.point[to];
      sides.push_back({{std::min(a, b), std::max(a, b)}, distance(flat.position[from], flat.position[to])});
    }
  }
  std::sort(sides.begin(), sides.end());
  double seam = 0;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const bool repeats = sides[i].first == sides[i - 1].first;
    const bool counted = i > 1 && sides[i].first == sides[i - 2].first;
    if (repeats && !counted) seam += sides[i].second;
  }
  q.seam_length = ratio(seam, std::sqrt(area_3d));
}

// ---------------------------------------------------------------------------------------------- springs and cells

uint32_t count_crossing_springs(const FlatSurface& flat, const ClothAsset& asset) {
  const std::vector<ChartOutline> outlines = chart_outlines(flat);
  uint32_t crossing = 0;
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    if (asset.spring_mask[i] == 0) continue;
    const uint32_t x = i % asset.width, y = i / asset.width, c = asset.chart[i];
    const Point2 from = pixel_in_chart(flat.charts[c], x, y);
    for (uint32_t s = 0; s < kSpringCount; ++s) {
      if ((asset.spring_mask[i] & (1U << s)) == 0) continue;
      const auto to_x = static_cast<uint32_t>(static_cast<int32_t>(x) + kSpringOffset[s][0]);
      const auto to_y = static_cast<uint32_t>(static_cast<int32_t>(y) + kSpringOffset[s][1]);
      const uint32_t j = to_y * asset.width + to_x;
      if (asset.chart[j] != c || !outlines[c].holds(from, pixel_in_chart(flat.charts[c], to_x, to_y))) {
        ++crossing;
      }
    }
  }
  return crossing;
}

void measure_grid(const ClothAsset& asset, Quality& q) {
  const double h = asset.spacing;
  const auto at = [&](uint32_t i) { return to_double(asset.rest_position[i]); };
  Distribution springs, shear, cells;
  for (uint32_t i = 0; i < asset.pixel_count(); ++i) {
    const bool right = (asset.spring_mask[i] & kSpringRight) != 0, down = (asset.spring_mask[i] & kSpringDown) != 0;
    const Point3 weft = right ? at(i + 1) - at(i) : Point3{};
    const Point3 warp = down ? at(i + asset.width) - at(i) : Point3{};
    if (right) springs.add(length(weft) / h);
    if (down) springs.add(length(warp) / h);
    if (right && down && length(weft) > 0 && length(warp) > 0) {
      const double sine = std::abs(dot(weft, warp)) / (length(weft) * length(warp));
      shear.add(std::asin(std::min(sine, 1.0)) * 180 / std::numbers::pi);
    }
    constexpr unsigned kWhole = unsigned{kCellFirst} | kCellSecond;
    if ((asset.cell[i] & kWhole) == kWhole) {
      const uint32_t b = i + 1, c = i + asset.width, d = c + 1;
      const bool left = (asset.cell[i] & kCellDiagonalLeft) != 0;
      cells.add((left ? triangle_area(at(i), at(c), at(b)) + triangle_area(at(b), at(c), at(d))
                      : triangle_area(at(i), at(c), at(d)) + triangle_area(at(i), at(d), at(b))) /
                (h * h));
    }
  }
  for (Distribution* d : {&springs, &shear, &cells}) d->close();
  q.spring_min = springs.percentile(0);
  q.spring_max = springs.percentile(1);
  q.spring_p99_over_p1 = ratio(springs.percentile(0.99), springs.percentile(0.01));
  q.shear_deg_p50 = shear.percentile(0.5);
  q.shear_deg_p95 = shear.percentile(0.95);
  q.quad_area_p5 = cells.percentile(0.05);
  q.quad_area_p95 = cells.percentile(0.95);
}

double largest_copy_gap(const ClothAsset& asset) {
  double gap = 0;
  for (uint32_t row = 0; row < asset.splits.rows(); ++row) {
    const std::span<const uint32_t> copies = asset.splits.copies(row);
    const Point3 first = to_double(asset.rest_position[copies.front()]);
    for (const uint32_t p : copies) gap = std::max(gap, distance(first, to_double(asset.rest_position[p])));
  }
  return gap;
}

// ---------------------------------------------------------------------------------------------- accuracy

struct Surface {
  std::vector<Point3> position;
  std::vector<Triangle> triangle;
};

struct Deviation {
  double rms = 0, max = 0;
};

/// Calls visit(point) for area-uniform samples of a triangle, row by row and back, so that each lies near the last.
/// @param uniform  gives numbers in [0, 1)
template <class Uniform, class Visit>
void sample_triangle(const Point3& a, const Point3& b, const Point3& c, std::size_t count, const Uniform& uniform,
                     const Visit& visit) {
  const auto rows = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count))));
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t columns = (row + 1) * count / rows - row * count / rows;
    for (std::size_t k = 0; k < columns; ++k) {
      const std::size_t column = row % 2 == 0 ? k : columns - 1 - k;
      const double root = std::sqrt((static_cast<double>(row) + uniform()) / static_cast<double>(rows));
      const double w = (static_cast<double>(column) + uniform()) / static_cast<double>(columns);
      visit(a * (1 - root) + b * (root * (1 - w)) + c * (root * w));
    }
  }
}

/// Distances of area-uniform samples of one surface from another; the largest is also looked for at its vertices, since
/// corners are what samples miss. Both go along the triangles, so that each query starts from the answer of one nearby.
Deviation deviation(const Surface& from, const Surface& to) {
  const auto area_of = [&](const Triangle& v) {
    return triangle_area(from.position[v[0]], from.position[v[1]], from.position[v[2]]);
  };
  double total = 0;
  for (const Triangle& t : from.triangle) total += area_of(t);
  const TriangleTree tree(to.position, to.triangle);
  std::mt19937 random(20021);  // own arithmetic on its output: distributions differ between libraries
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  Deviation result;
  double squares = 0;
  std::optional<TriangleTree::Place> place;
  const auto visit = [&](const Point3& sample) {
    place = tree.nearest(sample, place);
    const double d = distance(sample, place->point);
    squares += d * d;
    result.max = std::max(result.max, d);
  };
  // Sample i stands for the area from i to i + 1 of kSamples, at a random place therein.
  std::size_t done = 0;
  double target = uniform(), up_to = 0;
  for (const Triangle& t : from.triangle) {
    up_to += area_of(t) * (kSamples / total);
    std::size_t count = 0;
    while (done < kSamples && (target < up_to || &t == &from.triangle.back())) {
      ++done;
      ++count;
      target = static_cast<double>(done) + uniform();
    }
    sample_triangle(from.position[t[0]], from.position[t[1]], from.position[t[2]], count, uniform, visit);
  }
  result.rms = std::sqrt(squares / kSamples);
  std::vector<bool> is_met(from.position.size(), false);
  for (const Triangle& t : from.triangle) {
    for (const uint32_t v : t) {
      if (!is_met[v]) visit(from.position[v]);
      is_met[v] = true;
    }
  }
  return result;
}

void measure_accuracy(const CleanSurface& clean, const ClothAsset& asset, Quality& q) {
  const Surface original{clean.position, clean.triangle};
  Surface grid;
  for (const Vec3& p : asset.rest_position) grid.position.push_back(to_double(p));
  grid.triangle = pixel_triangles(asset);
  Deviation there, back;
  tbb::parallel_invoke([&] { there = deviation(original, grid); }, [&] { back = deviation(grid, original); });
  const double diagonal = bounding_diagonal(clean.position);
  q.rms_error = ratio(std::max(there.rms, back.rms), diagonal);
  q.max_error = ratio(std::max(there.max, back.max), diagonal);
  // Single precision cannot show less than this; it keeps the logarithm finite for flat sheets.
  q.psnr_db = -20 * std::log10(std::max(q.rms_error, double{std::numeric_limits<float>::epsilon()}));
}

double binding_error(const ClothAsset& asset) {
  std::vector<Vec3> normal, bound;
  compute_normals(asset, asset.rest_position, normal);
  evaluate_binding(asset, asset.rest_position, normal, bound);
  std::vector<Point3> source;
  double error = 0;
  for (std::size_t i = 0; i < bound.size(); ++i) {
    source.push_back(to_double(asset.source.position[i]));
    error = std::max(error, distance(to_double(bound[i]), source.back()));
  }
  return ratio(error, bounding_diagonal(source));
}

}  // namespace

Quality measure_quality(const CleanSurface& clean, const FlatSurface& flat, const Raster& raster,
                        const ClothAsset& asset, const Progress& progress) {
  const auto show = [&](double fraction) {
    if (progress) progress("measure", fraction);
  };
  Quality q;
  q.overlapping_pixels = static_cast<uint32_t>(raster.overlapping.size());
  show(0);
  measure_flat(flat, q);
  q.crossing_springs = count_crossing_springs(flat, asset);
  show(0.2);
  measure_grid(asset, q);
  q.copy_gap = largest_copy_gap(asset);
  q.binding_error = binding_error(asset);
  show(0.4);
  measure_accuracy(clean, asset, q);
  show(1);
  return q;
}

}  // namespace geocloth
