// SPDX-License-Identifier: Apache-2.0
// Per pixel: takes the push on its point; all copies take the same.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "self.glsl"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  SelfSet set = SelfSet(0u);
  SelfRoom room = self_room(params);
  uint pixel = p.y * params.width + p.x;
  uint point = self_words[self_point_word(pixel)];
  if (point == kSelfNone || !self_is_pushed(set, room, point)) return;
  store_state(p, self_pushed(set, room, point, pixel_state(set, pixel)), load_position(p).w);
}
