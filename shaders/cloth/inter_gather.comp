// SPDX-License-Identifier: Apache-2.0
// Per point of a cloth: to where all cloths that it collides with see it.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "self.glsl"

void main() {
  if (own_entry() >= constants.count) return;
  SelfSet set = SelfSet(0u);
  uint point = constants.first + own_entry();
  uint pixel = self_point(set, point).pixel;
  gather_state(set, inter_room(params), point, pixel_state(set, pixel), pixel_inverse_mass(set, pixel) == 0.0f);
}
