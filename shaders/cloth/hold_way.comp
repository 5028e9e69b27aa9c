// SPDX-License-Identifier: Apache-2.0
// Per pixel: at a frame's end, its way is put aside; see lib/finish.h.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "contacts.glsl"

void main() {
  uvec2 p = own_pixel();
  if (in_image(p)) hold_way_at(p);
}
