// SPDX-License-Identifier: Apache-2.0
// Area-weighted normals: a pixel sums the cross products of the triangles of its four cells.
//
//   corners of a cell   0 --- 1     diagonal right: (0,2,3) (0,3,1)
//                       |     |     diagonal left:  (0,2,1) (1,2,3)
//                       2 --- 3
#ifndef GEOCLOTH_LIB_NORMAL_H
#define GEOCLOTH_LIB_NORMAL_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kCellFirstBit = 1u;
const uint kCellSecondBit = 2u;
const uint kCellDiagonalLeftBit = 4u;

inline vec3 triangle_normal(vec3 a, vec3 b, vec3 c) {
  return cross3(b - a, c - a);
}

// Sum over the triangles of a cell that touch one of its corners; |sum| is twice their area.
inline vec3 corner_normal(uint cell, uint corner, vec3 p0, vec3 p1, vec3 p2, vec3 p3) {
  bool left = (cell & kCellDiagonalLeftBit) != 0u;
  bool in_first = corner == 0u || corner == 2u || corner == (left ? 1u : 3u);
  bool in_second = corner == 1u || corner == 3u || corner == (left ? 2u : 0u);
  precise vec3 sum = vec3(0.0f, 0.0f, 0.0f);
  if ((cell & kCellFirstBit) != 0u && in_first) {
    sum = sum + (left ? triangle_normal(p0, p2, p1) : triangle_normal(p0, p2, p3));
  }
  if ((cell & kCellSecondBit) != 0u && in_second) {
    sum = sum + (left ? triangle_normal(p1, p2, p3) : triangle_normal(p0, p3, p1));
  }
  return sum;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
