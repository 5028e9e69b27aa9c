// SPDX-License-Identifier: Apache-2.0
// The state of a cloth as the solver keeps it: one texel per pixel of its geometry image.
#ifndef GEOCLOTH_RENDER_CLOTH_IMAGES_GLSL
#define GEOCLOTH_RENDER_CLOTH_IMAGES_GLSL

layout(set = 1, binding = 0) uniform texture2D position_image;
layout(set = 1, binding = 1) uniform texture2D normal_image;
layout(set = 1, binding = 2) uniform texture2D rest_image;

ivec2 texel_of(uint pixel, uint width) {
  return ivec2(pixel % width, pixel / width);
}

vec3 fetch_position(uint pixel, uint width) {
  return texelFetch(position_image, texel_of(pixel, width), 0).xyz;
}

vec3 fetch_normal(uint pixel, uint width) {
  return texelFetch(normal_image, texel_of(pixel, width), 0).xyz;
}

#endif
