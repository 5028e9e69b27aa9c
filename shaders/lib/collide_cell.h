// SPDX-License-Identifier: Apache-2.0
// Contact of the triangles between pixels: a collider that is smaller than a cell must not slip through between its
// corners. The point of a triangle that is deepest in the collider is found once where the substep began and once where
// it ends; it is then a point like a pixel, swept as in collide.h, and what pushes it out is shared by the corners by
// their weights and masses.
//
// Loops of two or three turns keep shaders small: their compilers inline every call, and the distance to a shape is a
// hundred lines.
//
// A push stops a corner that moves into the collider, as seen from the collider; no corner is ever thrown. What else it
// has to be moved by moves its place and leaves its velocity. Friction and the cloth's thickness are the pixels' own.
#ifndef GEOCLOTH_LIB_COLLIDE_CELL_H
#define GEOCLOTH_LIB_COLLIDE_CELL_H

#include "collide.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const float kOpenCell = 0.5f;  // sides of a triangle that a collider may sink into, in its half thicknesses
const uint kDeepestSteps = 8u;
const float kArrived = 1e-3f;      // of a weight: a step that changes less is the last
const float kGapRounding = 4e-6f;  // [m], and of a distance: what single precision takes from a gap
const float kLiftSpeed = 1.0f;  // [m/s] at which, besides the collider's own, a triangle that begins inside comes out

const float kThinEdged = 3.0f;  // spacings; half of what a box or a hull is thick whose edges lead in between points
const float kStirs = 0.01f;     // spacings in a substep from which on they do: cloth that lies over edges at rest has
                                // triangles inside for good, which would be pushed out in every substep

// Whether a collider opens cells between points. Where it is thick it does not, as points give way as lib/yield.h has
// it; a sharp corner does, however thick the hull is behind it.
inline bool opens_cells(float spacing, ColliderShape shape) {
  return half_thickness(shape) < kThin * spacing || (shape.kind == kShapeConvex && shape.b.z > 0.0f);
}

inline bool has_edges(ColliderShape shape) {
  return shape.kind == kShapeBox || shape.kind == kShapeConvex;
}

inline bool stirs(float spacing, ColliderShape shape) {
  return shape.way > kStirs * spacing;
}

// Whether triangles meet a collider themselves, so that it does not slip through between points.
inline bool meets_triangles(float spacing, ColliderShape shape) {
  bool leads_in = has_edges(shape) && half_thickness(shape) < kThinEdged * spacing && stirs(spacing, shape);
  return opens_cells(spacing, shape) || leads_in;
}

// What a collider in whose way a triangle lies may push it further out by in a substep [m] than the triangle came in:
// the collider's own way, and what brings a triangle out that begins inside. Cloth over an edge that is thinner than
// its cells has triangles inside for good: pushed out in every substep it would never come to rest.
inline float lift_of(ClothParams params, ColliderShape shape) {
  bool rests = has_edges(shape) && !stirs(params.spacing, shape);
  precise float lift = shape.way + (rests ? 0.0f : kLiftSpeed * params.dt);
  return lift;
}

// Sides [m] from which on a triangle meets a collider itself. Smaller ones are kept out well enough by their pixels.
inline float open_side(ClothParams params, ColliderShape shape) {
  bool meets = meets_triangles(params.spacing, shape);
  return meets ? kOpenCell * min(half_thickness(shape), params.spacing) : 1e30f;
}

struct Corners {
  vec3 a;
  vec3 b;
  vec3 c;
};

inline vec3 corner_of(Corners t, uint i) {
  return i == 0u ? t.a : (i == 1u ? t.b : t.c);
}

inline Corners with_corner(Corners t, uint i, vec3 p) {
  Corners r = t;
  if (i == 0u) r.a = p;
  if (i == 1u) r.b = p;
  if (i == 2u) r.c = p;
  return r;
}

