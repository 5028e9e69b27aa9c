// SPDX-License-Identifier: Apache-2.0
#version 450

layout(set = 0, binding = 0) uniform sampler2D glyphs;  // coverage

layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;

layout(location = 0) out vec4 out_color;

void main() {
  out_color = vec4(in_color.rgb, in_color.a * texture(glyphs, in_uv).r);
}
