// SPDX-License-Identifier: Apache-2.0
// A span is what lies between a pixel and the one eight further on: its ends stay within its length. An attachment is
// slack where a collider lies between a point and its pin, and there the structural springs carry all of the weight; a
// spring over n pixels is n^2 times as stiff as they are for the same work, so one level of the pyramid of long springs
// (Mueller 2008, "Hierarchical Position Based Dynamics") takes most of it. Spans start in even rows only, structural
// springs bring the rows between along: half the work for the same stretch. At a frame's end spans over a single pixel
// follow, which take what a few springs in sharp folds are too long by. Spans only pull, so folds are free, and their
// ends are points of the cloth like all others, so that nothing is gained that was not there.
#ifndef GEOCLOTH_LIB_SPAN_H
#define GEOCLOTH_LIB_SPAN_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kSpanPixels = 8u;
const uint kSpanGroups = 4u;  // 0, 1 to the right from columns with floor(x / 8) even, odd; 2, 3 down, by rows
const uint kTieGroups = 4u;   // 4 .. 7: the same over one pixel, the springs of the structural groups 0 .. 3

inline bool is_tie(uint group) {
  return group >= kSpanGroups;
}
inline uint span_pixels(uint group) {
  return is_tie(group) ? 1u : kSpanPixels;
}
// Every so many rows spans start.
inline uint span_rows(uint group) {
  return is_tie(group) ? 1u : 2u;
}

// Component of the structural springs that a group's spans are made of.
inline uint span_component(uint group) {
  return group % 4u / 2u;
}

// A span of the group may start at (x, y).
inline bool span_starts(uint group, uint x, uint y) {
  return y % span_rows(group) == 0u && (span_component(group) == 0u ? x : y) / span_pixels(group) % 2u == group % 2u;
}

// Invocations (i, j) of a group over an image.
inline uvec2 span_extent(uint group, uint width, uint height) {
  bool right = span_component(group) == 0u;
  uint pixels = span_pixels(group), rows = span_rows(group);
  uint lines = pixels * (((right ? width : height) + 2u * pixels - 1u) / (2u * pixels));
  return uvec2(right ? lines : width, ((right ? height : lines) + rows - 1u) / rows);
}

// Pixel of invocation (i, j); it may lie outside the image.
inline uvec2 span_pixel(uint group, uint i, uint j) {
  bool right = span_component(group) == 0u;
  uint pixels = span_pixels(group), y = j * span_rows(group);
  uint n = right ? i : y;
  uint line = 2u * pixels * (n / pixels) + n % pixels + pixels * (group % 2u);
  return uvec2(right ? line : i, right ? y : line);
}

// The end a moves by step * wa, the end b by -step * wb.
struct SpanMove {
  bool pulls;
  vec3 step;
};

// @param d       [m] from a to b
// @param wa, wb  inverse masses [1/kg]
inline SpanMove span_move(vec3 d, float wa, float wb, float longest) {
  precise float l = length3(d);
  precise float w = wa + wb;
  bool pulls = l > longest && w > 0.0f;
  precise float change = (l - longest) * (1.0f / (pulls ? w : 1.0f));
  precise vec3 step = d * (change * (1.0f / (pulls ? l : 1.0f)));
  SpanMove r;
  r.pulls = pulls;
  r.step = step;
  return r;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
