// SPDX-License-Identifier: Apache-2.0
// Per pin: one step towards its target; a held one reaches it with the last substep of the frame.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_list.glsl"
#include "../lib/fine.h"
#include "../lib/pin.h"

void main() {
  uint i = own_entry();
  if (i >= constants.count) return;
  PinTarget pin = pins[i];
  uvec2 p = pixel_at(pin.pixel.x);
  vec4 position = load_point(p);
  vec3 previous = imageLoad(previous_image, texel(p)).xyz;
  if (params.fine != kFineOff) {
    pin = pin_from(pin, previous);
    previous = imageLoad(carry_image, texel(p)).xyz;
  }
  vec3 moved = pinned_position(pin, substeps[constants.substep].pin_fraction, substeps[constants.substep].frame_fraction,
                               substeps[constants.substep].substep_share, position.xyz, previous);
  store_point(p, moved, position.w);
}
