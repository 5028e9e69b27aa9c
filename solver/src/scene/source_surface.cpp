// SPDX-License-Identifier: Apache-2.0
#include "scene/source_surface.h"

#include <algorithm>
#include <utility>

#include "geocloth/asset/grid_mesh.h"

namespace geocloth {
namespace {

std::vector<TriangleCorners> corners_of_all(std::span<const Vec3> position, const std::vector<Triangle>& triangles) {
  std::vector<TriangleCorners> corners;
  corners.reserve(triangles.size());
  for (const Triangle& t : triangles) corners.push_back(corners_of(t, position));
  return corners;
}

/// [pixels] Squared, in the image.
float squared_way(const ClothAsset& asset, uint32_t a, uint32_t b) {
  const uint32_t row_a = a / asset.width, row_b = b / asset.width;
  const auto x = static_cast<float>(a % asset.width) - static_cast<float>(b % asset.width);
  const auto y = static_cast<float>(row_a) - static_cast<float>(row_b);
  return x * x + y * y;
}

}  // namespace

RestSurface::RestSurface(std::span<const Vec3> position, std::vector<Triangle> triangles, float spacing)
    : triangles_(std::move(triangles)),
      corners_(corners_of_all(position, triangles_)),
      tree_(corners_),
      spacing_(spacing) {}

double RestSurface::distance(const Vec3d& p, uint32_t triangle) const {
  return length(p - closest_on_triangle(corners_[triangle], p));
}

std::optional<RestPlace> RestSurface::place_of(const Vec3d& p, const TriangleTree::MayTake& may_take) const {
  std::optional<uint32_t> found = tree_.nearest(p);
  if (!found) return {};
  if (!may_take(*found)) {
    const std::optional<uint32_t> own = tree_.nearest(p, may_take);
    if (own && distance(p, *own) <= distance(p, *found) + spacing_) found = own;
  }
  return RestPlace{triangles_[*found], place_beside(corners_[*found], p)};
}

bool is_bound_near(const ClothAsset& asset, const Triangle& triangle, uint32_t pixel) {
  constexpr float kBeside = 2;  // pixels
  const std::vector<Vec3>& at = asset.source.position;
  const float edge = std::max({length(at[triangle[1]] - at[triangle[0]]), length(at[triangle[2]] - at[triangle[1]]),
                               length(at[triangle[0]] - at[triangle[2]])});
  const float reach = kBeside + edge / asset.spacing;
  return std::ranges::any_of(triangle, [&](uint32_t v) {
    return std::ranges::any_of(asset.binding[v].pixel, [&](uint32_t bound) {
      return asset.chart[bound] == asset.chart[pixel] && squared_way(asset, bound, pixel) <= reach * reach;
    });
  });
}

SourceSurface::SourceSurface(const ClothAsset& asset)
    : asset_(asset),
      row_of_pixel_(split_rows(asset)),
      surface_(asset.source.position, asset.source.triangle, asset.spacing) {}

std::optional<RestPlace> SourceSurface::place_of(uint32_t pixel) const {
  std::span<const uint32_t> copies(&pixel, 1);
  if (const uint32_t row = row_of_pixel_[pixel]; row != kNoPixel) copies = asset_.splits.copies(row);
  return surface_.place_of(to_double(asset_.rest_position[pixel]), [&](uint32_t t) {
    return std::ranges::any_of(copies, [&](uint32_t p) { return is_bound_near(asset_, surface_.triangles()[t], p); });
  });
}

}  // namespace geocloth
