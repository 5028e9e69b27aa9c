// SPDX-License-Identifier: Apache-2.0
// Per split row: the copies' normals summed by area, made a unit and written to every copy.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "normals.glsl"

void main() {
  if (own_entry() < constants.count) stitch_normals(own_entry());
}
