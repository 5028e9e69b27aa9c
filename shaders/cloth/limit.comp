// SPDX-License-Identifier: Apache-2.0
// Per pixel: the long-range attachment to a pinned pixel.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/limit.h"

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  vec4 position = imageLoad(position_image, texel(p));
  Attachment attachment = attachments[p.y * params.width + p.x];
  if (position.w == 0.0f || attachment.anchor == kNoAnchor) return;
  vec3 anchor = imageLoad(position_image, texel(pixel_at(attachment.anchor))).xyz;
  precise float longest = attachment.reach * params.stretch_limit;
  imageStore(position_image, texel(p), vec4(attach(position.xyz, anchor, longest), position.w));
}
