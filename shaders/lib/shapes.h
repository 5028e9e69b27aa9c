// SPDX-License-Identifier: Apache-2.0
// Signed distance and outward normal of every collider shape, in the shape's own frame. Exact, or at least 1-Lipschitz,
// which the sweep in collide.h relies on; a mesh's field nearly so.
//
// The includer defines before this file: struct ColliderSet (a handle), float collider_number(ColliderSet set, uint i).
#ifndef GEOCLOTH_LIB_SHAPES_H
#define GEOCLOTH_LIB_SHAPES_H

#include "../shared/layout.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

struct Nearest {
  float distance;  // [m] negative inside
  vec3 normal;     // unit, outwards
};

inline Nearest make_nearest(float distance, vec3 normal) {
  Nearest r;
  r.distance = distance;
  r.normal = normal;
  return r;
}

// [m] Where it is thinnest; of a body where it is thickest.
inline float half_thickness(ColliderShape shape) {
  return shape.kind == kShapeMesh ? shape.b.z : shape.core;
}

// The centre itself goes out along +y; a capsule's axis is x, so that +y leads out of it too.
inline Nearest nearest_ball(vec3 from_center, float radius) {
  vec4 u = unit_and_length(from_center);
  precise float distance = u.w - radius;
  return make_nearest(distance, u.w > 0.0f ? xyz(u) : vec3(0.0f, 1.0f, 0.0f));
}

// The ball of the family between the ends that is nearest: with s along the axis and rho from it, the one at
// s - rho tan(taper), clamped to the ends.
inline Nearest nearest_capsule(ColliderShape shape, vec3 p) {
  precise float rho = sqrt(p.y * p.y + p.z * p.z);
  precise float along = min(max(p.x - rho * shape.b.y, -shape.a.x), shape.a.x);
  precise float radius = 0.5f * (shape.a.y + shape.a.z) - shape.b.x * along;
  return nearest_ball(p - vec3(along, 0.0f, 0.0f), radius);
}

inline float sign_of(float a) {
  return a < 0.0f ? -1.0f : 1.0f;
}

inline Nearest nearest_box(vec3 half_extents, vec3 p) {
  precise vec3 q = vec3(abs(p.x), abs(p.y), abs(p.z)) - half_extents;
  vec3 side = vec3(sign_of(p.x), sign_of(p.y), sign_of(p.z));
  float largest = max(q.x, max(q.y, q.z));
  if (largest > 0.0f) {
    vec4 u = unit_and_length(vec3(max(q.x, 0.0f), max(q.y, 0.0f), max(q.z, 0.0f)));
    return make_nearest(u.w, xyz(u) * side);
  }
  vec3 n = q.x == largest ? vec3(side.x, 0.0f, 0.0f)
                          : (q.y == largest ? vec3(0.0f, side.y, 0.0f) : vec3(0.0f, 0.0f, side.z));
  return make_nearest(largest, n);
}

const uint kEllipsoidSteps = 12u;

