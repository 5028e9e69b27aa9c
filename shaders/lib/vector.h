// SPDX-License-Identifier: Apache-2.0
// Vector algebra with a fixed order of operations: GLSL's own dot, length and sin may differ between drivers.
#ifndef GEOCLOTH_LIB_VECTOR_H
#define GEOCLOTH_LIB_VECTOR_H

#include "../shared/types.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

inline float dot3(vec3 a, vec3 b) {
  precise float r = a.x * b.x + a.y * b.y + a.z * b.z;
  return r;
}

inline vec3 cross3(vec3 a, vec3 b) {
  precise vec3 r = vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  return r;
}

inline float length3(vec3 a) {
  precise float r = sqrt(dot3(a, a));
  return r;
}

inline vec3 xyz(vec4 a) {
  return vec3(a.x, a.y, a.z);
}

// a / |a| and |a|; zero for a vector too short to have a direction.
inline vec4 unit_and_length(vec3 a) {
  precise float l = length3(a);
  precise float inverse = l > 1e-30f ? 1.0f / l : 0.0f;
  precise vec3 u = a * inverse;
  return vec4(u, l > 1e-30f ? l : 0.0f);
}

// a + (b - a) * t, and exactly b for t = 1.
inline vec3 mix3(vec3 a, vec3 b, float t) {
  precise vec3 r = a * (1.0f - t) + b * t;
  return r;
}

// p + step * s
inline vec3 shifted(vec3 p, vec3 step, float s) {
  precise vec3 r = p + step * s;
  return r;
}

// sin(2 pi t): folded to a quarter turn, then the series to the ninth power (error below 4e-6).
inline float sine_of_turns(float t) {
  precise float r = t - floor(t + 0.5f);
  r = r > 0.25f ? 0.5f - r : r;
  r = r < -0.25f ? -0.5f - r : r;
  precise float x = r * 6.28318531f;
  precise float x2 = x * x;
  precise float s =
      x * (1.0f + x2 * (-1.66666667e-1f + x2 * (8.33333333e-3f + x2 * (-1.98412698e-4f + x2 * 2.75573192e-6f))));
  return s;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
