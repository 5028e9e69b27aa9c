// SPDX-License-Identifier: Apache-2.0
// How a frame ends: springs that are still too long, in sharp folds above all, are tied to their longest length, and
// points keep the velocities that they have. Moved with them, cloth at rest would never rest: every frame its last
// substep would differ from the others. Macklin, Mueller, Chentanez, Kim 2014 ("Unified Particle Physics for Real-Time
// Applications", section 4.4) move what starts in contact in the same way before a step.
//
//   hold_way   previous = the way, carry = the place      between them positions move freely
//   give_way   back by friction, out of colliders, near thin ones back; previous and carry = what the way says
#ifndef GEOCLOTH_LIB_FINISH_H
#define GEOCLOTH_LIB_FINISH_H

#include "collide.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const float kGripped = 0.1f;         // [spacings] no farther off what a collider keeps away a point lies on it
const float kSlides = 0.03f;         // [spacings] a point that slides so far in a substep is not held
const float kFrictionHolds = 0.15f;  // [spacings] how far friction of 1 holds a point that rests on a collider

inline PointState way_held(PointState point) {
  PointState r;
  r.position = point.position;
  r.previous = way_of(point);
  r.carry = point.position;
  return r;
}

// Where colliders, as they are at the end of the substep, let a point go from `start`; nowhere if they do not agree.
inline vec3 kept_out(ColliderSet set, ClothParams params, uint substep, vec3 start, vec3 moved) {
  vec3 position = moved;
  vec3 last = vec3(0.0f, 0.0f, 0.0f);
  bool again = params.collider_count > 0u;
  for (uint round = 0u; round < kContactRounds && again; ++round) {
    again = false;
    float deep = worth_a_round(params, round);
    for (uint i = 0u; i < params.collider_count; ++i) {
      ColliderShape shape = collider_shape(set, i);
      ColliderPose pose = collider_pose(set, substep + 1u, i);
      vec3 local = to_local(set, shape, pose, position);
      vec3 from = to_local(set, shape, pose, start);
      Contact contact = find_contact(set, shape, from, local, params.thickness, kAnyWay, round == 0u);
      if (!contact.touches || contact.depth <= kContactSlack) continue;
      vec3 n = rotate_to_world(pose, contact.normal);
      precise vec3 out_of_it =
          position + way_out(n, contact.depth, params.thickness, slides_out(round) ? last : vec3(0.0f, 0.0f, 0.0f));
      position = out_of_it;
      last = n;
      again = again || ((params.collider_count > 1u || shape.kind == kShapeMesh) && contact.depth > deep);
    }
  }
  return again ? start : position;
}

// What friction leaves of a way from `start`. Of rest: nothing of a way as long as the brake, all of one twice as long,
// as springs that pull so much are not held by it for a frame. Of what presses the point onto the collider, as Coulomb
// says: its way along the surface is shorter by friction times its way into it, so that what hangs on one side of a
// body holds what hangs on the other, however far a frame's ties pull both.
inline vec3 braked(vec3 start, vec3 moved, float friction, float brake, float depth) {
  if (friction <= 0.0f) return moved;
  precise vec3 way = moved - start;
  float went = length3(way);
  precise float along_squared = went * went - depth * depth;
  float along = sqrt(max(along_squared, 0.0f));
  precise float pressed = friction * depth;
  if (went <= brake || along <= pressed) return start;
  precise float of_rest = 2.0f - 2.0f * (brake * (1.0f / went));
  precise float of_slide = 1.0f - pressed * (1.0f / along);
  precise float kept = min(of_rest, 1.0f) * of_slide;
  precise vec3 position = start + way * kept;
  return position;
}

struct HeldBack {
  vec3 position;
  bool stays;  // where it was, whatever colliders it is in
};

// Where friction and thin colliders let a point go from `start`.
//
// Ties know nothing of friction: what they move along a surface in every frame creeps there, and cloth that lies on a
// body trembles. So a point that rests on a collider is held, the less the faster it slides there.
//
// Where triangles meet thin colliders, only a substep keeps them apart. A triangle that is so near has all its corners
// within kLeaveNear spacings of the collider, and these stay where they are.
//
// (One loop over the places of the point, where it was, where it was moved to and what is left of that: shaders hold
// the distance to a shape as often as it is written down.)
inline HeldBack held_back(ColliderSet set, ClothParams params, uint substep, vec3 start, vec3 moved, vec3 way) {
  precise float left_within = params.thickness + params.leave_near;
  precise float held_within = params.thickness + kGripped * params.spacing;
  precise float per_gap = 1.0f / (kGripped * params.spacing);
  precise float per_slide = 1.0f / (kSlides * params.spacing);
  float friction = 0.0f, depth = 0.0f;
  HeldBack r;
  r.position = start;
  r.stays = false;
  for (uint turn = 0u; turn < 3u; ++turn) {
    for (uint i = 0u; i < params.collider_count; ++i) {
      ColliderShape shape = collider_shape(set, i);
      float own = sqrt(params.friction * shape.friction);
      bool grips = turn == 0u && own > friction;
      bool presses = turn == 1u && friction > 0.0f && own > 0.0f;
      bool leaves = turn != 1u && params.leave_near > 0.0f && is_thin(params, shape);
      if (!grips && !presses && !leaves) continue;
      ColliderPose after = collider_pose(set, substep + 1u, i);
      vec3 local = to_local(set, shape, after, r.position);
      float distance = nearest_of_shape(set, shape, local).distance;
      if (presses) {
        precise float into = params.thickness - distance;
        depth = max(depth, min(into, params.grip));
        continue;
      }
      if (leaves && distance < left_within) {
        r.position = start;
        r.stays = true;
        return r;
      }
      precise float lies = per_gap * (held_within - distance);
      if (!grips || lies <= 0.0f) continue;
      vec3 carried = carried_by(set, shape, collider_pose(set, substep, i), after, local);
      precise vec3 slid = way - carried;
      precise float rests = 1.0f - per_slide * length3(slid);
      precise float holds = own * (max(rests, 0.0f) * min(lies, 1.0f));
      friction = max(friction, holds);
    }
    precise float brake = friction * (kFrictionHolds * params.spacing);
    if (turn == 0u) r.position = moved;
    if (turn == 1u) r.position = braked(start, moved, friction, brake, depth);
  }
  return r;
}

inline PointState way_given(ColliderSet set, ClothParams params, uint substep, PointState held) {
  vec3 start = held.carry;
  HeldBack moved = held_back(set, params, substep, start, held.position, held.previous);
  if (moved.stays) return arrived(start, held.previous);
  return arrived(kept_out(set, params, substep, start, moved.position), held.previous);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
