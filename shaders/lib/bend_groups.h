// SPDX-License-Identifier: Apache-2.0
// The 6 groups of bends over three pixels in a row. Two bends of one group share no pixel.
//
//   0, 1, 2   along a row: first columns x = 0, 1, 2 modulo 3          o--o--o  o--o--o
//   3, 4, 5   along a column: first rows y = 0, 1, 2 modulo 3          0  1  2  3  4  5
#ifndef GEOCLOTH_LIB_BEND_GROUPS_H
#define GEOCLOTH_LIB_BEND_GROUPS_H

#include "../shared/types.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kBendGroups = 6u;

// 4: along a row, 5: along a column, as the springs over two pixels.
inline uint bend_component(uint group) {
  return 4u + group / 3u;
}

// Invocations (x, y) of a group over an image.
inline uvec2 bend_extent(uint group, uint width, uint height) {
  return group < 3u ? uvec2((width + 2u) / 3u, height) : uvec2(width, (height + 2u) / 3u);
}

// First pixel of the bend of invocation (i, j); it may lie outside the image.
inline uvec2 bend_pixel(uint group, uint i, uint j) {
  return group < 3u ? uvec2(3u * i + group, j) : uvec2(i, 3u * j + (group - 3u));
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
