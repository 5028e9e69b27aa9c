// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
// Colliders and the ground: meshes that move as a whole.
#include "render/frame.glsl"

layout(push_constant) uniform DrawBlock {
  SolidDraw draw;
};

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;

layout(location = 0) out vec3 out_point;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_grid;

void main() {
  out_point = (draw.model * vec4(in_position, 1.0)).xyz;
  out_normal = mat3(draw.model) * in_normal;  // poses and even scales only
  out_grid = in_position.xz * draw.grid_scale;
  gl_Position = (draw.shadow_pass == 1u ? frame.light_projection : frame.view_projection) * vec4(out_point, 1.0);
}