inline vec3 at_weights(Corners t, vec3 weights) {
  precise vec3 r = t.a * weights.x + t.b * weights.y + t.c * weights.z;
  return r;
}

inline Corners corners_to_local(ColliderSet set, ColliderShape shape, ColliderPose pose, Corners t) {
  Corners r = t;
  for (uint i = 0u; i < 3u; ++i) r = with_corner(r, i, to_local(set, shape, pose, corner_of(t, i)));
  return r;
}

inline float longest_side(Corners t) {
  return max(length3(t.b - t.a), max(length3(t.c - t.b), length3(t.a - t.c)));
}

// What the corner goes that goes farthest.
inline float way_of_corners(Corners from, Corners to) {
  precise float way = max(length3(to.a - from.a), max(length3(to.b - from.b), length3(to.c - from.c)));
  return way;
}

// Weights of the point of a triangle that is nearest to p (Ericson 2005, "Real-Time Collision Detection", 5.1.5).
inline vec3 nearest_weights(Corners t, vec3 p) {
  precise vec3 ab = t.b - t.a;
  precise vec3 ac = t.c - t.a;
  precise vec3 ap = p - t.a;
  precise vec3 bp = p - t.b;
  precise vec3 cp = p - t.c;
  float d1 = dot3(ab, ap);
  float d2 = dot3(ac, ap);
  float d3 = dot3(ab, bp);
  float d4 = dot3(ac, bp);
  float d5 = dot3(ab, cp);
  float d6 = dot3(ac, cp);
  precise float vc = d1 * d4 - d3 * d2;
  precise float vb = d5 * d2 - d1 * d6;
  precise float va = d3 * d6 - d5 * d4;
  precise float v = 0.0f;
  precise float w = 0.0f;
  if (d1 <= 0.0f && d2 <= 0.0f) {
    v = 0.0f;  // a
  } else if (d3 >= 0.0f && d4 <= d3) {
    v = 1.0f;  // b
  } else if (d6 >= 0.0f && d5 <= d6) {
    w = 1.0f;  // c
  } else if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) {
    v = d1 * (1.0f / max(d1 - d3, 1e-30f));
  } else if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) {
    w = d2 * (1.0f / max(d2 - d6, 1e-30f));
  } else if (va <= 0.0f && d4 >= d3 && d5 >= d6) {
    w = (d4 - d3) * (1.0f / max((d4 - d3) + (d5 - d6), 1e-30f));
    v = 1.0f - w;
  } else {
    precise float whole = 1.0f / max(va + vb + vc, 1e-30f);
    v = vb * whole;
    w = vc * whole;
  }
  // Never below zero by rounding: a free corner between two pinned ones would be thrown for kilometres.
  precise float u = max((1.0f - v) - w, 0.0f);
  return vec3(u, v, w);
}

// Weights of the point of a triangle, in the collider's frame, that is nearest to the collider or deepest in it: to and
// fro between the triangle and the collider's core, which is as deep in it as it is thick (von Neumann's alternating
// projections). For a ball the core is its centre, and the first step ends there.
inline vec3 deepest_weights(ColliderSet set, ColliderShape shape, Corners t) {
  const float third = 1.0f / 3.0f;
  vec3 weights = vec3(third, third, third);
  uint steps = shape.kind == kShapeSphere ? 1u : kDeepestSteps;
  for (uint i = 0u; i < steps; ++i) {
    vec3 p = at_weights(t, weights);
    Nearest near = nearest_of_shape(set, shape, p);
    vec3 next = nearest_weights(t, shifted(p, near.normal, -(near.distance + shape.core)));
    if (length3(next - weights) < kArrived) steps = 0u;
    weights = next;
  }
  return weights;
}

// A triangle on its way through a substep, as PointState. (Structs within structs send glslang into a loop.)
struct MovedTriangle {
  vec3 a;
  vec3 b;
  vec3 c;
  vec3 start_a;  // where the corners were when the substep began
  vec3 start_b;
  vec3 start_c;
};

