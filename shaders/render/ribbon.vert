// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
// A line between two pixels of the image, as wide on the screen as asked for: seams and borders.
#include "render/frame.glsl"
#include "render/cloth_images.glsl"

layout(push_constant) uniform DrawBlock {
  RibbonDraw draw;
};

layout(location = 0) in uvec2 in_pixel;  // per instance
layout(location = 1) in vec4 in_color;   // per instance

layout(location = 0) out vec3 out_color;

vec4 project(uint pixel) {
  vec3 point = fetch_position(pixel, draw.width) + draw.origin.xyz;
  // A little towards the eye, so that the line lies on the cloth from either side; dots lie on lines.
  point += normalize(frame.eye.xyz - point) * ((in_pixel.x == in_pixel.y ? 0.008 : 0.004) * frame.center.w);
  return frame.view_projection * vec4(point, 1.0);
}

void main() {
  const vec2 kCorner[6] = vec2[](vec2(0, -1), vec2(1, -1), vec2(1, 1), vec2(0, -1), vec2(1, 1), vec2(0, 1));
  vec2 corner = kCorner[gl_VertexIndex];
  vec4 a = project(in_pixel.x);
  vec4 b = project(in_pixel.y);
  vec2 along = (b.xy / b.w - a.xy / a.w) * frame.viewport.xy;
  float size = length(along);
  along = size > 1e-6 ? along / size : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  // Ends stand out by half the thickness, so that neighbours meet; a pixel by itself is a square.
  float ends = in_pixel.x == in_pixel.y ? 1.0 : 0.7;
  vec2 pixels = (across * corner.y + along * (corner.x * 2.0 - 1.0) * ends) * draw.thickness;
  vec4 end = corner.x < 0.5 ? a : b;
  gl_Position = end + vec4(pixels / frame.viewport.xy * end.w, 0.0, 0.0);
  out_color = from_srgb(in_color.rgb);
}
