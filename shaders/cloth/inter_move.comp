// SPDX-License-Identifier: Apache-2.0
// Per pixel of a cloth with a point: takes the push of other cloths on it; all copies take the same.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "self.glsl"

void main() {
  if (own_entry() >= constants.count) return;
  SelfSet set = SelfSet(0u);
  SelfRoom room = inter_room(params);
  uint word = inter_pixel_word(room, constants.first + own_entry());
  uint pixel = self_word(set, word), point = self_word(set, word + 1u);
  if (!self_is_pushed(set, room, point)) return;
  uvec2 p = pixel_at(pixel);
  store_state(p, self_pushed(set, room, point, pixel_state(set, pixel)), load_position(p).w);
}
