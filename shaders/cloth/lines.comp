// SPDX-License-Identifier: Apache-2.0
// Per row or column: its runs of structural springs, each as one system of equations.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "lines.glsl"

void main() {
  if (own_entry() < constants.count) line_at(own_entry());
}
