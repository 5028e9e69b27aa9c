// SPDX-License-Identifier: Apache-2.0
// Per pixel: the area-weighted normal of its own cells, made a unit; its length goes to w for normals_stitch.comp.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "normals.glsl"

void main() {
  uvec2 p = own_pixel();
  if (in_image(p)) normal_at(p);
}
