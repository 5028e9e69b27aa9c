// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/image_surface.h"

#include <cmath>
#include <limits>

#include "geocloth/asset/grid_mesh.h"

namespace geocloth {

ImageSurface::ImageSurface(const FlatSurface& flat_surface, const ClothAsset& cloth)
    : flat(flat_surface), asset(cloth), first(first_copies(cloth)), pixels(pixel_triangles(cloth)) {
  points.reserve(pixels.size());
  for (const Triangle& t : pixels) points.push_back({first[t[0]], first[t[1]], first[t[2]]});
  place.reserve(asset.pixel_count());
  for (const Vec3& p : asset.rest_position) place.push_back(to_double(p));
  find_vertices();
}

Point3 ImageSurface::normal(uint32_t t) const {
  const std::array<Point3, 3> corner = corners(t);
  return cross(corner[1] - corner[0], corner[2] - corner[0]);
}

uint32_t ImageSurface::cell_of(uint32_t t) const {
  const auto& [a, b, c] = pixels[t];
  const uint32_t w = asset.width;
  return std::min({a / w, b / w, c / w}) * w + std::min({a % w, b % w, c % w});
}

void ImageSurface::find_vertices() {
  std::vector<uint32_t> chart_of(flat.position.size(), kNone);
  for (std::size_t t = 0; t < flat.triangle.size(); ++t) {
    for (const uint32_t v : flat.triangle[t]) chart_of[v] = flat.chart[t];
  }
  const auto cell_at = [](double x, uint32_t corner, uint32_t size) {
    return corner + static_cast<uint32_t>(std::clamp(std::floor(x), 0.0, std::max(size, 2U) - 2.0));
  };
  for (uint32_t v = 0; v < flat.position.size(); ++v) {
    if (chart_of[v] == kNone) continue;
    const FlatChart& chart = flat.charts[chart_of[v]];
    const uint32_t x = cell_at(flat.uv[v][0], chart.x0, chart.width),
                   y = cell_at(flat.uv[v][1], chart.y0, chart.height);
    vertex_.push_back({cell_beside(y * asset.width + x, chart, flat.uv[v]), v});
  }
  std::stable_sort(vertex_.begin(), vertex_.end(), by_cell);
}

/// The cell, or the nearest one around it where the outline's pixels leave it out.
uint32_t ImageSurface::cell_beside(uint32_t cell, const FlatChart& chart, const Point2& place_in_chart) const {
  if (cell_triangles(asset, cell).count != 0) return cell;
  const uint32_t column = cell % asset.width, row = cell / asset.width;
  uint32_t best = cell;
  double least = std::numeric_limits<double>::infinity();
  for (uint32_t y = std::max(row, 1U) - 1; y <= row + 1 && y + 1 < asset.height; ++y) {
    for (uint32_t x = std::max(column, 1U) - 1; x <= column + 1 && x + 1 < asset.width; ++x) {
      const uint32_t other = y * asset.width + x;
      const double d = std::hypot(x + 0.5 - chart.x0 - place_in_chart[0], y + 0.5 - chart.y0 - place_in_chart[1]);
      if (d >= least || cell_triangles(asset, other).count == 0) continue;
      least = d;
      best = other;
    }
  }
  return best;
}

}  // namespace geocloth
