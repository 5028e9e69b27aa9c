// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
// Cloth has two sides: the outer one (where the normals point) in its colour, the inner one darker and greyer, so that
// a look into a sleeve reads as one.
#include "render/lighting.glsl"

layout(push_constant) uniform DrawBlock {
  ClothDraw draw;
};
layout(set = 1, binding = 3) uniform sampler2D heat_scale;
layout(set = 2, binding = 0) uniform sampler2D base_texture;

layout(location = 0) in vec3 in_point;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec2 in_grid;
layout(location = 4) in vec3 in_color;
layout(location = 5) in float in_strain;

layout(location = 0) out vec4 out_color;

// 1 on lines where a coordinate is whole; where lines would be closer than about three pixels, their mean.
float grid_lines(vec2 at) {
  vec2 per_pixel = fwidth(at);
  vec2 from_line = abs(fract(at - 0.5) - 0.5) / max(per_pixel, vec2(1e-6));
  vec2 line = mix(1.0 - smoothstep(vec2(0.2), vec2(1.2), from_line), vec2(0.4), smoothstep(vec2(0.18), vec2(0.5), per_pixel));
  return max(line.x, line.y);
}

vec4 surface_color() {
  if (draw.mode == kDrawColor) return vec4(in_color, 1.0);
  if (draw.mode == kDrawStrain) return texture(heat_scale, vec2(in_strain / draw.strain_range * 0.5 + 0.5, 0.5));
  if (draw.mode == kDrawGrid) return vec4(mix(draw.base_color.rgb, vec3(0.012, 0.014, 0.02), 0.85 * grid_lines(in_grid)), 1.0);
  return draw.base_color * texture(base_texture, in_uv);
}

void main() {
  vec4 surface = surface_color();
  if (surface.a < draw.alpha_cutoff) discard;
  if (draw.alpha_cutoff != 0.0) surface.a = 1.0;

  vec3 view = frame.eye.xyz - in_point;
  vec3 facet = normalize(cross(dFdx(in_point), dFdy(in_point)));
  if (dot(facet, view) < 0.0) facet = -facet;
  vec3 normal = normalize(in_normal);
  bool inner = dot(normal, facet) < 0.0;
  if (inner) normal = -normal;

  vec3 albedo = surface.rgb;
  if (inner) albedo = mix(albedo, vec3(dot(albedo, vec3(0.2126, 0.7152, 0.0722))), 0.30) * vec3(0.62, 0.63, 0.68);
  float shadow = light_share(in_point, facet, 2.0);
  out_color = vec4(shade(albedo, in_point, normal, shadow, 0.12, inner ? 0.05 : 0.16, 0.0), surface.a);
}