inline Corners corners_of(MovedTriangle t) {
  Corners r;
  r.a = t.a;
  r.b = t.b;
  r.c = t.c;
  return r;
}

inline Corners first_corners_of(MovedTriangle t) {
  Corners r;
  r.a = t.start_a;
  r.b = t.start_b;
  r.c = t.start_c;
  return r;
}

inline MovedTriangle moved_triangle(Corners now, Corners start) {
  MovedTriangle r;
  r.a = now.a;
  r.b = now.b;
  r.c = now.c;
  r.start_a = start.a;
  r.start_b = start.b;
  r.start_c = start.c;
  return r;
}

struct MovedCorner {
  vec3 now;
  vec3 start;
};

// Moves a corner by n * push. What it moved into the collider is undone, the rest is moved as if it had begun there.
// @param n, local_n  normal of the collider in the world and in its frame
inline MovedCorner push_corner(ColliderSet set, ColliderShape shape, ColliderPose before, ColliderPose after, vec3 now,
                               vec3 start, vec3 n, vec3 local_n, float push) {
  precise float along = dot3(to_local(set, shape, after, now) - to_local(set, shape, before, start), local_n);
  precise float kept = max(push + min(along, 0.0f), 0.0f);
  MovedCorner r;
  r.now = shifted(now, n, push);
  r.start = shifted(start, n, kept);
  return r;
}

// By how much more a corner goes in the substep now than before. (A function, for glslang does not come to an end where
// it follows what is precise through the structs.)
inline vec3 change_of_way(vec3 now, vec3 start, vec3 moved, vec3 moved_start) {
  precise vec3 r = (moved - moved_start) - (now - start);
  return r;
}

const float kLargestLever = 4.0f;  // way of a corner against that of the point that it lifts; 1.4 where all are free

// One contact of the point of these weights.
// @param start  the corners when the substep began, in the collider's frame of then
// @param w      inverse masses of the corners
inline MovedTriangle push_point(ColliderSet set, ClothParams params, uint collider, ColliderShape shape,
                                ColliderPose before, ColliderPose after, MovedTriangle t, Corners start, vec3 w,
                                vec3 weights) {
  vec3 p0 = at_weights(start, weights);
  vec3 p1 = to_local(set, shape, after, at_weights(corners_of(t), weights));
  bool swept = before.deform.x == 0.0f;
  Contact contact = find_contact(set, shape, p0, p1, 0.0f, kAnyWay, swept);
  precise vec3 share = w * weights;
  precise float sum = dot3(share, weights);
  if (!contact.touches || sum <= 0.0f) return t;
  precise float approach = max(dot3(p0 - p1, contact.normal), 0.0f) + lift_of(params, shape);
  // Where only a corner with little weight is free it would be thrown far to lift the point by a little, again and
  // again where a collider is pushed in between held corners: the less the point gives way, the less is asked of the
  // corner.
  precise float least = max(share.x, max(share.y, share.z)) * (1.0f / kLargestLever);
  precise float lifted = min(sum * (1.0f / least), 1.0f);
  precise float push = min(contact.depth, approach) * lifted * (1.0f / max(sum, least));
  vec3 n = rotate_to_world(after, contact.normal);
  Corners now = corners_of(t);
  Corners began = first_corners_of(t);
  for (uint i = 0u; i < 3u; ++i) {
    float part = i == 0u ? share.x : (i == 1u ? share.y : share.z);
    MovedCorner moved =
        push_corner(set, shape, before, after, corner_of(now, i), corner_of(began, i), n, contact.normal, push * part);
    vec3 changed = change_of_way(corner_of(now, i), corner_of(began, i), moved.now, moved.start);
    add_contact(set_of_point(set, i == 0u ? w.x : (i == 1u ? w.y : w.z), 1.0f), collider, changed, n, moved.now);
    now = with_corner(now, i, moved.now);
    began = with_corner(began, i, moved.start);
  }
  return moved_triangle(now, began);
}

