// SPDX-License-Identifier: Apache-2.0
// Per point: lists its neighbours.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "self.glsl"

void main() {
  SelfSet set = SelfSet(0u);
  SelfRoom room = self_room(params);
  if (own_entry() < constants.count && self_is_stale(set, room)) self_find(set, room, own_entry());
}
