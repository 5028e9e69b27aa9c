// SPDX-License-Identifier: Apache-2.0
#include "geocloth/solver/pixel_binding.h"

#include <string>

#include "geocloth/asset/error.h"
#include "geocloth/asset/grid_mesh.h"
#include "scene/source_surface.h"

namespace geocloth {

PixelBinding::Place PixelBinding::place_at(uint32_t pixel, const RestPlace& place) {
  return {pixel, place.triangle, to_float(place.beside.corner_share), to_float(place.beside.off)};
}

PixelBinding::PixelBinding(const ClothAsset& asset)
    : pixels_(asset.pixel_count()), points_(asset.source.position.size()) {
  const SourceSurface surface(asset);
  for (uint32_t p = 0; p < pixels_; ++p) {
    if (!asset.valid(p)) continue;
    if (const auto place = surface.place_of(p)) places_.push_back(place_at(p, *place));
  }
}

PixelBinding::PixelBinding(const ClothAsset& asset, const ClothAsset& from)
    : pixels_(asset.pixel_count()), points_(from.pixel_count()) {
  if (asset.source.position != from.source.position)
    throw Error(ErrorCode::invalid_argument, "the two assets were not converted from the same mesh");
  if (asset.source.triangle != from.source.triangle) {
    throw Error(ErrorCode::invalid_argument,
                "the meshes of the two assets have the same vertices and other triangles, as of cloth that has been "
                "cut; pass both assets as they were loaded, not as Solver::asset() gives them after a cut");
  }
  const SourceSurface mesh(asset);
  const RestSurface grid(from.rest_position, pixel_triangles(from), from.spacing);
  for (uint32_t p = 0; p < pixels_; ++p) {
    if (!asset.valid(p)) continue;
    const auto on_mesh = mesh.place_of(p);
    const auto place = grid.place_of(to_double(asset.rest_position[p]), [&](uint32_t t) {
      return !on_mesh || is_bound_near(from, on_mesh->triangle, grid.triangles()[t][0]);
    });
    if (place) places_.push_back(place_at(p, *place));
  }
}

void PixelBinding::check_count(size_t points) const {
  if (points == points_) return;
  throw Error(ErrorCode::invalid_argument,
              std::to_string(points_) + " points are wanted, and " + std::to_string(points) + " are told");
}

void PixelBinding::evaluate(std::span<const Vec3> points, std::vector<Vec3>& out, float scale) const {
  check_count(points.size());
  out.assign(pixels_, Vec3{});
  for (const Place& place : places_) {
    const TriangleCorners corners = corners_of(place.triangle, points);
    out[place.pixel] =
        to_float(point_beside(corners, {to_double(place.corner_share), double{scale} * to_double(place.off)}));
  }
}

void PixelBinding::evaluate_rates(std::span<const Vec3> rates, std::vector<Vec3>& out) const {
  check_count(rates.size());
  out.assign(pixels_, Vec3{});
  for (const Place& place : places_) {
    const auto& [a, b, c] = place.triangle;
    const Vec3& share = place.corner_share;
    out[place.pixel] = share.x * rates[a] + share.y * rates[b] + share.z * rates[c];
  }
}

}  // namespace geocloth
