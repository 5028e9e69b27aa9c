// SPDX-License-Identifier: Apache-2.0
// Where the numbers of self-collision, and of the collision between cloths, lie in their buffer of words (floats as
// their bits). "Point" is one of ClothParams::self_points: a valid pixel, of copies the first; of several cloths those
// of one after those of another.
#ifndef GEOCLOTH_LIB_SELF_WORDS_H
#define GEOCLOTH_LIB_SELF_WORDS_H

#include "../shared/layout.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// Lowest x, y, z and highest x, y, z of how far points went since the neighbours were looked up; see ordered_bits().
const uint kSelfLow = 0u;
const uint kSelfHigh = 3u;
const uint kSelfAge = 6u;  // substeps since they were looked up, up to kSelfLeastAge; 0: never
const uint kSelfHeader = 8u;

const uint kSelfLeastAge = 2u;  // they are not looked up again before

const uint kSelfNone = 0xFFFFFFFFu;     // end of a list, no point
const uint kSelfMostNeighbors = 32u;    // the nearest ones are kept
const uint kSelfMostInBucket = 64u;     // a fuller one is left out: cloth that was crushed to a point; see SelfRoom
const uint kSelfBucketPoint = 256u;     // one in the number of points in a cell; below it bits for their layers
const uint kSelfThinBit = 0x80000000u;  // of a neighbour: at rest it is nearer than the distance
const uint kSelfPushWords = 6u;         // shift and change of the displacement
const uint kSelfWordsOfPoint = 1u + 3u + 1u + kSelfMostNeighbors + kSelfPushWords;
const uint kInterStateWords = 7u;  // position, way over the last substep, whether a pin holds it
const uint kInterPixelWords = 2u;  // pixel of its cloth, point

// What of ClothParams the functions need.
struct SelfRoom {
  uint points;
  uint buckets;  // a power of two
  uint first;    // word of the first bucket
  float distance;
  float reach;
  float friction;
  uint most_in_bucket;
};
inline SelfRoom self_room(ClothParams params) {
  SelfRoom r;
  r.points = params.self_points;
  r.buckets = params.self_buckets;
  r.first = kSelfHeader + params.width * params.height;
  r.distance = params.self_distance;
  r.reach = params.self_reach;
  r.friction = params.friction;
  r.most_in_bucket = params.self_most_in_bucket;
  return r;
}

// The same of the cloths that meet, as far as one of them needs it: the sizes.
inline SelfRoom inter_room(ClothParams params) {
  SelfRoom r;
  r.points = params.inter_points;
  r.buckets = params.inter_buckets;
  r.first = kSelfHeader;
  r.distance = 0.0f;
  r.reach = 0.0f;
  r.friction = 0.0f;
  r.most_in_bucket = 0u;
  return r;
}

// Section: point of each pixel, kSelfNone where there is none; not of several cloths.
inline uint self_point_word(uint pixel) {
  return kSelfHeader + pixel;
}
// Sections: first point in each bucket, number of points in each cell with bits for their layers.
inline uint self_head_word(SelfRoom room, uint bucket) {
  return room.first + bucket;
}
inline uint self_filled_word(SelfRoom room, uint bucket) {
  return room.first + room.buckets + bucket;
}
inline uint self_points_word(SelfRoom room) {
  return room.first + 2u * room.buckets;
}
// Sections: next point in the bucket, where the point was when the neighbours were looked up (3 words), number of
// neighbours, neighbours, push.
inline uint self_next_word(SelfRoom room, uint point) {
  return self_points_word(room) + point;
}
inline uint self_seen_word(SelfRoom room, uint point) {
  return self_points_word(room) + room.points + 3u * point;
}
inline uint self_count_word(SelfRoom room, uint point) {
  return self_points_word(room) + 4u * room.points + point;
}
inline uint self_neighbor_word(SelfRoom room, uint point, uint k) {
  return self_points_word(room) + 5u * room.points + kSelfMostNeighbors * point + k;
}
inline uint self_push_word(SelfRoom room, uint point) {
  return self_points_word(room) + (5u + kSelfMostNeighbors) * room.points + kSelfPushWords * point;
}
// Section: points near along the surface, which never push; SelfPoint has the range of each point.
inline uint self_skip_word(SelfRoom room) {
  return self_points_word(room) + kSelfWordsOfPoint * room.points;
}
// Of several cloths instead, sections: points as they were gathered; pixels with their points, cloth by cloth.
inline uint inter_state_word(SelfRoom room, uint point) {
  return self_skip_word(room) + kInterStateWords * point;
}
inline uint inter_pixel_word(SelfRoom room, uint entry) {
  return inter_state_word(room, room.points) + kInterPixelWords * entry;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
