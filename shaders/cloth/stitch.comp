// SPDX-License-Identifier: Apache-2.0
// Per split row: the mass-weighted mean of the copies, written to every copy.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "stitch.glsl"

void main() {
  if (own_entry() < constants.count) stitch_at(own_entry());
}
