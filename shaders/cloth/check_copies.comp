// SPDX-License-Identifier: Apache-2.0
// Per split row: largest distance of a copy to the first one.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "stitch.glsl"

void main() {
  if (own_entry() < constants.count) check_copies_at(own_entry());
}
