// SPDX-License-Identifier: GPL-3.0-or-later
// A ray against every triangle of the grid (Moeller and Trumbore, "Fast, Minimum Storage Ray-Triangle Intersection",
// 1997), and along its way against colliders by steps as long as their distance (Hart, "Sphere Tracing", 1996). Clicks
// are rare: no hierarchy is worth its upkeep.
#include "view/pick.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geocloth/asset/grid_mesh.h"

namespace geocloth::view {
namespace {

constexpr float kReach = 12;         ///< [pixels of the picture] how far beside the cloth it can be taken hold of
constexpr uint32_t kMaxSteps = 256;  ///< of a ray past colliders
constexpr float kNever = std::numeric_limits<float>::infinity();

/// Depth at which the ray meets the triangle, from either side; kNever when it does not.
float meet(const Ray& ray, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, p = cross(ray.direction, ac);
  const float determinant = dot(ab, p);
  if (!(std::abs(determinant) > 0)) return kNever;
  const Vec3 from = ray.origin - a, q = cross(from, ab);
  const float u = dot(from, p) / determinant, v = dot(ray.direction, q) / determinant;
  const float depth = dot(ac, q) / determinant;
  if (u >= 0 && v >= 0 && u + v <= 1 && depth > 0) return depth;
  return kNever;
}

struct Hit {
  float depth = kNever;
  Picked picked;
  float spacing = 0;  ///< [m] of the cloth
};

Hit foremost_triangle(const Ray& ray, std::span<const PickedFrom> cloths) {
  Hit hit;
  for (uint32_t c = 0; c < cloths.size(); ++c) {
    const PickedFrom& cloth = cloths[c];
    for (uint32_t pixel = 0; pixel < cloth.asset->pixel_count(); ++pixel) {
      for (const Triangle& t : cell_triangles(*cloth.asset, pixel)) {
        const std::array<Vec3, 3> corner{cloth.position[t[0]], cloth.position[t[1]], cloth.position[t[2]]};
        const float depth = meet(ray, corner[0], corner[1], corner[2]);
        if (!(depth < hit.depth)) continue;
        const Vec3 at = ray.origin + depth * ray.direction;
        size_t nearest = 0;
        for (size_t k = 1; k < 3; ++k)
          if (length(corner.at(k) - at) < length(corner.at(nearest) - at)) nearest = k;
        hit = {depth, {c, t.at(nearest), corner.at(nearest)}, cloth.scale * cloth.asset->spacing};
      }
    }
  }
  return hit;
}

Hit nearest_pixel(const ScreenMap& screen, const Vec2& place, std::span<const PickedFrom> cloths) {
  Hit hit;
  float distance = kReach;
  for (uint32_t c = 0; c < cloths.size(); ++c) {
    const PickedFrom& cloth = cloths[c];
    for (uint32_t pixel = 0; pixel < cloth.asset->pixel_count(); ++pixel) {
      const Vec3& point = cloth.position[pixel];
      if (!cloth.asset->valid(pixel) || !is_finite(point)) continue;
      const std::optional<Vec2> seen = screen.place(point);
      if (!seen) continue;
      const float beside = std::hypot(seen->x - place.x, seen->y - place.y);
      if (!(beside < distance)) continue;
      distance = beside;
      hit = {screen.depth(point), {c, pixel, point}, cloth.scale * cloth.asset->spacing};
    }
  }
  return hit;
}

/// Depth at which the ray enters the collider; kNever when it does not, and for one that the eye is inside of.
float enter(const Ray& ray, const Collider& collider, float farthest) {
  constexpr float kTouch = 1e-4F;  // [m]
  const float per_depth = length(ray.direction);
  const SignedDistance distance_to(collider);
  float depth = 0;
  for (uint32_t step = 0; step < kMaxSteps && depth < farthest; ++step) {
    const float distance = distance_to(ray.origin + depth * ray.direction);
    if (step == 0 && distance <= 0) return kNever;
    if (!(distance > kTouch)) return depth;
    depth += distance / per_depth;
  }
  return kNever;
}

}  // namespace

std::optional<Picked> pick_pixel(const ScreenMap& screen, const Vec2& place, std::span<const PickedFrom> cloths,
                                 std::span<const Collider> colliders) {
  const Ray ray = screen.ray(place);
  Hit hit = foremost_triangle(ray, cloths);
  if (hit.depth == kNever) hit = nearest_pixel(screen, place, cloths);
  if (hit.depth == kNever) return std::nullopt;
  // Coarse cloth that lies on something round reaches into it between its points.
  const float in_front = hit.depth - hit.spacing;
  const bool hidden =
      std::ranges::any_of(colliders, [&](const Collider& c) { return enter(ray, c, in_front) < in_front; });
  return hidden ? std::nullopt : std::optional(hit.picked);
}

}  // namespace geocloth::view
