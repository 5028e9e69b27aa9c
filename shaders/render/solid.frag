// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
#include "render/lighting.glsl"
#include "render/background.glsl"

layout(push_constant) uniform DrawBlock {
  SolidDraw draw;
};

layout(location = 0) in vec3 in_point;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_grid;

layout(location = 0) out vec4 out_color;

float lines(vec2 at, float width) {
  vec2 per_pixel = fwidth(at);
  vec2 from_line = abs(fract(at - 0.5) - 0.5) / max(per_pixel, vec2(1e-6));
  vec2 line = (1.0 - smoothstep(vec2(width - 0.5), vec2(width + 0.5), from_line)) *
              (1.0 - smoothstep(vec2(0.15), vec2(0.45), per_pixel));
  return max(line.x, line.y);
}

void main() {
  vec3 view = frame.eye.xyz - in_point;
  vec3 normal = normalize(in_normal);
  if (dot(normal, view) < 0.0) normal = -normal;
  if (draw.ground == 0u) {
    float shadow = light_share(in_point, normal, 2.5);
    out_color = vec4(shade(draw.base_color.rgb, in_point, normal, shadow, 0.0, 0.10, 0.05), 1.0);
    return;
  }
  float shadow = light_share(in_point, normal, 7.0);
  float grid = max(0.30 * lines(in_grid / draw.grid_step, 0.5), 0.55 * lines(in_grid / (draw.grid_step * 10.0), 0.7));
  vec3 albedo = mix(draw.base_color.rgb, draw.base_color.rgb * 0.45, grid);
  vec3 lit = shade(albedo, in_point, normal, mix(1.0, shadow, 0.75), 0.0, 0.0, 0.0);
  // Towards the horizon, and near the end of the plane, the ground becomes the background.
  float far = length(in_point - frame.center.xyz) / frame.center.w;
  float opacity = 1.0 - smoothstep(2.2, 7.0, far);
  out_color = vec4(mix(background(1.0 - gl_FragCoord.y / frame.viewport.y), lit, opacity), 1.0);
}
