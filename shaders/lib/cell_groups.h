// SPDX-License-Identifier: Apache-2.0
// The 4 groups of cells: cell (x, y) with its corners x + 1, y + 1 is in the group x % 2 + 2 (y % 2). Two cells of one
// group share no pixel.
#ifndef GEOCLOTH_LIB_CELL_GROUPS_H
#define GEOCLOTH_LIB_CELL_GROUPS_H

#include "../shared/types.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kCellGroups = 4u;

// Invocations (x, y) of a group over an image.
inline uvec2 cell_extent(uint width, uint height) {
  return uvec2((width + 1u) / 2u, (height + 1u) / 2u);
}

// First corner of the cell of invocation (i, j); the others may lie outside the image.
inline uvec2 cell_corner(uint group, uint i, uint j) {
  return uvec2(2u * i + group % 2u, 2u * j + group / 2u);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