// Closest point by Eberly's equation sum (r y / (t + r^2))^2 = 1 in units of the largest radius: convex and falling
// right of its last pole, so Newton's method from the left climbs to the root without a bracket.
// @param steps  kEllipsoidSteps; none where the result is not wanted
inline Nearest nearest_ellipsoid(vec3 radii, vec3 p, uint steps) {
  float largest = max(radii.x, max(radii.y, radii.z));
  precise float scale = 1.0f / largest;
  precise vec3 r = radii * scale;
  precise vec3 r2 = r * r;
  precise vec3 y =
      vec3(max(abs(p.x) * scale, 1e-5f * r.x), max(abs(p.y) * scale, 1e-5f * r.y), max(abs(p.z) * scale, 1e-5f * r.z));
  precise vec3 ry = r * y;
  precise float t = max(ry.x - r2.x, max(ry.y - r2.y, ry.z - r2.z));
  precise vec3 s = vec3(0.0f, 0.0f, 0.0f);
  for (uint i = 0u; i < steps; ++i) {
    s = vec3(1.0f / (t + r2.x), 1.0f / (t + r2.y), 1.0f / (t + r2.z));
    precise vec3 g = ry * s;
    precise float value = dot3(g, g) - 1.0f;
    precise float slope = 2.0f * dot3(g * g, s);
    precise float step = value * (1.0f / max(slope, 1e-20f));
    t = t + max(step, 0.0f);
  }
  s = vec3(1.0f / (t + r2.x), 1.0f / (t + r2.y), 1.0f / (t + r2.z));
  precise vec3 g = ry * s;                                      // closest point divided by the radii
  precise vec3 on_unit = g * (1.0f / max(length3(g), 1e-20f));  // the root is never exact: back to the surface
  precise vec3 q = on_unit * r;
  precise vec3 outward = vec3(on_unit.x * (1.0f / r.x), on_unit.y * (1.0f / r.y), on_unit.z * (1.0f / r.z));
  vec3 n = xyz(unit_and_length(outward));
  precise vec3 from_surface = vec3(abs(p.x), abs(p.y), abs(p.z)) * scale - q;
  precise float distance = dot3(from_surface, n) * largest;
  return make_nearest(distance, n * vec3(sign_of(p.x), sign_of(p.y), sign_of(p.z)));
}

// For contacts: twice as far out as the ellipsoid is large, a lower bound of the distance will do.
// Where shaders run in software every invocation goes through this, whatever shape there is; then without a step.
inline Nearest nearest_ellipsoid_in_reach(ColliderShape shape, vec3 p) {
  vec3 radii = xyz(shape.a);
  float largest = max(radii.x, max(radii.y, radii.z));
  vec4 outward = unit_and_length(p);
  precise float bound = outward.w - largest;
  if (bound > largest) return make_nearest(bound, xyz(outward));
  return nearest_ellipsoid(radii, p, shape.kind == kShapeEllipsoid ? kEllipsoidSteps : 0u);
}

// The plane that the point is highest above: exact inside and beside a face.
inline Nearest nearest_convex(ColliderSet set, ColliderShape shape, vec3 p) {
  float height = -1e30f;
  vec3 normal = vec3(0.0f, 1.0f, 0.0f);
  for (uint i = 0u; i < shape.data.y; ++i) {
    uint k = shape.data.x + 4u * i;
    vec3 n = vec3(collider_number(set, k), collider_number(set, k + 1u), collider_number(set, k + 2u));
    precise float h = dot3(n, p) - collider_number(set, k + 3u);
    if (h > height) {
      height = h;
      normal = n;
    }
  }
  return make_nearest(height, normal);
}

inline float mix1(float a, float b, float t) {
  precise float r = a + (b - a) * t;
  return r;
}

// Where a point lies in a mesh's grid: the offset of its cell's first node and the shares of the way to the next ones.
struct GridPlace {
  uint node;
  vec3 t;
};

// The point in units of the grid.
inline vec3 in_grid(ColliderShape shape, vec3 p) {
  precise vec3 g = (p - xyz(shape.a)) * shape.b.x;
  return g;
}

inline vec3 grid_sides(ColliderShape shape) {
  return vec3(float(shape.data.y - 1u), float(shape.data.z - 1u), float(shape.data.w - 1u));
}

inline vec3 clamped_to(vec3 g, vec3 side) {
  return vec3(min(max(g.x, 0.0f), side.x), min(max(g.y, 0.0f), side.y), min(max(g.z, 0.0f), side.z));
}

// @param q  in units of the grid, in it
inline GridPlace place_in_grid(ColliderShape shape, vec3 q, vec3 side) {
  precise vec3 cell =
      vec3(min(floor(q.x), side.x - 1.0f), min(floor(q.y), side.y - 1.0f), min(floor(q.z), side.z - 1.0f));
  GridPlace r;
  precise vec3 t = q - cell;
  r.t = t;
  r.node = uint(cell.x) + uint(cell.y) * shape.data.y + uint(cell.z) * (shape.data.y * shape.data.z);
  return r;
}

