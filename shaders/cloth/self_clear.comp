// SPDX-License-Identifier: Apache-2.0
// Per bucket of the hash: emptied.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "self.glsl"

void main() {
  SelfSet set = SelfSet(0u);
  SelfRoom room = self_room(params);
  if (own_entry() >= constants.count || !self_is_stale(set, room)) return;
  self_words[self_head_word(room, own_entry())] = kSelfNone;
  self_words[self_filled_word(room, own_entry())] = 0u;
}
