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
  uint bucket = self_bucket(room, self_cell(room, position));
  self_words[self_next_word(room, point)] = atomicExchange(self_words[self_head_word(room, bucket)], point);
  atomicAdd(self_words[self_filled_word(room, bucket)], kSelfBucketPoint);
  if (between_cloths(set)) atomicOr(self_words[self_filled_word(room, bucket)], inter_bit(self_point(set, point)));
}
