// SPDX-License-Identifier: Apache-2.0
// Contact of a point with any number of colliders, with Coulomb friction (Macklin, Mueller, Chentanez, Kim 2014,
// "Unified Particle Physics for Real-Time Applications", section 6.1) on the displacement relative to the collider's.
//
// The includer defines before this file:
//   struct ColliderSet (a handle, of a point), ColliderSet set_of_point(ColliderSet set, float mass_inverse, float
//   yield),
//   ColliderShape collider_shape(ColliderSet set, uint i),
//   ColliderPose collider_pose(ColliderSet set, uint pose, uint i)   with pose s before substep s and s + 1 after it,
//   float collider_number(ColliderSet set, uint i),
//   void add_contact(ColliderSet set, uint i, vec3 way, vec3 n, vec3 position)   sums by how much a contact with this
//     normal has changed the way of a point that lies there then, see lib/contact_sum.h.
#ifndef GEOCLOTH_LIB_COLLIDE_H
#define GEOCLOTH_LIB_COLLIDE_H

#include "../shared/layout.h"
#include "frame.h"
#include "point_state.h"
#include "shapes.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kSweepSteps = 32u;
const float kSweepClose = 1e-3f;  // [m] nearer than this to the surface the sweep has arrived
const uint kContactRounds = 12u;
const uint kSlidingRound = 5u;      // the first one of slides_out()
const float kContactSlack = 1e-6f;  // [m] overlap that is not worth a push in a later round
const float kSettled = 0.0625f;     // thicknesses: a push that is no longer leaves too little for another round
const float kNarrowest = 0.02f;     // squared sine between two colliders' surfaces: in a narrower wedge none slides
const float kFarthestOut = 32.0f;   // in depths: how far a point is moved when nothing else helped
const uint kNormalsOfCleft = 24u;
const uint kWaySteps = 20u;
const uint kWayHalvings = 6u;

struct Contact {
  bool touches;
  vec3 normal;  // of the collider, in its frame
  float depth;  // [m] how far the point is to be pushed out
};

const uint kDeformSteps = 2u;

// Where what is at q of a deforming body's frame will be at the end of the frame: the x with x - left way(x) = q, for
// the ways are those of points at the end. Iterated, as a point and its neighbours go nearly alike.
// @param left  0: nothing deforms
inline vec3 deformed(ColliderSet set, ColliderShape shape, float left, vec3 q) {
  vec3 x = q;
  uint steps = left > 0.0f ? kDeformSteps : 0u;
  for (uint i = 0u; i < steps; ++i) x = shifted(q, deforming_way(set, shape, x), left);
  return x;
}

inline vec3 to_local(ColliderSet set, ColliderShape shape, ColliderPose pose, vec3 p) {
  precise vec3 d = p - vec3(pose.row0.w, pose.row1.w, pose.row2.w);
  precise vec3 r = xyz(pose.row0) * d.x + xyz(pose.row1) * d.y + xyz(pose.row2) * d.z;
  return deformed(set, shape, pose.deform.x, r);
}

inline vec3 rotate_to_world(ColliderPose pose, vec3 v) {
  return vec3(dot3(xyz(pose.row0), v), dot3(xyz(pose.row1), v), dot3(xyz(pose.row2), v));
}

// As if nothing deformed.
inline vec3 rigid_to_world(ColliderPose pose, vec3 p) {
  precise vec3 r = rotate_to_world(pose, p) + vec3(pose.row0.w, pose.row1.w, pose.row2.w);
  return r;
}

// How far what is at p of a collider's frame, of a body that deforms at the end of the frame, goes in a substep.
inline vec3 carried_by(ColliderSet set, ColliderShape shape, ColliderPose before, ColliderPose after, vec3 p) {
  vec3 from = p;
  vec3 to = p;
  if (before.deform.x > 0.0f) {
    vec3 way = deforming_way(set, shape, p);
    from = shifted(p, way, -before.deform.x);
    to = shifted(p, way, -after.deform.x);
  }
  precise vec3 r = rigid_to_world(after, to) - rigid_to_world(before, from);
  return r;
}

const float kThin = 1.05f;  // spacings

// Whether a collider is thin enough to slip through between pixels.
inline bool is_thin(ClothParams params, ColliderShape shape) {
  return half_thickness(shape) < kThin * params.spacing;
}

inline bool is_edged(ColliderShape shape) {
  return shape.kind == kShapeBox || shape.kind == kShapeConvex || shape.kind == kShapeMesh;
}

