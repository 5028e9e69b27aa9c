// SPDX-License-Identifier: Apache-2.0
// Per pin: one step towards its target; a held one reaches it with the last substep of the frame.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "../lib/pin.h"

void main() {
  uint i = own_entry();
  if (i >= constants.count) return;
  PinTarget pin = pins[i];
  uvec2 p = pixel_at(pin.pixel.x);
  vec4 position = imageLoad(position_image, texel(p));
  vec3 previous = imageLoad(previous_image, texel(p)).xyz;
  vec3 moved = pinned_position(pin, substeps[constants.substep].pin_fraction, substeps[constants.substep].frame_fraction,
                               substeps[constants.substep].substep_share, position.xyz, previous);
  imageStore(position_image, texel(p), vec4(moved, position.w));
}
