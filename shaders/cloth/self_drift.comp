// SPDX-License-Identifier: Apache-2.0
// Per point: how far points have gone since neighbours were looked up, as a box.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "self.glsl"

// Most points lie inside the box of those before: reading is cheaper than an atomic that changes nothing.
void widen(uint axis, uvec2 range) {
  if (range.x < self_words[kSelfLow + axis]) atomicMin(self_words[kSelfLow + axis], range.x);
  if (range.y > self_words[kSelfHigh + axis]) atomicMax(self_words[kSelfHigh + axis], range.y);
}

void main() {
  if (own_entry() >= constants.count) return;
  SelfDrift drift = self_drift(SelfSet(0u), self_room(params), own_entry());
  widen(0u, drift.x);
  widen(1u, drift.y);
  widen(2u, drift.z);
}
