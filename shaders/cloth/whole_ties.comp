// SPDX-License-Identifier: Apache-2.0
// Per short spring at a seam of one colour: the whole points at its ends are pulled together where it is too long.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "constraints.glsl"

void main() {
  if (own_entry() < constants.count) whole_tie_at(constants.first + own_entry());
}