// [m] The depth of a contact that friction grows with. A point that its springs draw deep into a solid in one substep
// is caught behind an edge, and friction as large as that pull would hold it there however far they are stretched.
// On a body garments slip and stretch by a bound, and cloth leaves its edges without one.
inline float largest_grip(ClothParams params, ColliderShape shape) {
  bool bounded = shape.kind == kShapeBox || shape.kind == kShapeConvex;
  return bounded ? params.grip : 1e30f;
}

inline Contact no_contact() {
  Contact r;
  r.touches = false;
  r.normal = vec3(0.0f, 1.0f, 0.0f);
  r.depth = 0.0f;
  return r;
}

const float kAnyWay = 1e30f;  // [m] of a point: nothing is out of its reach

// A point that went `way` cannot have met a collider that is this far off. In the collider's frame it moved by at most
// way + T + F (R + gap), with the collider's translation T, the change F of its rotation and its radius R; shape.way is
// T + F R, and F is below a half.
inline bool out_of_reach(ColliderShape shape, float gap, float way) {
  precise float reach = 2.0f * (way + shape.way);
  return gap > reach;
}

const float kOpposed = -0.1f;  // cosine between normals of sides that a point must not change by going through

// Whether a point stays on the side that it entered from. Springs that cross an edge draw the points beside it right
// through the solid behind it, to where the next side is nearer: that is how cloth slips over the edge. Held back it
// would be caught there. Through to the other side is another matter.
inline bool stays_outside(ColliderShape shape, vec3 entered, vec3 nearest) {
  return !is_edged(shape) || dot3(entered, nearest) < kOpposed;
}

// Where a point that went p0 -> p1 in the collider's frame is in it. A way that is longer than the collider is thick is
// swept: the point is found where it enters, by steps as long as the distance to the surface, and kept on the outer
// side of the tangent plane there. A point that starts on the surface, or in it, has arrived already: it stays on the
// side that it came from. Bodies that deform are not swept: between parts of theirs that go different ways a point's
// way in their frame leads anywhere. One loop finds all distances, as shaders hold them as often as they are written
// down.
// @param reach  [m] how far the point went in the world; what is out of reach of it is not met
// @param swept  false: p0 is not asked for
inline Contact find_contact(ColliderSet set, ColliderShape shape, vec3 p0, vec3 p1, float thickness, float reach,
                            bool swept) {
  Contact at_end = no_contact();
  precise float way = swept ? length3(p1 - p0) : 0.0f;
  precise vec3 direction = vec3(0.0f, 0.0f, 0.0f);
  precise float travelled = 0.0f;
  float close = min(0.01f * shape.core, kSweepClose);
  for (uint i = 0u; i <= kSweepSteps; ++i) {
    precise vec3 on_way = p0 + direction * travelled;
    vec3 q = i == 0u ? p1 : on_way;
    Nearest near = nearest_of_shape(set, shape, q);
    precise float gap = near.distance - thickness;
    if (i == 0u) {
      if (gap > way || out_of_reach(shape, gap, reach)) return at_end;
      at_end.touches = gap < 0.0f;
      at_end.normal = near.normal;
      at_end.depth = -gap;
      if (!(way > 0.5f * shape.core)) return at_end;
      direction = (p1 - p0) * (1.0f / way);
      continue;
    }
    if (gap < close) {
      precise float height = dot3(p1 - q, near.normal) + gap;
      if (height < 0.0f && stays_outside(shape, near.normal, at_end.normal)) {
        at_end.touches = true;
        at_end.normal = near.normal;
        at_end.depth = -height;
      }
      return at_end;
    }
    travelled = travelled + gap;
    if (travelled >= way) return at_end;
  }
  return at_end;
}

// Straight out of one collider and then of another takes a point out of a wedge of 20 degrees by an eighth in each
// round. Where that was not enough, a point that is still in a collider, not in its thickness only, goes along the
// surface of the one that it was pushed out of before. Not sooner: what is moved far trembles.
inline bool slides_out(uint round) {
  return round >= kSlidingRound && (round & 1u) == 1u;
}

// [m] How deep a contact must be for another round. A push leaves at most what it was itself, where it led into another
// collider, and of a field, which is not quite a distance, a part of that. Later what has come out is left alone: in
// clefts that are narrower than two thicknesses no round would be the last.
inline float worth_a_round(ClothParams params, uint round) {
  return max(kContactSlack, round < kSlidingRound ? kSettled * params.thickness : params.thickness);
}

// @param last  normal of the collider that the point was pushed out of before, 0: of none
inline vec3 way_out(vec3 normal, float depth, float thickness, vec3 last) {
  precise float c = min(dot3(normal, last), 0.0f);
  precise float open = 1.0f - c * c;
  if (open < kNarrowest || depth < thickness) return shifted(vec3(0.0f, 0.0f, 0.0f), normal, depth);
  precise float along = depth * (1.0f / open);
  precise vec3 way = (normal - last * c) * along;
  return way;
}

