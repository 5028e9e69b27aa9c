// SPDX-License-Identifier: Apache-2.0
// A key light with a shadow, a sky above and a warm ground below: enough to read folds.
#ifndef GEOCLOTH_RENDER_LIGHTING_GLSL
#define GEOCLOTH_RENDER_LIGHTING_GLSL

#include "render/frame.glsl"

layout(set = 0, binding = 1) uniform sampler2DShadow shadow_map;

const vec3 kKeyLight = vec3(1.0, 0.965, 0.91) * 2.0;
const vec3 kSky = vec3(0.62, 0.70, 0.82) * 0.72;
const vec3 kGround = vec3(0.50, 0.46, 0.42) * 0.55;

// Share of the key light that arrives, over a disc of the shadow map so that edges are soft.
float light_share(vec3 point, vec3 normal, float radius) {
  // The receiver is moved off its surface by about a texel, against the surface shadowing itself.
  vec4 place = frame.light_projection * vec4(point + normal * (1.6 * frame.to_light.w * (0.6 + radius * 0.4)), 1.0);
  vec3 at = vec3(place.xy * 0.5 + 0.5, min(place.z, 0.9999));  // what is behind the map is behind all in it
  if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
  vec2 texel = 1.0 / vec2(textureSize(shadow_map, 0));
  float sum = 0.0;
  const int kTaps = 20;
  for (int i = 0; i < kTaps; ++i) {  // Vogel's spiral
    float angle = 2.399963 * float(i);
    vec2 offset = vec2(cos(angle), sin(angle)) * sqrt((float(i) + 0.5) / float(kTaps)) * radius * 1.7;
    sum += texture(shadow_map, vec3(at.xy + offset * texel, at.z));
  }
  return sum / float(kTaps);
}

// @param wrap   how far light reaches round the terminator: cloth scatters
// @param sheen  strength of the fuzz that brightens grazing views
vec3 shade(vec3 albedo, vec3 point, vec3 normal, float shadow, float wrap, float sheen, float gloss) {
  vec3 view = normalize(frame.eye.xyz - point);
  float facing = dot(normal, frame.to_light.xyz);
  float diffuse = max(0.0, (facing + wrap) / (1.0 + wrap));
  vec3 ambient = mix(kGround, kSky, normal.y * 0.5 + 0.5);
  float grazing = pow(1.0 - max(0.0, dot(normal, view)), 4.0);
  vec3 halfway = normalize(view + frame.to_light.xyz);
  float highlight = gloss * pow(max(0.0, dot(normal, halfway)), 48.0) * step(0.0, facing);
  vec3 light = kKeyLight * diffuse * shadow + ambient;
  return albedo * light * 0.5 + (sheen * grazing * (0.3 + 0.7 * shadow) * (albedo * 0.5 + 0.5)) * 0.5 + highlight * shadow;
}

#endif
