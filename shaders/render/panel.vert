// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
// Widgets over a picture: flat triangles in pixels.
#include "render/render_layout.h"

layout(push_constant) uniform DrawBlock {
  PanelDraw draw;
};

layout(location = 0) in vec2 in_place;
layout(location = 1) in vec2 in_uv;
layout(location = 2) in vec4 in_color;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out vec4 out_color;

vec3 from_srgb(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

void main() {
  gl_Position = vec4((in_place - draw.corner_size.xy) / draw.corner_size.zw * 2.0 - 1.0, 0.0, 1.0);
  out_uv = in_uv;
  out_color = vec4(from_srgb(in_color.rgb), in_color.a);
}
