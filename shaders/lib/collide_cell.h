// SPDX-License-Identifier: Apache-2.0
// Contact of the triangles between pixels: a collider that is smaller than a cell, or that has stretched one open, must
// not slip through between its corners. The point of a triangle that is deepest in the collider is found by Frank and
// Wolfe's steps towards the corners (Macklin et al. 2020, "Local Optimization for Robust Signed Distance Field
// Collision", section 4.2), once where the substep began and once where it ends; it is then a point like a pixel, swept
// as in collide.h, and what pushes it out is shared by the corners by their weights and masses.
//
// Only positions change, and only as far as the collider came nearer, so that no cloth is thrown; friction and the
// cloth's thickness are the pixels' own.
#ifndef GEOCLOTH_LIB_COLLIDE_CELL_H
#define GEOCLOTH_LIB_COLLIDE_CELL_H

#include "collide.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const float kOpenCell = 0.5f;  // sides of a triangle that a collider may sink into, in its half widths
const uint kDeepestSteps = 8u;
const float kLiftSpeed = 1.0f;  // [m/s] at which a triangle that begins inside comes out

struct Corners {
  vec3 a;
  vec3 b;
  vec3 c;
};

inline vec3 at_weights(Corners t, vec3 weights) {
  precise vec3 r = t.a * weights.x + t.b * weights.y + t.c * weights.z;
  return r;
}

inline Corners corners_to_local(ColliderPose pose, Corners t) {
  Corners r;
  r.a = to_local(pose, t.a);
  r.b = to_local(pose, t.b);
  r.c = to_local(pose, t.c);
  return r;
}

inline float longest_side(Corners t) {
  return max(length3(t.b - t.a), max(length3(t.c - t.b), length3(t.a - t.c)));
}

// Weights of the point of a triangle, in the collider's frame, that is nearest to the collider or deepest in it.
inline vec3 deepest_weights(ColliderSet set, ColliderShape shape, Corners t) {
  const float third = 1.0f / 3.0f;
  vec3 weights = vec3(third, third, third);
  for (uint i = 0u; i < kDeepestSteps; ++i) {
    vec3 n = nearest_of_shape(set, shape, at_weights(t, weights)).normal;
    float a = dot3(n, t.a);
    float b = dot3(n, t.b);
    float c = dot3(n, t.c);
    vec3 corner = vec3(0.0f, 0.0f, 1.0f);
    if (a <= b && a <= c) {
      corner = vec3(1.0f, 0.0f, 0.0f);
    } else if (b <= c) {
      corner = vec3(0.0f, 1.0f, 0.0f);
    }
    weights = mix3(weights, corner, 1.0f / float(i + 3u));
  }
  return weights;
}

// Moves the corners so that the point of these weights moves by `step`.
// @param w  inverse masses of the corners
inline Corners push_corners(Corners t, vec3 w, vec3 weights, vec3 step) {
  precise vec3 share = w * weights;
  precise float sum = dot3(share, weights);
  precise float scale = sum > 0.0f ? 1.0f / (sum > 0.0f ? sum : 1.0f) : 0.0f;
  Corners r;
  r.a = shifted(t.a, step, share.x * scale);
  r.b = shifted(t.b, step, share.y * scale);
  r.c = shifted(t.c, step, share.z * scale);
  return r;
}

// One contact of the point of these weights.
// @param start  the corners when the substep began, in the collider's frame of then
inline Corners push_point(ColliderSet set, ClothParams params, ColliderShape shape, ColliderPose after, Corners t,
                          Corners start, vec3 w, vec3 weights) {
  vec3 p0 = at_weights(start, weights);
  vec3 p1 = to_local(after, at_weights(t, weights));
  Contact contact = find_contact(set, shape, p0, p1, nearest_of_shape(set, shape, p1), 0.0f, true);
  if (!contact.touches) return t;
  precise float approach = max(dot3(p0 - p1, contact.normal), 0.0f) + shape.way + kLiftSpeed * params.dt;
  vec3 n = rotate_to_world(after, contact.normal);
  precise vec3 step = n * min(contact.depth, approach);
  return push_corners(t, w, weights, step);
}

// @param t, start  corners of a triangle, and where they were when the substep began
// @param w         their inverse masses
inline Corners collide_triangle(ColliderSet set, ClothParams params, uint substep, Corners t, Corners start, vec3 w) {
  Corners moved = t;
  for (uint i = 0u; i < params.collider_count; ++i) {
    ColliderShape shape = collider_shape(set, i);
    float side = longest_side(moved);
    if (side < kOpenCell * shape.core) continue;  // its pixels are enough
    ColliderPose after = collider_pose(set, substep + 1u, i);
    precise float way = max(length3(moved.a - start.a), max(length3(moved.b - start.b), length3(moved.c - start.c)));
    float gap = nearest_of_shape(set, shape, to_local(after, moved.a)).distance;
    if (out_of_reach(shape, gap - side, way)) continue;
    Corners before = corners_to_local(collider_pose(set, substep, i), start);
    moved = push_point(set, params, shape, after, moved, before, w, deepest_weights(set, shape, before));
    moved = push_point(set, params, shape, after, moved, before, w,
                       deepest_weights(set, shape, corners_to_local(after, moved)));
  }
  return moved;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
