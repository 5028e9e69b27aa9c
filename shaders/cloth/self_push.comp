// SPDX-License-Identifier: Apache-2.0
// Per point: what its neighbours do to it. Once: ways are measured anew.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "self.glsl"

void main() {
  SelfSet set = SelfSet(0u);
  SelfRoom room = self_room(params);
  if (own_entry() == 0u) self_begin(set, room);
  if (own_entry() < constants.count) set_self_push(set, room, own_entry(), self_push(set, room, own_entry()));
}
