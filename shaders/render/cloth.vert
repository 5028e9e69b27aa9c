// SPDX-License-Identifier: Apache-2.0
#version 450
#extension GL_GOOGLE_include_directive : require
// Every vertex finds itself on the geometry image (Binding of cloth_asset.h): three pixels, their weights, and an offset
// in the local frame. Nothing is read back and no mesh is updated: the images that the solver writes are the mesh.
#include "render/frame.glsl"
#include "render/cloth_images.glsl"

layout(push_constant) uniform DrawBlock {
  ClothDraw draw;
};

layout(location = 0) in uvec3 in_pixel;
layout(location = 1) in vec3 in_weight;
layout(location = 2) in vec3 in_offset;
layout(location = 3) in vec3 in_normal;  // in the frame of the binding
layout(location = 4) in vec2 in_uv;
layout(location = 5) in vec2 in_grid;  // [pixels] place in the image
layout(location = 6) in vec4 in_color;

layout(location = 0) out vec3 out_point;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec2 out_uv;
layout(location = 3) out vec2 out_grid;
layout(location = 4) out vec3 out_color;
layout(location = 5) out float out_strain;

vec3 unit_or(vec3 v, vec3 otherwise) {
  float squared = dot(v, v);
  return squared > 1e-24 ? v * inversesqrt(squared) : otherwise;
}

float spring_strain(uint other, vec3 here, vec3 rest_here) {
  float rest = distance(texelFetch(rest_image, texel_of(other, draw.width), 0).xyz, rest_here) * draw.scale;
  float now = distance(fetch_position(other, draw.width), here);
  return rest > 0.0 ? now / rest - 1.0 : 0.0;
}

// The larger of the strains along weft and warp, each the mean of the springs on both sides: where cloth is pulled in one
// direction and gives in the other, it is the pull that one wants to see.
float largest_strain(uint pixel, vec3 here) {
  vec4 rest = texelFetch(rest_image, texel_of(pixel, draw.width), 0);
  uint springs = uint(rest.w);
  vec2 sum = vec2(0.0), count = vec2(0.0);
  if ((springs & kRestRight) != 0u) { sum.x += spring_strain(pixel + 1u, here, rest.xyz); count.x += 1.0; }
  if ((springs & kRestLeft) != 0u) { sum.x += spring_strain(pixel - 1u, here, rest.xyz); count.x += 1.0; }
  if ((springs & kRestDown) != 0u) { sum.y += spring_strain(pixel + draw.width, here, rest.xyz); count.y += 1.0; }
  if ((springs & kRestUp) != 0u) { sum.y += spring_strain(pixel - draw.width, here, rest.xyz); count.y += 1.0; }
  vec2 strain = sum / max(count, vec2(1.0));
  if (count.x == 0.0) return strain.y;
  if (count.y == 0.0) return strain.x;
  return max(strain.x, strain.y);
}

void main() {
  vec3 p0 = fetch_position(in_pixel.x, draw.width);
  vec3 p1 = fetch_position(in_pixel.y, draw.width);
  vec3 p2 = fetch_position(in_pixel.z, draw.width);
  vec3 n0 = fetch_normal(in_pixel.x, draw.width);
  vec3 n1 = fetch_normal(in_pixel.y, draw.width);
  vec3 n2 = fetch_normal(in_pixel.z, draw.width);

  vec3 n = unit_or(in_weight.x * n0 + in_weight.y * n1 + in_weight.z * n2, n0);
  vec3 edge = p1 - p0;
  vec3 t = unit_or(edge - n * dot(edge, n), vec3(0.0));
  vec3 b = cross(n, t);
  vec3 offset = in_offset * draw.scale;

  out_point = in_weight.x * p0 + in_weight.y * p1 + in_weight.z * p2 + offset.x * t + offset.y * b + offset.z * n +
              draw.origin.xyz;
  out_normal = in_normal.x * t + in_normal.y * b + in_normal.z * n;
  out_uv = in_uv;
  out_grid = in_grid;
  out_color = from_srgb(in_color.rgb);
  out_strain = draw.mode == kDrawStrain ? largest_strain(in_pixel.x, p0) : 0.0;
  gl_Position = (draw.shadow_pass == 1u ? frame.light_projection : frame.view_projection) * vec4(out_point, 1.0);
}
