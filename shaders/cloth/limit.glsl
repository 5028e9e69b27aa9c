// SPDX-License-Identifier: Apache-2.0
#include "../lib/limit.h"

void limit_at(uvec2 p) {
  vec4 position = load_position(p);
  Attachment attachment = attachments[p.y * params.width + p.x];
  if (position.w == 0.0f || attachment.anchor == kNoAnchor) return;
  vec3 anchor = load_anchor(pixel_at(attachment.anchor));
  precise float longest = attachment.reach * params.stretch_limit;
  store_position(p, vec4(attach(position.xyz, anchor, longest), position.w));
}