inline vec3 middle_of(Corners t) {
  const float third = 1.0f / 3.0f;
  return at_weights(t, vec3(third, third, third));
}

// No point of a triangle is nearer to the collider than this [m]. The distance to a convex solid lies above all of its
// tangent planes, so that where cloth rests on a solid the bound is less below its corners than the solid is bent.
// @param t     in the collider's frame
// @param near  of its middle
inline float least_gap(ColliderShape shape, Corners t, Nearest near, float side) {
  vec3 middle = middle_of(t);
  float a = dot3(t.a - middle, near.normal);
  float b = dot3(t.b - middle, near.normal);
  float c = dot3(t.c - middle, near.normal);
  precise float drop = shape.kind == kShapeMesh ? -side : min(a, min(b, c));
  precise float gap = near.distance + drop;
  return gap - kGapRounding * (1.0f + abs(near.distance));
}

const float kFlat = 0.05f;      // sides that a surface may be bent by below a triangle that its pixels are enough for
const float kShortWay = 0.25f;  // sides that it may have gone: a rod that it has passed is still near

// Whether a body's surface is flat below a triangle, so that no point of it is deeper than a corner.
// @param t     in the collider's frame
// @param near  of its middle
inline bool is_flat_below(ColliderSet set, ColliderShape shape, Corners t, Nearest near, float side) {
  vec3 middle = middle_of(t);
  float bent = 0.0f;
  for (uint i = 0u; i < 3u; ++i) {
    vec3 corner = corner_of(t, i);
    precise float level = nearest_of_shape(set, shape, corner).distance - dot3(corner - middle, near.normal);
    precise float off = level - near.distance;
    bent = max(bent, abs(off));
  }
  return bent < kFlat * side;
}

// @param w  inverse masses of the corners
inline MovedTriangle collide_triangle(ColliderSet set, ClothParams params, uint substep, MovedTriangle t, vec3 w) {
  MovedTriangle moved = t;
  if (max(w.x, max(w.y, w.z)) <= 0.0f) return moved;  // all held: nothing gives way
  float side = longest_side(corners_of(moved));
  for (uint i = 0u; i < params.collider_count; ++i) {
    ColliderShape shape = collider_shape(set, i);
    if (side < open_side(params, shape)) continue;
    Corners now = corners_of(moved);
    Corners start = first_corners_of(moved);
    ColliderPose after = collider_pose(set, substep + 1u, i);
    float way = way_of_corners(start, now);
    vec3 middle = vec3(after.row0.w, after.row1.w, after.row2.w);
    if (out_of_reach(shape, length3(now.a - middle) - shape.b.w - side, way)) continue;
    Corners last = corners_to_local(set, shape, after, now);
    Nearest near = nearest_of_shape(set, shape, middle_of(last));
    float gap = least_gap(shape, last, near, side);
    if (out_of_reach(shape, gap, way)) continue;
    ColliderPose before = collider_pose(set, substep, i);
    Corners first = corners_to_local(set, shape, before, start);
    // What is carried along by the collider has hardly moved as seen from there.
    float seen_way = way_of_corners(first, last);
    if (gap > seen_way) continue;
    if (shape.kind == kShapeMesh && seen_way < kShortWay * side && is_flat_below(set, shape, last, near, side)) {
      continue;
    }
    // The point that was deepest when the substep began, then the one that is at its end.
    Corners seen = first;
    for (uint turn = 0u; turn < 2u; ++turn) {
      moved = push_point(set, params, i, shape, before, after, moved, first, w, deepest_weights(set, shape, seen));
      if (turn == 0u) seen = corners_to_local(set, shape, after, corners_of(moved));
    }
    side = longest_side(corners_of(moved));
  }
  return moved;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
