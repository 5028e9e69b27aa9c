// SPDX-License-Identifier: Apache-2.0
// Long-range attachment: a point stays within its distance along the surface to a pinned one. Kim, Chentanez,
// Mueller-Fischer 2012, "Long Range Attachments - A Method to Simulate Inextensible Clothing in Computer Games".
#ifndef GEOCLOTH_LIB_LIMIT_H
#define GEOCLOTH_LIB_LIMIT_H

#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

inline vec3 attach(vec3 position, vec3 anchor, float longest) {
  precise vec3 d = position - anchor;
  precise float l = length3(d);
  precise vec3 pulled = anchor + d * (longest * (1.0f / (l > longest ? l : 1.0f)));
  return l > longest ? pulled : position;
}

// Straight out of a ball; up from its middle.
inline vec3 out_of_ball(vec3 position, vec3 middle, float radius) {
  vec4 d = unit_and_length(position - middle);
  if (d.w >= radius) return position;
  return shifted(middle, d.w > 0.0f ? xyz(d) : vec3(0.0f, 1.0f, 0.0f), radius);
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