// What friction takes back of a way along a surface.
// @param brake  [m] at most
inline vec3 braked_way(vec3 way, vec3 n, float brake) {
  precise vec3 sliding = way - n * dot3(way, n);
  precise float slid = length3(sliding);
  precise vec3 back = sliding * (slid > brake ? brake * (1.0f / slid) : 1.0f);
  return back;
}

// Pushes the point out; takes away what of the relative displacement leads inwards, never adds
// speed for the push itself (a point that starts deep inside comes out at rest), and brakes the rest by friction, which
// takes back how far other layers moved the point, too: what they press against a slope would creep down on it.
// @param n          the contact's normal in the world
// @param out_of_it  [m] how the point is moved out
// @param grip       [m] see largest_grip()
// @param layers     other layers may have moved it
inline PointState respond(ColliderSet set, uint collider, ColliderShape shape, PointState point, ColliderPose before,
                          ColliderPose after, vec3 local, Contact contact, vec3 n, vec3 out_of_it, float friction,
                          float grip, bool layers) {
  precise vec3 on_surface = local + contact.normal * contact.depth;
  vec3 carried = carried_by(set, shape, before, after, on_surface);
  vec3 displacement = way_of(point);
  precise vec3 relative = displacement - carried;
  precise float along = dot3(relative, n);
  precise vec3 sliding = relative - n * along;
  precise float slid = length3(sliding);
  precise float brake = friction * min(contact.depth, grip);
  precise float held = slid > brake ? brake * (1.0f / slid) : 1.0f;

  precise vec3 back = sliding * held;
  if (layers) back = braked_way(point.position - point.previous - carried, n, brake);

  precise vec3 position = point.position + out_of_it - back;
  precise vec3 kept = carried + sliding * (1.0f - held) + n * max(along, 0.0f);
  precise vec3 changed = kept - displacement;
  add_contact(set, collider, changed, n, position);
  return arrived(position, kept);
}

inline PointState limit_speed(PointState point, float max_step) {
  vec3 displacement = way_of(point);
  precise float way = length3(displacement);
  PointState r = point;
  if (way > max_step) {
    precise vec3 position = point.previous + displacement * (max_step * (1.0f / way));
    r.position = position;
    r.carry = vec3(0.0f, 0.0f, 0.0f);
  }
  return r;
}

// What holds a point: how deep it is in the deepest collider and its normal, the normal of the one that it touches
// which leads least along a direction, and how far along that it is out of each, at most, where they are convex.
struct Held {
  float depth;
  vec3 normal;
  vec3 steepest;
  float way;
};

inline Held held_by(ColliderSet set, ClothParams params, uint substep, vec3 p, vec3 direction) {
  Held r;
  r.depth = 0.0f;
  r.normal = vec3(0.0f, 0.0f, 0.0f);
  r.steepest = vec3(0.0f, 0.0f, 0.0f);
  r.way = 0.0f;
  float least = 1e30f;
  for (uint i = 0u; i < params.collider_count; ++i) {
    ColliderPose pose = collider_pose(set, substep + 1u, i);
    ColliderShape shape = collider_shape(set, i);
    Nearest near = nearest_of_shape(set, shape, to_local(set, shape, pose, p));
    if (near.distance > params.thickness + 10.0f * kContactSlack) continue;
    vec3 n = rotate_to_world(pose, near.normal);
    float slope = dot3(n, direction);
    if (slope < least) {
      least = slope;
      r.steepest = n;
    }
    if (near.distance >= -kContactSlack) continue;
    precise float way = -near.distance * (1.0f / max(slope, 1.0f / kFarthestOut));
    r.way = max(r.way, way);
    if (-near.distance <= r.depth) continue;
    r.depth = -near.distance;
    r.normal = n;
  }
  return r;
}

