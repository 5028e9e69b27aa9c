// SPDX-License-Identifier: Apache-2.0
// A span is what lies between a pixel and the one eight further on: its ends stay within its length. An attachment is
// slack where a collider lies between a point and its pin, and there the structural springs carry all of the weight; a
// spring over n pixels is n^2 times as stiff as they are for the same work, so one level of the pyramid of long springs
// (Mueller 2008, "Hierarchical Position Based Dynamics") takes most of it. It only pulls, so folds are free, and its
// ends are points of the cloth like all others, so that nothing is gained that was not there. Cloth without pins rests
// on colliders, which hold few of its points: the next level, spans half as long, evens out there what the first one
// leaves to few springs. Ties, at a frame's end, are spans of one pixel. Of springs in a row, all as much too long,
// those that are met first would get what the others lose; the last ones give back a part, so that all are left with
// about as much.
#ifndef GEOCLOTH_LIB_SPAN_H
#define GEOCLOTH_LIB_SPAN_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kSpanPixels = 8u;
const uint kShortSpanPixels = 4u;
// Of what is too long, that short spans take: with all of it points that start deep in a collider come out faster.
const float kShortSpanShare = 0.5f;
const float kTieShare = 0.7f;  // and that the last ties take
// Groups 0, 1 lead to the right from columns with floor(x / 8) even, odd; 2, 3 down, by rows; 4 to 7 are those of the
// short spans, by floor(x / 4).
const uint kSpanGroups = 4u;

inline uint pixels_of_span(uint group) {
  return group < kSpanGroups ? kSpanPixels : kShortSpanPixels;
}

inline float span_share(uint group) {
  return group < kSpanGroups ? 1.0f : kShortSpanShare;
}

// Component of the structural springs that a group's spans are made of.
inline uint span_component(uint group) {
  return group % kSpanGroups / 2u;
}

// A span of the group may start at (x, y).
inline bool span_starts(uint group, uint x, uint y) {
  return (span_component(group) == 0u ? x : y) / pixels_of_span(group) % 2u == group % 2u;
}

// Invocations (i, j) of a group over an image.
inline uvec2 span_extent(uint group, uint width, uint height) {
  bool right = span_component(group) == 0u;
  uint pixels = pixels_of_span(group);
  uint lines = pixels * (((right ? width : height) + 2u * pixels - 1u) / (2u * pixels));
  return uvec2(right ? lines : width, right ? height : lines);
}

// Pixel of invocation (i, j); it may lie outside the image.
inline uvec2 span_pixel(uint group, uint i, uint j) {
  bool right = span_component(group) == 0u;
  uint pixels = pixels_of_span(group);
  uint n = right ? i : j;
  uint line = 2u * pixels * (n / pixels) + n % pixels + pixels * (group % 2u);
  return uvec2(right ? line : i, right ? j : line);
}

// The end a moves by step * wa, the end b by -step * wb.
struct SpanMove {
  bool pulls;
  vec3 step;
};

// @param d       [m] from a to b
// @param wa, wb  inverse masses [1/kg]
// @param share   of what is too long
inline SpanMove span_move(vec3 d, float wa, float wb, float longest, float share) {
  precise float l = length3(d);
  precise float w = wa + wb;
  bool pulls = l > longest && w > 0.0f;
  precise float change = (l - longest) * (share * (1.0f / (pulls ? w : 1.0f)));
  precise vec3 step = d * (change * (1.0f / (pulls ? l : 1.0f)));
  SpanMove r;
  r.pulls = pulls;
  r.step = step;
  return r;
}

// Whole ties join points of the cloth with all their copies, which lie on each other and are moved together: a tie
// between copies is taken back by the stitch as far as the others weigh, and where that leaves a short spring too long,
// it is by much. Ends move by as much each, light or heavy, as nothing of it becomes speed: a chain of light points
// between heavy ones would leave all that it is too long to the spring that comes last.
inline float whole_tie_weight(float mass_inverse) {
  return mass_inverse > 0.0f ? 1.0f : 0.0f;
}

// A sewing thread joins points of two borders. At rest they are apart; what they may be apart, as a share of that,
// sinks to nothing while they are sewn, substep by substep, so that the threads draw them together as fast as that
// goes.
inline float sewing_share(float before, float after, float frame_fraction) {
  precise float share = before + (after - before) * frame_fraction;
  return share;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
