// SPDX-License-Identifier: Apache-2.0
// Per pin: one step towards its target.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "predict.glsl"

void main() {
  if (own_entry() < constants.count) pin_at(own_entry());
}
