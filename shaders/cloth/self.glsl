// SPDX-License-Identifier: Apache-2.0
// Self-collision, and collision between cloths: the buffers as lib/self_collide.h wants them.
#include "point.glsl"

// 1: the points are those of all cloths that collide with each other.
layout(constant_id = 2) const uint kBetweenCloths = 0u;

struct SelfSet {
  uint unused;
};

bool between_cloths(SelfSet set) {
  return kBetweenCloths != 0u;
}

uint self_word(SelfSet set, uint i) {
  return self_words[i];
}

void set_self_word(SelfSet set, uint i, uint value) {
  self_words[i] = value;
}

SelfPoint self_point(SelfSet set, uint i) {
  return self_points[i];
}

vec3 pixel_position(SelfSet set, uint pixel) {
  return load_position(pixel_at(pixel)).xyz;
}

float pixel_inverse_mass(SelfSet set, uint pixel) {
  return load_position(pixel_at(pixel)).w;
}

PointState pixel_state(SelfSet set, uint pixel) {
  return load_state(pixel_at(pixel));
}

#include "../lib/self_collide.h"
