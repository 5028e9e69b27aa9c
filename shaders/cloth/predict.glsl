// SPDX-License-Identifier: Apache-2.0
// Prediction and pins.
#include "../lib/fine.h"
#include "../lib/pin.h"
#include "../lib/predict.h"
#include "../lib/yield.h"
#include "point.glsl"

// A cloth may lie in the lee: w is its share of the wind.
vec3 air_at(vec3 position) {
  precise vec3 air = params.wind.xyz;
  for (uint i = 0u; i < kWindWaves; ++i) air = air + gust_at(substeps[constants.substep].waves[i], position);
  return air * params.wind.w;
}

// What is pinned stays where it is; pin_at() moves it.
void predict_pinned(uvec2 p, vec4 position) {
  store_previous(p, position);
  if (fine_mode() == kFineOff) return;
  vec4 offset = imageLoad(offset_image, texel(p));
  store_carry(p, offset);
  imageStore(offset_image, texel(p), vec4(offset.xyz, 0.0f));
}

void predict_at(uvec2 p) {
  vec4 position = load_position(p);
  if (position.w == 0.0f) {
    predict_pinned(p, position);
    return;
  }
  PointState point = load_state(p);
  vec3 acceleration = vec3(0.0f);
  if (params.air != 0u) {
    precise vec3 velocity = way_of(point) * params.inverse_dt;
    vec4 normal = imageLoad(normal_image, texel(p));
    acceleration = air_acceleration(params, air_at(position.xyz), velocity, normal.xyz);
    if (params.pressure.x != 0.0f) {
      acceleration =
          acceleration + pressure_acceleration(params, normal.xyz, normal.w, inverse_mass_of(position.w));
    }
  }
  PointState next;
  if (params.moving != 0u) {
    next = predict_along(params, float(constants.substep), point, acceleration);
  } else {
    next = predict(params, point, acceleration);
  }
  if (fine_mode() != kFineOff) {
    store_previous(p, vec4(next.previous, position.w));
    vec3 low = imageLoad(offset_image, texel(p)).xyz;
    imageStore(offset_image, texel(p), vec4(predicted_offset(next, low), position.w));
    store_carry(p, vec4(low, 0.0f));
    return;
  }
  store_state(p, next, position.w);
}

// One step towards the target of pin i; a held one reaches it with the last substep of the frame.
void pin_at(uint i) {
  PinTarget pin = pins[i];
  uvec2 p = pixel_at(pin.pixel.x);
  vec4 position = load_point(p);
  vec3 previous = load_previous(p).xyz;
  if (fine_mode() != kFineOff) {
    pin = pin_from(pin, previous);
    previous = load_carry(p).xyz;
  }
  vec3 moved = pinned_position(pin, substeps[constants.substep].pin_fraction, substeps[constants.substep].frame_fraction,
                               substeps[constants.substep].substep_share, position.xyz, previous);
  store_point(p, moved, position.w);
}
