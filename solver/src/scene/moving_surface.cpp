// SPDX-License-Identifier: Apache-2.0
// What pins hold beside a surface that deforms goes along with the triangle that was nearest when they took hold.

#include "scene/moving_surface.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "colliders/beside_triangle.h"
#include "colliders/surface_bounds.h"
#include "colliders/triangle_tree.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"

namespace geocloth {
namespace {

constexpr uint32_t kNodes = 300'000;  ///< of the first field, about: one is made for every frame

}  // namespace

MovingSurface::MovingSurface(MovingBody body, const Transform& place)
    : body_(std::move(body)), place_(place), now_{positions_at(0), body_.triangle}, before_(now_.position) {
  if (now_.triangle.empty()) throw Error(ErrorCode::invalid_data, "has no triangles");
  for (const auto& t : now_.triangle) {
    for (const uint32_t i : t) {
      if (i >= before_.size())
        throw Error(ErrorCode::invalid_data, "a triangle refers to a vertex that does not exist");
    }
  }
}

std::vector<Vec3> MovingSurface::positions_at(double time) const {
  return placed(body_.positions_at(time));
}

std::vector<Vec3> MovingSurface::placed(std::vector<Vec3> position) const {
  for (Vec3& p : position) p = apply(place_, p);
  for (size_t i = 0; i < position.size(); ++i) {
    if (!is_finite(position[i]))
      throw Error(ErrorCode::invalid_data, "vertex " + std::to_string(i) + " is at no finite place");
  }
  return position;
}

void MovingSurface::advance(double time) {
  std::vector<Vec3> position = positions_at(time);
  if (position.size() != before_.size()) throw Error(ErrorCode::invalid_data, "the number of its vertices changes");
  before_ = std::exchange(now_.position, std::move(position));
}

std::vector<SurfacePlace> MovingSurface::places_of(std::span<const Vec3> points) const {
  return places_on(before_, points);
}

std::vector<SurfacePlace> MovingSurface::places_on(const std::vector<Vec3>& position,
                                                   std::span<const Vec3> points) const {
  std::vector<TriangleCorners> corners;
  corners.reserve(now_.triangle.size());
  for (const auto& t : now_.triangle) corners.push_back(corners_of(t, position));
  const TriangleTree tree(corners);
  std::vector<SurfacePlace> places;
  places.reserve(points.size());
  for (const Vec3& point : points) {
    const Vec3d p = to_double(point);
    const std::optional<uint32_t> best = tree.nearest(p);
    if (!best) {
      places.emplace_back();
      continue;
    }
    const PlaceBeside beside = place_beside(corners[*best], p);
    places.push_back({*best, to_float(beside.corner_share), to_float(beside.off)});
  }
  return places;
}

std::optional<std::vector<Vec3>> MovingSurface::carried_from_opening(std::span<const Vec3> points) const {
  constexpr float kStill = 1e-5F;  // of the largest side
  if (body_.as_opened.empty()) return {};
  const std::vector<Vec3> opened = placed(body_.as_opened);
  if (opened.size() != before_.size())
    throw Error(ErrorCode::invalid_data, "the file opens with another number of vertices than it plays");
  const SurfaceBounds bounds = bounds_of({opened, now_.triangle});
  const Vec3 side = bounds.high - bounds.low;
  float farthest = 0;
  for (size_t i = 0; i < opened.size(); ++i) farthest = std::max(farthest, length(before_[i] - opened[i]));
  if (farthest <= kStill * std::max({side.x, side.y, side.z})) return {};
  std::vector<Vec3> carried;
  carried.reserve(points.size());
  for (const SurfacePlace& place : places_on(opened, points)) carried.push_back(at_start(place));
  return carried;
}

Vec3 MovingSurface::point_of(const SurfacePlace& place, const std::vector<Vec3>& position) const {
  const TriangleCorners t = corners_of(now_.triangle[place.triangle], position);
  return to_float(point_beside(t, {to_double(place.corner_share), to_double(place.off)}));
}

Vec3 MovingSurface::normal_of(const SurfacePlace& place, const std::vector<Vec3>& position) const {
  const TriangleCorners t = corners_of(now_.triangle[place.triangle], position);
  return to_float(unit(cross(t.b - t.a, t.c - t.a), {0, 1, 0}));
}

MovingCollider::MovingCollider(MovingBody body, const Transform& place, float spacing)
    : surface_(std::move(body), place),
      field_(std::make_shared<const DistanceField>(spacing > 0
                                                       ? make_distance_field(surface_.at_end(), FieldSpacing{spacing})
                                                       : make_distance_field(surface_.at_end(), kNodes))) {
  const SurfaceBounds bounds = bounds_of(field_->surface);
  middle_ = 0.5F * (bounds.low + bounds.high);
}

void MovingCollider::advance(double time) {
  surface_.advance(time);
  field_ = std::make_shared<const DistanceField>(
      make_deforming_field(surface_.at_end(), surface_.before(), field_->spacing));
}

}  // namespace geocloth
