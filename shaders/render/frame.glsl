// SPDX-License-Identifier: Apache-2.0
// What every shader of a picture shares.
#ifndef GEOCLOTH_RENDER_FRAME_GLSL
#define GEOCLOTH_RENDER_FRAME_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "render/render_layout.h"

layout(set = 0, binding = 0, std140) uniform FrameBlock {
  FrameParams frame;
};

vec3 from_srgb(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

#endif
