// SPDX-License-Identifier: Apache-2.0
// Cloth against itself, or cloths against each other: points are balls that push each other apart, with friction
// (Macklin, Mueller, Chentanez, Kim 2014, section 6.1; the list of near points with a margin is Verlet's, 1967). Which
// points push:
//   - of one cloth, not those near along the surface, over seams too; of several, those of different cloths;
//   - layers that lie nearer than the distance at rest keep nine tenths of what they have there.
// Neighbours are looked up again when two points may have come nearer to each other by the margin: all points' ways
// since the last time lie in a box no longer than that. A hash of cells holds chains of points in any order; of what is
// found the nearest are kept, ordered by index, so that no result depends on the order.
//
// The includer defines before this file:
//   struct SelfSet (a handle), bool between_cloths(SelfSet set), uint self_word(SelfSet set, uint i), void
//   set_self_word(SelfSet set, uint i, uint value), SelfPoint self_point(SelfSet set, uint i), and of one cloth: vec3
//   pixel_position(SelfSet set, uint pixel), PointState pixel_state(SelfSet set, uint pixel), float
//   pixel_inverse_mass(SelfSet set, uint pixel): 0 while pinned.
#ifndef GEOCLOTH_LIB_SELF_COLLIDE_H
#define GEOCLOTH_LIB_SELF_COLLIDE_H

#include "../shared/layout.h"
#include "point_state.h"
#include "self_words.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const float kSelfFarthest = 1e5f;  // [m] points beyond, or nowhere, do not collide
const float kSelfFarthestCell = 2e9f;
const float kSelfShare = 0.7f;  // of an overlap that a pair removes in a substep: with less, fast layers get through;
                                // with 1 the several pairs of a point throw it back
const float kSelfRestShare = 0.9f;    // of their distance at rest that near layers keep
const float kSelfLongestPush = 0.5f;  // of the distance, in a substep
const float kSelfNoWay = 1e-9f;       // [m] points as near as this have no direction
const float kInterLeast = 0.75f;      // of the larger distance of two cloths; half the diagonal of a cell is 0.59

inline bool self_is_near(float v) {
  return (floatBitsToUint(v) & 0x7FFFFFFFu) < floatBitsToUint(kSelfFarthest);  // on the bits: not for NaN either
}

inline bool self_in_range(vec3 p) {
  return self_is_near(p.x) && self_is_near(p.y) && self_is_near(p.z);
}

