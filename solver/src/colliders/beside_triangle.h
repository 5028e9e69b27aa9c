// SPDX-License-Identifier: Apache-2.0
// Points that go along with the triangle that they are nearest to.
#pragma once

#include "colliders/closest.h"

namespace geocloth {

/// Where a point is as a triangle sees it.
struct PlaceBeside {
  Vec3d corner_share;  ///< of the point of the triangle that it is nearest to; they sum to 1
  Vec3d off;           ///< [m] from there, along the first side, across it, and along the normal
};

/// Orthonormal axes of a triangle.
struct TriangleAxes {
  Vec3d along, across, normal;
};
[[nodiscard]] inline TriangleAxes axes_of(const TriangleCorners& t) {
  const Vec3d along = unit(t.b - t.a, {}), normal = unit(cross(t.b - t.a, t.c - t.a), {});
  return {along, cross(normal, along), normal};
}

[[nodiscard]] inline PlaceBeside place_beside(const TriangleCorners& t, const Vec3d& p) {
  const Vec3d nearest = closest_on_triangle(t, p), away = p - nearest;
  const TriangleAxes axes = axes_of(t);
  return {corner_shares(t, nearest), {dot(away, axes.along), dot(away, axes.across), dot(away, axes.normal)}};
}

/// Where that is once the corners are elsewhere.
[[nodiscard]] inline Vec3d point_beside(const TriangleCorners& t, const PlaceBeside& place) {
  const TriangleAxes axes = axes_of(t);
  return place.corner_share.x * t.a + place.corner_share.y * t.b + place.corner_share.z * t.c +
         place.off.x * axes.along + place.off.y * axes.across + place.off.z * axes.normal;
}

}  // namespace geocloth
