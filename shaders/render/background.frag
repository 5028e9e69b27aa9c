// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
#include "render/frame.glsl"
#include "render/background.glsl"

layout(location = 0) out vec4 out_color;

void main() {
  out_color = vec4(background(1.0 - gl_FragCoord.y / frame.viewport.y), 1.0);
}