// Trilinear in the cell of the point, with the gradient of that; beyond the grid, where no surface is, a lower bound.
inline Nearest nearest_mesh(ColliderSet set, ColliderShape shape, vec3 p) {
  vec3 g = in_grid(shape, p);
  vec3 side = grid_sides(shape);
  vec3 q = clamped_to(g, side);
  precise vec3 beyond = (g - q) * shape.a.w;
  vec4 out_of = unit_and_length(beyond);
  if (out_of.w > 0.0f) return make_nearest(out_of.w + shape.b.y, xyz(out_of));

  GridPlace place = place_in_grid(shape, q, side);
  vec3 t = place.t;
  uint row = shape.data.y;
  uint layer = shape.data.y * shape.data.z;
  uint k = shape.data.x + place.node;
  float d000 = collider_number(set, k);
  float d100 = collider_number(set, k + 1u);
  float d010 = collider_number(set, k + row);
  float d110 = collider_number(set, k + row + 1u);
  float d001 = collider_number(set, k + layer);
  float d101 = collider_number(set, k + layer + 1u);
  float d011 = collider_number(set, k + layer + row);
  float d111 = collider_number(set, k + layer + row + 1u);
  float d00 = mix1(d000, d100, t.x);
  float d10 = mix1(d010, d110, t.x);
  float d01 = mix1(d001, d101, t.x);
  float d11 = mix1(d011, d111, t.x);
  float d0 = mix1(d00, d10, t.y);
  float d1 = mix1(d01, d11, t.y);
  float distance = mix1(d0, d1, t.z);
  float along_x = mix1(mix1(d100 - d000, d110 - d010, t.y), mix1(d101 - d001, d111 - d011, t.y), t.z);
  float along_y = mix1(d10 - d00, d11 - d01, t.z);
  vec4 gradient = unit_and_length(vec3(along_x, along_y, d1 - d0));
  return make_nearest(distance, gradient.w > 0.0f ? xyz(gradient) : vec3(0.0f, 1.0f, 0.0f));
}

inline vec3 node_way(ColliderSet set, uint k) {
  return vec3(collider_number(set, k), collider_number(set, k + 1u), collider_number(set, k + 2u));
}

inline vec3 mix_ways(vec3 a, vec3 b, float t) {
  precise vec3 r = a + (b - a) * t;
  return r;
}

// How far what is at a point of a deforming body's frame goes in the frame that ends there; beyond the grid as at its
// side.
inline vec3 deforming_way(ColliderSet set, ColliderShape shape, vec3 p) {
  vec3 side = grid_sides(shape);
  GridPlace place = place_in_grid(shape, clamped_to(in_grid(shape, p), side), side);
  uint row = kWayNumbers * shape.data.y;
  uint layer = row * shape.data.z;
  uint k = shape.data.x + shape.data.y * shape.data.z * shape.data.w + kWayNumbers * place.node;
  vec3 w00 = mix_ways(node_way(set, k), node_way(set, k + kWayNumbers), place.t.x);
  vec3 w10 = mix_ways(node_way(set, k + row), node_way(set, k + row + kWayNumbers), place.t.x);
  vec3 w01 = mix_ways(node_way(set, k + layer), node_way(set, k + layer + kWayNumbers), place.t.x);
  vec3 w11 = mix_ways(node_way(set, k + layer + row), node_way(set, k + layer + row + kWayNumbers), place.t.x);
  return mix_ways(mix_ways(w00, w10, place.t.y), mix_ways(w01, w11, place.t.y), place.t.z);
}

inline Nearest nearest_of_shape(ColliderSet set, ColliderShape shape, vec3 p) {
  if (shape.kind == kShapePlane) return make_nearest(p.y, vec3(0.0f, 1.0f, 0.0f));
  if (shape.kind == kShapeSphere) return nearest_ball(p, shape.a.x);
  if (shape.kind == kShapeCapsule) return nearest_capsule(shape, p);
  if (shape.kind == kShapeBox) return nearest_box(xyz(shape.a), p);
  if (shape.kind == kShapeConvex) return nearest_convex(set, shape, p);
  if (shape.kind == kShapeMesh) return nearest_mesh(set, shape, p);
  return nearest_ellipsoid_in_reach(shape, p);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
