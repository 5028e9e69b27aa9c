// SPDX-License-Identifier: Apache-2.0
// Per pixel: Verlet prediction. Pinned pixels stay; pins.comp moves them.
#version 450
#extension GL_GOOGLE_include_directive : require
#include "over_pixels.glsl"
#include "../lib/fine.h"
#include "../lib/predict.h"

vec3 air_at(vec3 position) {
  precise vec3 air = params.wind.xyz;
  for (uint i = 0u; i < kWindWaves; ++i) air = air + gust_at(substeps[constants.substep].waves[i], position);
  return air;
}

void main() {
  uvec2 p = own_pixel();
  if (!in_image(p)) return;
  vec4 position = imageLoad(position_image, texel(p));
  if (position.w == 0.0f) {
    imageStore(previous_image, texel(p), position);
    if (params.fine != kFineOff) {
      vec4 offset = imageLoad(offset_image, texel(p));
      imageStore(carry_image, texel(p), offset);
      imageStore(offset_image, texel(p), vec4(offset.xyz, 0.0f));
    }
    return;
  }
  vec3 previous = imageLoad(previous_image, texel(p)).xyz;
  vec3 carry = imageLoad(carry_image, texel(p)).xyz;
  vec3 acceleration = vec3(0.0f);
  if (params.air != 0u) {
    precise vec3 velocity = ((position.xyz - previous) + carry) * params.inverse_dt;
    vec3 normal = imageLoad(normal_image, texel(p)).xyz;
    acceleration = air_acceleration(params, air_at(position.xyz), velocity, normal);
  }
  Predicted next;
  if (params.moving != 0u) {
    next = predict_along(params, float(constants.substep), position.xyz, previous, carry, acceleration);
  } else {
    next = predict(params, position.xyz, previous, carry, acceleration);
  }
  imageStore(previous_image, texel(p), vec4(next.previous, position.w));
  if (params.fine != kFineOff) {
    vec3 low = imageLoad(offset_image, texel(p)).xyz;
    imageStore(offset_image, texel(p), vec4(predicted_offset(next, low), position.w));
    imageStore(carry_image, texel(p), vec4(low, 0.0f));
    return;
  }
  imageStore(position_image, texel(p), vec4(next.position, position.w));
  imageStore(carry_image, texel(p), vec4(next.carry, 0.0f));
}
