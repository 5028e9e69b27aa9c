// SPDX-License-Identifier: Apache-2.0
// Shape of the work groups, for the shaders and for whoever dispatches them.
#ifndef GEOCLOTH_SHARED_WORKGROUP_H
#define GEOCLOTH_SHARED_WORKGROUP_H

#include "types.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

const uint kGroupSide = 8u;   // passes over pixels: squares of this side
const uint kGroupLine = 64u;  // passes over a list: lines of this length,
const uint kListRow =
    65536u;  // with entry y * kListRow + x at (x, y), because a dispatch has at most 65535 groups a side

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
