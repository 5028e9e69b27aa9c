// SPDX-License-Identifier: Apache-2.0
// The bindings of shared/layout.h, for every pass, and access to the state of one cloth.
#extension GL_GOOGLE_include_directive : require

#include "../shared/layout.h"
#include "../shared/workgroup.h"

layout(set = 0, binding = kBindingParams, std140) uniform ParamsBlock { ClothParams params; };
layout(set = 0, binding = kBindingPosition, rgba32f) uniform image2D position_image;
layout(set = 0, binding = kBindingPrevious, rgba32f) uniform image2D previous_image;
layout(set = 0, binding = kBindingCarry, rgba32f) uniform image2D carry_image;
#ifndef GEOCLOTH_SHARED_NORMALS
#define GEOCLOTH_SHARED_NORMALS
#endif
layout(set = 0, binding = kBindingNormal, rgba32f) uniform GEOCLOTH_SHARED_NORMALS image2D normal_image;
layout(set = 0, binding = kBindingSpringsStructural, rgba32f) uniform readonly image2D structural_image;
layout(set = 0, binding = kBindingSpringsShear, rgba32f) uniform readonly image2D shear_image;
layout(set = 0, binding = kBindingSpringsBending, rgba32f) uniform readonly image2D bending_image;
layout(set = 0, binding = kBindingCell, r32ui) uniform readonly uimage2D cell_image;
layout(set = 0, binding = kBindingOffset, rgba32f) uniform image2D offset_image;
layout(set = 0, binding = kBindingMultipliers, std430) buffer MultiplierBlock { float multipliers[]; };
layout(set = 0, binding = kBindingAttachments, std430) readonly buffer AttachmentBlock { Attachment attachments[]; };
layout(set = 0, binding = kBindingSeamSprings, std430) readonly buffer SeamSpringBlock { SeamSpring seam_springs[]; };
layout(set = 0, binding = kBindingSplitOffset, std430) readonly buffer SplitOffsetBlock { uint split_offset[]; };
layout(set = 0, binding = kBindingSplitPixel, std430) readonly buffer SplitPixelBlock { uint split_pixel[]; };
layout(set = 0, binding = kBindingPins, std430) readonly buffer PinBlock { PinTarget pins[]; };
layout(set = 0, binding = kBindingColliderShapes, std430) readonly buffer ShapeBlock { ColliderShape shapes[]; };
layout(set = 0, binding = kBindingColliderPoses, std430) readonly buffer PoseBlock { ColliderPose poses[]; };
layout(set = 0, binding = kBindingSubsteps, std430) readonly buffer SubstepBlock { Substep substeps[]; };
layout(set = 0, binding = kBindingMeasures, std430) buffer MeasureBlock { uint measures[kMeasureCount]; };
layout(set = 0, binding = kBindingInverseMass, std430) readonly buffer InverseMassBlock { float inverse_mass[]; };
layout(set = 0, binding = kBindingColliderNumbers, std430) readonly buffer NumberBlock { float collider_numbers[]; };
layout(set = 0, binding = kBindingSelfPoints, std430) readonly buffer SelfPointBlock { SelfPoint self_points[]; };
layout(set = 0, binding = kBindingSelfWords, std430) buffer SelfWordBlock { uint self_words[]; };
layout(set = 0, binding = kBindingContacts, std430) buffer ContactBlock { uint contact_words[]; };

bool in_image(uvec2 pixel) {
  return pixel.x < params.width && pixel.y < params.height;
}

ivec2 texel(uvec2 pixel) {
  return ivec2(pixel);
}

uvec2 pixel_at(uint index) {
  return uvec2(index % params.width, index / params.width);
}

#ifndef GEOCLOTH_TILE  // passes one by one, over the images
layout(push_constant, std430) uniform ConstantsBlock { PassConstants constants; };

// The pixel of this invocation; it may lie outside the image.
uvec2 own_pixel() {
  return gl_GlobalInvocationID.xy;
}

// The list entry of this invocation; it may lie beyond constants.count.
uint own_entry() {
  return gl_GlobalInvocationID.y * kListRow + gl_GlobalInvocationID.x;
}

// Points are in the images.
bool is_here(uvec2 pixel) {
  return true;
}
// 0: params.fine is kFineOff in every frame, and what it would need is left out.
layout(constant_id = 1) const uint kMayBeFine = 1u;
uint fine_mode() {
  return kMayBeFine != 0u ? params.fine : kFineOff;
}
vec4 load_position(uvec2 pixel) {
  return imageLoad(position_image, texel(pixel));
}
void store_position(uvec2 pixel, vec4 position) {
  imageStore(position_image, texel(pixel), position);
}
vec4 load_previous(uvec2 pixel) {
  return imageLoad(previous_image, texel(pixel));
}
void store_previous(uvec2 pixel, vec4 previous) {
  imageStore(previous_image, texel(pixel), previous);
}
vec4 load_carry(uvec2 pixel) {
  return imageLoad(carry_image, texel(pixel));
}
void store_carry(uvec2 pixel, vec4 carry) {
  imageStore(carry_image, texel(pixel), carry);
}
vec3 load_anchor(uvec2 pixel) {
  return load_position(pixel).xyz;
}

// What constraints move: a point's position, or its offset (lib/fine.h); w: inverse mass.
vec4 load_point(uvec2 pixel) {
  return fine_mode() != kFineOff ? imageLoad(offset_image, texel(pixel)) : imageLoad(position_image, texel(pixel));
}

void store_point(uvec2 pixel, vec3 moved, float mass_inverse) {
  if (fine_mode() != kFineOff) {
    imageStore(offset_image, texel(pixel), vec4(moved, mass_inverse));
  } else {
    imageStore(position_image, texel(pixel), vec4(moved, mass_inverse));
  }
}

// From one point to another, which were loaded by load_point().
vec3 way_between(uvec2 pa, vec4 a, uvec2 pb, vec4 b) {
  precise vec3 d = b.xyz - a.xyz;
  if (fine_mode() != kFineOff) {
    d = (imageLoad(previous_image, texel(pb)).xyz - imageLoad(previous_image, texel(pa)).xyz) + d;
  }
  return d;
}

// The same when the substep began; only with offsets.
vec3 first_way_between(uvec2 pa, uvec2 pb) {
  precise vec3 base = imageLoad(previous_image, texel(pb)).xyz - imageLoad(previous_image, texel(pa)).xyz;
  precise vec3 low = imageLoad(carry_image, texel(pb)).xyz - imageLoad(carry_image, texel(pa)).xyz;
  precise vec3 d = base + low;
  return d;
}
#endif