// Where the rounds were not enough, as in the cleft of two solids that lean on each other or close on cloth: straight
// out of the cleft from its middle, or back towards where the point was, whichever is shorter. Where neither leads out
// the point stays. Straight out is nearly towards the point of the normals' hull that is nearest to the origin (Gilbert
// 1966; the mean of the steepest one, again and again); how far is found by Newton's method and halving. All in one
// loop, so that shaders hold the shapes' distances once more and not six times.
inline vec3 out_of_cleft(ColliderSet set, ClothParams params, uint substep, vec3 start, vec3 position) {
  vec4 back = unit_and_length(start - position);
  vec3 out_of_it = position;
  vec3 from = position;
  vec3 direction = vec3(0.0f, 0.0f, 0.0f);
  float t = 0.0f;
  float inside = 0.0f;
  float outside = -1.0f;
  float most = 0.0f;
  uint ways = 0u;
  uint steps = 0u;
  uint halvings = 0u;
  for (uint i = 0u; ways < 2u; ++i) {
    Held held = held_by(set, params, substep, shifted(from, direction, t), direction);
    if (i == 0u) {
      if (held.depth == 0.0f) ways = 2u;
      from = shifted(position, held.normal, 0.5f * held.depth);
      most = kFarthestOut * held.depth;
    } else if (i <= kNormalsOfCleft) {
      direction = shifted(direction, held.steepest, 1.0f);
      if (i == kNormalsOfCleft) direction = xyz(unit_and_length(direction));
    } else {
      bool none = false;
      if (held.depth == 0.0f) {
        outside = t;
      } else {
        inside = t;
        none = t >= most;
      }
      ++steps;
      if (outside >= 0.0f) {
        t = 0.5f * (inside + outside);
        ++halvings;
      } else {
        t = min(t + held.way, most);
      }
      if (none || steps == kWaySteps || halvings == kWayHalvings) {
        if (outside >= 0.0f) out_of_it = shifted(from, direction, outside);
        most = outside >= 0.0f ? min(outside, back.w) : back.w;
        from = position;
        direction = xyz(back);
        t = 0.0f;
        inside = 0.0f;
        outside = -1.0f;
        steps = 0u;
        halvings = 0u;
        ++ways;
      }
    }
  }
  return out_of_it;
}

// All colliders in their order, with sweep and friction; then, while the point is still in one of several, it is only
// pushed out, until all agree or the rounds are used up.
inline PointState push_out(ColliderSet set, ClothParams params, uint substep, PointState point) {
  PointState state = point;
  vec3 start = state.previous;
  vec3 last = vec3(0.0f, 0.0f, 0.0f);
  bool again = params.collider_count > 0u;
  bool layers = params.self_points + params.inter_points > 0u;
  for (uint round = 0u; round < kContactRounds && again; ++round) {
    again = false;
    float deep = worth_a_round(params, round);
    float way = length3(state.position - start);
    for (uint i = 0u; i < params.collider_count; ++i) {
      ColliderShape shape = collider_shape(set, i);
      ColliderPose after = collider_pose(set, substep + 1u, i);
      vec3 local = to_local(set, shape, after, state.position);
      ColliderPose before = collider_pose(set, substep, i);
      bool swept = round == 0u && before.deform.x == 0.0f;
      vec3 from = local;
      if (swept) from = to_local(set, shape, before, start);
      Contact contact = find_contact(set, shape, from, local, params.thickness, way, swept);
      if (contact.touches && (round == 0u || contact.depth > kContactSlack)) {
        float friction = round == 0u ? sqrt(params.friction * shape.friction) : 0.0f;
        vec3 n = rotate_to_world(after, contact.normal);
        vec3 out_of_it = way_out(n, contact.depth, params.thickness, slides_out(round) ? last : vec3(0.0f, 0.0f, 0.0f));
        float grip = largest_grip(params, shape);
        state = respond(set, i, shape, state, before, after, local, contact, n, out_of_it, friction, grip, layers);
        last = n;
        way = length3(state.position - start);
        again = again || ((params.collider_count > 1u || shape.kind == kShapeMesh) && contact.depth > deep);
      }
    }
  }
  if (!again) return state;
  return arrived(out_of_cleft(set, params, substep, start, state.position), way_of(state));
}

// What a point is before it meets colliders: no faster than ClothParams::max_step.
inline PointState slowed(ClothParams params, PointState point) {
  if (params.max_step > 0.0f) return limit_speed(point, params.max_step);
  return point;
}

// On a moving parent the stored displacement leaves out `taken`, what the cloth was taken along with in this substep;
// colliders meet all of it.
inline PointState collide(ColliderSet set, ClothParams params, uint substep, PointState point) {
  bool moving = params.moving != 0u;
  PointState whole = point;
  if (moving) whole.previous = field_back(params.taken, float(substep), point.previous);
  PointState after = push_out(set, params, substep, whole);
  if (!moving) return after;
  precise vec3 taken = point.previous - whole.previous;
  precise vec3 displacement = ((after.position - after.previous) - taken) + after.carry;
  return arrived(after.position, displacement);
}

// Largest depth [m] of a point below a collider's surface after a substep; 0 outside of all.
inline float depth_in_colliders(ColliderSet set, uint collider_count, uint substep, vec3 position) {
  float depth = 0.0f;
  for (uint i = 0u; i < collider_count; ++i) {
    ColliderShape shape = collider_shape(set, i);
    vec3 local = to_local(set, shape, collider_pose(set, substep + 1u, i), position);
    depth = max(depth, -nearest_of_shape(set, shape, local).distance);
  }
  return depth;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
