// SPDX-License-Identifier: Apache-2.0
// Per pin: one step towards its target, which is reached with the last substep of the frame.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "../lib/vector.h"

void main() {
  uint i = own_entry();
  if (i >= constants.count) return;
  PinTarget pin = pins[i];
  uvec2 p = pixel_at(pin.pixel.x);
  vec4 position = imageLoad(position_image, texel(p));
  vec3 moved = mix3(position.xyz, pin.target.xyz, substeps[constants.substep].pin_fraction);
  imageStore(position_image, texel(p), vec4(moved, position.w));
}
