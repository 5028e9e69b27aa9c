// SPDX-License-Identifier: Apache-2.0
// Per pixel: largest speed, then all colliders with friction.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "contacts.glsl"

void main() {
  uvec2 p = own_pixel();
  if (in_image(p)) collide_at(p);
}
