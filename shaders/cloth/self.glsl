// SPDX-License-Identifier: Apache-2.0
// Self-collision: the buffers as lib/self_collide.h wants them.
#include "point.glsl"

struct SelfSet {
  uint unused;
};

uint self_word(SelfSet set, uint i) {
  return self_words[i];
}

void set_self_word(SelfSet set, uint i, uint value) {
  self_words[i] = value;
}

SelfPoint self_point(SelfSet set, uint i) {
  return self_points[i];
}

vec3 self_position(SelfSet set, uint pixel) {
  return load_position(pixel_at(pixel)).xyz;
}

float self_inverse_mass(SelfSet set, uint pixel) {
  return load_position(pixel_at(pixel)).w;
}

PointState self_state(SelfSet set, uint pixel) {
  return load_state(pixel_at(pixel));
}

#include "../lib/self_collide.h"
