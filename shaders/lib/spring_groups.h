// SPDX-License-Identifier: Apache-2.0
// The 12 groups of springs. Two springs of one group share no pixel, so a group is projected in any order, in parallel.
//
//   0, 1   right       columns x even, odd          4, 5   down-right  rows y even, odd
//   2, 3   down        rows y even, odd             6, 7   down-left   rows y even, odd
//   8, 9   right two   columns with floor(x/2) even, odd
//   10, 11 down two    rows with floor(y/2) even, odd
//
//   o==o  o==o      a right spring of an even column shares no end with the next even one;
//    0 1   2 3      over two pixels, columns 0 and 1 go to 2 and 3, columns 4 and 5 to 6 and 7
#ifndef GEOCLOTH_LIB_SPRING_GROUPS_H
#define GEOCLOTH_LIB_SPRING_GROUPS_H

#include "../shared/types.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// Component of a group's springs, 0..5 in the order of SpringBit; component / 2 is the family.
inline uint group_component(uint group) {
  return group / 2u;
}

// 1: the group is a set of columns, 0: a set of rows.
inline uint group_by_column(uint group) {
  return group < 2u || group == 8u || group == 9u ? 1u : 0u;
}

// The n-th line (column or row) of a group.
inline uint group_line(uint group, uint n) {
  uint odd = group % 2u;
  return group < 8u ? 2u * n + odd : 4u * (n / 2u) + n % 2u + 2u * odd;
}

// How many n to try so that every line below `size` is met; some lines may lie beyond it.
inline uint group_line_count(uint group, uint size) {
  return group < 8u ? (size + 1u) / 2u : 2u * ((size + 3u) / 4u);
}

// Invocations (x, y) of a group over an image.
inline uvec2 group_extent(uint group, uint width, uint height) {
  bool by_column = group_by_column(group) == 1u;
  return uvec2(by_column ? group_line_count(group, width) : width,
               by_column ? height : group_line_count(group, height));
}

// Pixel of invocation (i, j); it may lie outside the image.
inline uvec2 group_pixel(uint group, uint i, uint j) {
  bool by_column = group_by_column(group) == 1u;
  return uvec2(by_column ? group_line(group, i) : i, by_column ? j : group_line(group, j));
}

// The other end of component c's spring from pixel (x, y); only meaningful where the spring exists.
inline uvec2 spring_end(uint component, uint x, uint y) {
  uint dx = component == 4u ? 2u : (component == 0u || component == 2u ? 1u : 0u);
  uint left = component == 3u ? 1u : 0u;
  uint dy = component == 5u ? 2u : (component == 1u || component == 2u || component == 3u ? 1u : 0u);
  return uvec2(x + dx - left, y + dy);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