// As unsigned numbers these order as the floats do.
inline uint ordered_bits(float v) {
  uint bits = floatBitsToUint(v);
  return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

inline float from_ordered_bits(uint ordered) {
  return uintBitsToFloat((ordered & 0x80000000u) != 0u ? ordered & 0x7FFFFFFFu : ~ordered);
}

inline vec3 self_vector(SelfSet set, uint word) {
  return vec3(uintBitsToFloat(self_word(set, word)), uintBitsToFloat(self_word(set, word + 1u)),
              uintBitsToFloat(self_word(set, word + 2u)));
}

inline void set_self_vector(SelfSet set, uint word, vec3 v) {
  set_self_word(set, word, floatBitsToUint(v.x));
  set_self_word(set, word + 1u, floatBitsToUint(v.y));
  set_self_word(set, word + 2u, floatBitsToUint(v.z));
}

// Where a point is and how it got there: of several cloths as it was gathered when the substep began.
inline vec3 self_position(SelfSet set, SelfRoom room, uint point) {
  if (between_cloths(set)) return self_vector(set, inter_state_word(room, point));
  return pixel_position(set, self_point(set, point).pixel);
}

inline PointState self_state(SelfSet set, SelfRoom room, uint point) {
  if (!between_cloths(set)) return pixel_state(set, self_point(set, point).pixel);
  uint word = inter_state_word(room, point);
  PointState r;
  r.position = self_vector(set, word);
  r.previous = r.position;
  r.carry = self_vector(set, word + 3u);
  return r;
}

inline bool self_is_held(SelfSet set, SelfRoom room, uint point) {
  if (between_cloths(set)) return self_word(set, inter_state_word(room, point) + 6u) != 0u;
  return pixel_inverse_mass(set, self_point(set, point).pixel) == 0.0f;
}

// Puts a point of a cloth among those of several.
inline void gather_state(SelfSet set, SelfRoom room, uint point, PointState state, bool held) {
  uint word = inter_state_word(room, point);
  set_self_vector(set, word, state.position);
  set_self_vector(set, word + 3u, way_of(state));
  set_self_word(set, word + 6u, held ? 1u : 0u);
}

// [m] that two points keep. A point of a fine cloth must not fit through the cells of a coarse one, so it is no less
// than a share of the larger of theirs.
inline float self_pair_distance(SelfSet set, SelfRoom room, SelfPoint a, SelfPoint b) {
  if (!between_cloths(set)) return room.distance;
  precise float mean = 0.5f * (uintBitsToFloat(a.inter_distance) + uintBitsToFloat(b.inter_distance));
  precise float least = kInterLeast * max(uintBitsToFloat(a.inter_distance), uintBitsToFloat(b.inter_distance));
  return max(mean, least);
}

// [m] up to which a pair is listed.
inline float self_pair_reach(SelfSet set, SelfRoom room, SelfPoint a, SelfPoint b) {
  if (!between_cloths(set)) return room.reach;
  precise float reach = self_pair_distance(set, room, a, b) + (room.reach - room.distance);
  return reach;
}

inline float self_pair_friction(SelfSet set, SelfRoom room, SelfPoint a, SelfPoint b) {
  if (!between_cloths(set)) return room.friction;
  precise float mean = 0.5f * (uintBitsToFloat(a.inter_friction) + uintBitsToFloat(b.inter_friction));
  return mean;
}

struct SelfDrift {
  uvec2 x;  // lowest, highest
  uvec2 y;
  uvec2 z;
};

inline SelfDrift no_drift() {
  SelfDrift r;
  r.x = uvec2(kSelfNone, 0u);
  r.y = r.x;
  r.z = r.x;
  return r;
}

inline vec3 self_seen(SelfSet set, SelfRoom room, uint point) {
  return self_vector(set, self_seen_word(room, point));
}

// Where a point is from where it was seen.
inline SelfDrift self_drift(SelfSet set, SelfRoom room, uint point) {
  SelfDrift r = no_drift();
  vec3 position = self_position(set, room, point);
  if (!self_in_range(position)) return r;
  precise vec3 way = position - self_seen(set, room, point);
  if (!self_in_range(way)) {  // it was nowhere
    r.x = uvec2(0u, kSelfNone);
    return r;
  }
  r.x = uvec2(ordered_bits(way.x), ordered_bits(way.x));
  r.y = uvec2(ordered_bits(way.y), ordered_bits(way.y));
  r.z = uvec2(ordered_bits(way.z), ordered_bits(way.z));
  return r;
}

inline float self_extent(SelfSet set, uint axis) {
  uint low = self_word(set, kSelfLow + axis), high = self_word(set, kSelfHigh + axis);
  precise float extent = low > high ? 0.0f : from_ordered_bits(high) - from_ordered_bits(low);
  return extent;
}

// Whether neighbours have to be looked up. Not in two substeps running: what gets into the margin twice as fast is
// still met on its own side of the other layer.
inline bool self_is_stale(SelfSet set, SelfRoom room) {
  uint age = self_word(set, kSelfAge);
  if (age < kSelfLeastAge) return age == 0u;
  if (self_word(set, kSelfHigh) == kSelfNone) return true;
  vec3 extent = vec3(self_extent(set, 0u), self_extent(set, 1u), self_extent(set, 2u));
  precise float margin = room.reach - room.distance;
  return length3(extent) > margin;
}

// Neighbours are a substep older, and ways are measured anew; once they have been found.
inline void self_begin(SelfSet set, SelfRoom room) {
  uint age = self_is_stale(set, room) ? 0u : self_word(set, kSelfAge);
  set_self_word(set, kSelfAge, age < kSelfLeastAge ? age + 1u : age);
  for (uint axis = 0u; axis < 3u; ++axis) {
    set_self_word(set, kSelfLow + axis, kSelfNone);
    set_self_word(set, kSelfHigh + axis, 0u);
  }
}

struct SelfCell {
  uint x;
  uint y;
  uint z;
};

inline uint self_cell_of(float q) {
  return uint(int(max(-kSelfFarthestCell, min(kSelfFarthestCell, floor(q)))));
}

inline SelfCell self_cell(SelfRoom room, vec3 p) {
  precise vec3 q = p * (1.0f / room.reach);
  SelfCell r;
  r.x = self_cell_of(q.x);
  r.y = self_cell_of(q.y);
  r.z = self_cell_of(q.z);
  return r;
}

inline uint self_hash(SelfRoom room, SelfCell cell, uint layer) {
  uint h = (cell.x * 73856093u) ^ (cell.y * 19349663u) ^ (cell.z * 83492791u) ^ (layer * 0x9E3779B9u);
  h = (h ^ (h >> 15u)) * 0x2C1B3C6Du;
  return (h ^ (h >> 13u)) & (room.buckets - 1u);
}

// Each of several cloths has buckets of its own, so that nobody goes through those of its own cloth; from the last
// layer on they share them. The number of points in a cell, and bits for their layers, are in the bucket of layer 0.
const uint kInterLayers = 8u;
inline uint self_layer(SelfSet set, SelfPoint point) {
  if (!between_cloths(set)) return 0u;
  return point.inter_cloth < kInterLayers - 1u ? point.inter_cloth : kInterLayers - 1u;
}

// Whether two points never push: near along the surface, or of one cloth where several meet.
inline bool self_pass(SelfSet set, SelfRoom room, SelfPoint own, uint other) {
  if (between_cloths(set)) return own.inter_cloth == self_point(set, other).inter_cloth;
  uint first = self_skip_word(room);
  for (uint k = own.skip_begin; k < own.skip_end; ++k) {
    if (self_word(set, first + k) == other) return true;
  }
  return false;
}

// Of two neighbours of a point: is the first nearer, or as near and the first in order?
inline bool self_is_nearer(float distance2, uint point, float other_distance2, uint other) {
  return distance2 < other_distance2 || (distance2 == other_distance2 && point < other);
}

inline float self_distance2(SelfSet set, SelfRoom room, vec3 from, uint point) {
  vec3 d = self_seen(set, room, point) - from;
  return dot3(d, d);
}

// Adds a neighbour to a list of `count`; in a full one it takes the place of the farthest, if that is farther.
inline uint self_keep(SelfSet set, SelfRoom room, uint own, uint count, vec3 from, uint neighbor) {
  uint place = count;
  if (count == kSelfMostNeighbors) {
    place = 0u;
    uint farthest = self_word(set, self_neighbor_word(room, own, 0u)) & ~kSelfThinBit;
    float farthest2 = self_distance2(set, room, from, farthest);
    for (uint k = 1u; k < count; ++k) {
      uint other = self_word(set, self_neighbor_word(room, own, k)) & ~kSelfThinBit;
      float other2 = self_distance2(set, room, from, other);
      if (self_is_nearer(farthest2, farthest, other2, other)) {
        place = k;
        farthest = other;
        farthest2 = other2;
      }
    }
    uint point = neighbor & ~kSelfThinBit;
    if (!self_is_nearer(self_distance2(set, room, from, point), point, farthest2, farthest)) return count;
  }
  set_self_word(set, self_neighbor_word(room, own, place), neighbor);
  return count == kSelfMostNeighbors ? count : count + 1u;
}

inline void self_sort(SelfSet set, SelfRoom room, uint own, uint count) {
  for (uint k = 1u; k < count; ++k) {
    uint moved = self_word(set, self_neighbor_word(room, own, k));
    uint place = k;
    while (place > 0u) {
      uint before = self_word(set, self_neighbor_word(room, own, place - 1u));
      if ((before & ~kSelfThinBit) < (moved & ~kSelfThinBit)) break;
      set_self_word(set, self_neighbor_word(room, own, place), before);
      place = place - 1u;
    }
    set_self_word(set, self_neighbor_word(room, own, place), moved);
  }
}

// Buckets are shared by cells.
inline bool self_is_in(SelfRoom room, vec3 p, SelfCell cell) {
  SelfCell of_point = self_cell(room, p);
  return of_point.x == cell.x && of_point.y == cell.y && of_point.z == cell.z;
}

// [m] What layers keep that are near at rest.
inline float self_rest_distance(SelfPoint a, SelfPoint b) {
  precise float rest = kSelfRestShare * length3(xyz(b.rest) - xyz(a.rest));
  return rest;
}

// Whether that is less than what two points keep else. Where others were when a cloth came later is not known.
inline bool self_is_thin(SelfSet set, SelfRoom room, SelfPoint a, SelfPoint b) {
  return a.inter_arrival == b.inter_arrival && self_rest_distance(a, b) < self_pair_distance(set, room, a, b);
}

// Adds the points of a layer in a cell that may touch this one to its list of `count`. Layers may share a bucket, too.
inline uint self_find_in(SelfSet set, SelfRoom room, uint point, uint count, vec3 at, SelfCell cell, uint layer) {
  SelfPoint own = self_point(set, point);
  precise float reach2 = room.reach * room.reach;
  uint found = count;
  uint other = self_word(set, self_head_word(room, self_hash(room, cell, layer)));
  while (other != kSelfNone) {
    vec3 there = self_seen(set, room, other);
    vec3 d = there - at;
    if (other != point && dot3(d, d) < reach2 && self_is_in(room, there, cell) && !self_pass(set, room, own, other)) {
      SelfPoint neighbor = self_point(set, other);
      float reach = self_pair_reach(set, room, own, neighbor);
      precise float pair2 = reach * reach;
      bool thin = self_is_thin(set, room, own, neighbor);
      bool of_layer = self_layer(set, neighbor) == layer;
      if (of_layer && dot3(d, d) < pair2)
        found = self_keep(set, room, point, found, at, thin ? other | kSelfThinBit : other);
    }
    other = self_word(set, self_next_word(room, other));
  }
  return found;
}

// Lists the points that may touch this one before neighbours are looked up again.
inline void self_find(SelfSet set, SelfRoom room, uint point) {
  SelfPoint own = self_point(set, point);
  vec3 at = self_seen(set, room, point);
  uint count = 0u;
  uint own_layer = self_layer(set, own), all = (1u << kInterLayers) - 1u;
  bool shared_layer = !between_cloths(set) || own_layer == kInterLayers - 1u;
  uint others = shared_layer ? all : all & ~(1u << own_layer);
  if (self_in_range(at)) {
    SelfCell middle = self_cell(room, at);
    for (uint k = 0u; k < 27u; ++k) {
      SelfCell cell;
      cell.x = middle.x + k % 3u - 1u;
      cell.y = middle.y + k / 3u % 3u - 1u;
      cell.z = middle.z + k / 9u - 1u;
      uint filled = self_word(set, self_filled_word(room, self_hash(room, cell, 0u)));
      uint layers = filled & others;
      if (filled / kSelfBucketPoint > room.most_in_bucket || layers == 0u) continue;
      for (uint layer = 0u; layer < kInterLayers; ++layer) {
        if ((layers >> layer & 1u) == 0u) continue;
        count = self_find_in(set, room, point, count, at, cell, layer);
      }
    }
    self_sort(set, room, point, count);
  }
  set_self_word(set, self_count_word(room, point), count);
}

struct SelfPush {
  vec3 shift;    // [m] of the position
  vec3 impulse;  // [m] of the displacement over the substep
};

inline SelfPush no_push() {
  SelfPush r;
  r.shift = vec3(0.0f, 0.0f, 0.0f);
  r.impulse = r.shift;
  return r;
}

// One neighbour's push. Points that went past each other within the substep are pushed back to the sides that they came
// from. As with colliders the push itself gives no speed; it takes what leads inwards, and friction brakes the rest.
inline SelfPush self_add(SelfPush sum, PointState own, PointState other, float share, float distance, float friction) {
  SelfPush r = sum;
  precise vec3 apart = own.position - other.position;
  precise vec3 way = ((own.position - own.previous) + own.carry) - ((other.position - other.previous) + other.carry);
  precise vec3 before = apart - way;
  vec4 now = unit_and_length(apart);
  vec4 then = unit_and_length(before);
  bool past = dot3(apart, before) < 0.0f && then.w > kSelfNoWay;
  vec3 n = past ? xyz(then) : xyz(now);
  precise float depth = distance - dot3(apart, n);
  if (depth > 0.0f && (past || now.w > kSelfNoWay)) {
    precise float along = dot3(way, n);
    precise vec3 sliding = way - n * along;
    precise float slid = length3(sliding);
    precise float brake = friction * depth;
    precise float held = slid > brake ? brake * (1.0f / slid) : 1.0f;
    precise vec3 braked = sliding * held;
    precise vec3 shift = sum.shift + (n * depth - braked) * share;
    precise vec3 impulse = sum.impulse + (n * min(depth, max(-along, 0.0f)) - braked) * share;
    r.shift = shift;
    r.impulse = impulse;
  }
  return r;
}

// What two points push each other by.
struct SelfPair {
  uint other;
  float share;     // of the push that the first one takes
  float distance;  // [m]
  float friction;
};

// @param own       the first one
// @param neighbor  an entry of its list
inline SelfPair self_pair(SelfSet set, SelfRoom room, SelfPoint own, uint neighbor) {
  SelfPair r;
  r.other = neighbor & ~kSelfThinBit;
  SelfPoint other = self_point(set, r.other);
  bool thin = (neighbor & kSelfThinBit) != 0u;
  r.distance = thin ? self_rest_distance(own, other) : self_pair_distance(set, room, own, other);
  float w = self_is_held(set, room, r.other) ? 0.0f : other.rest.w;
  precise float share = kSelfShare * own.rest.w * (1.0f / (own.rest.w + w));
  r.share = share;
  r.friction = self_pair_friction(set, room, own, other);
  return r;
}

// No more than a point can be pushed in a substep.
inline SelfPush self_limited(SelfRoom room, SelfPush sum) {
  SelfPush r = sum;
  precise float longest = kSelfLongestPush * room.distance;
  float way = length3(sum.shift);
  if (way > longest) {
    precise float kept = longest * (1.0f / way);
    r.shift = sum.shift * kept;
    r.impulse = sum.impulse * kept;
  }
  return r;
}

// What all neighbours do to a point; equal and opposite for both points of a pair, but for the limit to the whole.
inline SelfPush self_push(SelfSet set, SelfRoom room, uint point) {
  SelfPush sum = no_push();
  SelfPoint own = self_point(set, point);
  uint count = self_word(set, self_count_word(room, point));
  if (count == 0u || self_is_held(set, room, point)) return sum;
  PointState state = self_state(set, room, point);
  precise float distance2 = room.distance * room.distance;
  for (uint k = 0u; k < count; ++k) {
    uint neighbor = self_word(set, self_neighbor_word(room, point, k));
    vec3 apart = state.position - self_position(set, room, neighbor & ~kSelfThinBit);
    if (dot3(apart, apart) < distance2) {
      SelfPair pair = self_pair(set, room, own, neighbor);
      sum = self_add(sum, state, self_state(set, room, pair.other), pair.share, pair.distance, pair.friction);
    }
  }
  return self_limited(room, sum);
}

inline void set_self_push(SelfSet set, SelfRoom room, uint point, SelfPush push) {
  uint word = self_push_word(room, point);
  set_self_vector(set, word, push.shift);
  set_self_vector(set, word + 3u, push.impulse);
}

// Whether the point was pushed.
inline bool self_is_pushed(SelfSet set, SelfRoom room, uint point) {
  uint word = self_push_word(room, point);
  uint bits = 0u;
  for (uint k = 0u; k < kSelfPushWords; ++k) bits = bits | self_word(set, word + k);
  return (bits & 0x7FFFFFFFu) != 0u;
}

inline PointState self_pushed(SelfSet set, SelfRoom room, uint point, PointState state) {
  uint word = self_push_word(room, point);
  vec3 shift = self_vector(set, word);
  vec3 impulse = self_vector(set, word + 3u);
  precise vec3 kept = way_of(state) + impulse;
  precise vec3 position = state.position + shift;
  return moved_to(state, position, kept);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
