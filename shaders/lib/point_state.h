// SPDX-License-Identifier: Apache-2.0
// A point on its way through a substep, for the passes after the constraints.
#ifndef GEOCLOTH_LIB_POINT_STATE_H
#define GEOCLOTH_LIB_POINT_STATE_H

#include "../shared/types.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

struct PointState {
  vec3 position;
  vec3 previous;
  vec3 carry;  // see predict.h: the displacement is position - previous + carry
};

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
