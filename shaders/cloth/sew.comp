// SPDX-License-Identifier: Apache-2.0
// Per sewing thread of one colour: one projection.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "constraints.glsl"

void main() {
  if (own_entry() < constants.count) sew_at(constants.first + own_entry());
}
