// SPDX-License-Identifier: Apache-2.0
#ifndef GEOCLOTH_RENDER_BACKGROUND_GLSL
#define GEOCLOTH_RENDER_BACKGROUND_GLSL

// @param height  0 at the lower edge of the picture, 1 at the upper one
vec3 background(float height) {
  return mix(vec3(0.47, 0.48, 0.50), vec3(0.70, 0.735, 0.78), smoothstep(0.0, 1.0, height));
}

#endif
