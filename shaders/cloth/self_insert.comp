// SPDX-License-Identifier: Apache-2.0
// Per point: into its bucket, in any order.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "self.glsl"

void main() {
  SelfSet set = SelfSet(0u);
  SelfRoom room = self_room(params);
  uint point = own_entry();
  if (point >= constants.count || !self_is_stale(set, room)) return;
  vec3 position = self_position(set, room, point);
  set_self_vector(set, self_seen_word(room, point), position);
  if (!self_in_range(position)) return;
  SelfCell cell = self_cell(room, position);
  uint layer = self_layer(set, self_point(set, point)), bucket = self_hash(room, cell, layer);
  self_words[self_next_word(room, point)] = atomicExchange(self_words[self_head_word(room, bucket)], point);
  uint filled = self_filled_word(room, self_hash(room, cell, 0u));
  atomicAdd(self_words[filled], kSelfBucketPoint);
  atomicOr(self_words[filled], 1u << layer);
}
