// SPDX-License-Identifier: Apache-2.0
// Per pixel: the way that was put aside, and out of colliders.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "contacts.glsl"

void main() {
  uvec2 p = own_pixel();
  if (in_image(p)) give_way_at(p);
}
