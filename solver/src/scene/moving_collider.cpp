// SPDX-License-Identifier: Apache-2.0
// A body that deforms gets another field in every frame, of the same spacing; what pins hold beside its surface goes
// along with the nearest triangle.

#include "scene/moving_collider.h"

#include <limits>
#include <string>
#include <utility>

#include "colliders/closest.h"
#include "colliders/surface_bounds.h"
#include "geocloth/asset/error.h"
#include "geocloth/asset/vec3d.h"

namespace geocloth {
namespace {

constexpr uint32_t kNodes = 300'000;  ///< of the first field, about: one is made for every frame

/// Orthonormal axes of a triangle.
struct Axes {
  Vec3d along, across, normal;
};
Vec3d unit(const Vec3d& v) {
  const double l = length(v);
  return l > 0 ? v * (1 / l) : Vec3d{};
}
Axes axes_of(const TriangleCorners& t) {
  const Vec3d along = unit(t.b - t.a), normal = unit(cross(t.b - t.a, t.c - t.a));
  return {along, cross(normal, along), normal};
}

}  // namespace

MovingCollider::MovingCollider(MovingBody body, const Transform& place) : body_(std::move(body)), place_(place) {
  TriangleSurface surface = surface_at(0);
  before_ = surface.position;
  field_ = std::make_shared<const DistanceField>(make_distance_field(std::move(surface), kNodes));
  const SurfaceBounds bounds = bounds_of(field_->surface);
  middle_ = 0.5F * (bounds.low + bounds.high);
}

TriangleSurface MovingCollider::surface_at(double time) const {
  TriangleSurface surface{body_.positions_at(time), body_.triangle};
  for (Vec3& p : surface.position) p = apply(place_, p);
  return surface;
}

void MovingCollider::advance(double time) {
  before_ = field_->surface.position;
  field_ =
      std::make_shared<const DistanceField>(make_deforming_field(surface_at(time), before_, field_->spacing));
}

SurfacePlace MovingCollider::place_of(const Vec3& point) const {
  const Vec3d p = to_double(point);
  SurfacePlace best;
  double least = std::numeric_limits<double>::infinity();
  for (uint32_t i = 0; i < body_.triangle.size(); ++i) {
    const TriangleCorners t = corners_of(body_.triangle[i], before_);
    const Vec3d normal = cross(t.b - t.a, t.c - t.a);
    if (!(dot(normal, normal) > 0)) continue;
    const Vec3d nearest = closest_on_triangle(t, p), away = p - nearest;
    if (!(dot(away, away) < least)) continue;
    least = dot(away, away);
    const Axes axes = axes_of(t);
    const auto real = [](double v) { return static_cast<float>(v); };
    const Vec3d share = corner_shares(t, nearest);
    best = {i,
            {real(share.x), real(share.y), real(share.z)},
            {real(dot(away, axes.along)), real(dot(away, axes.across)), real(dot(away, axes.normal))}};
  }
  return best;
}

Vec3 MovingCollider::point_of(const SurfacePlace& place, const std::vector<Vec3>& position) const {
  const TriangleCorners t = corners_of(body_.triangle[place.triangle], position);
  const Axes axes = axes_of(t);
  const Vec3d p = double{place.corner_share.x} * t.a + double{place.corner_share.y} * t.b +
                  double{place.corner_share.z} * t.c + double{place.off.x} * axes.along +
                  double{place.off.y} * axes.across + double{place.off.z} * axes.normal;
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

}  // namespace geocloth
