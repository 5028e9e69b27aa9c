// SPDX-License-Identifier: Apache-2.0
// How the state of one cloth lies in memory, for both backends.
//
// clang-format off
// Per pixel, row by row, pixel (0,0) at the top left (Vulkan: images of width x height; cpu: arrays):
//   position   rgba32f   xyz [m] relative to SimulationData::origin, w = inverse mass [1/kg]; 0: pinned or not valid;
//                        the lowest bits of its mantissa say how far the point gives way, see lib/yield.h
//   previous   rgba32f   xyz position at the start of the substep; velocity = (position - previous) / dt
//   carry      rgba32f   xyz what rounding took away when the position was predicted (compensated sum)
//   normal     rgba32f   xyz unit normal (zero where not valid), w = its length before it was made a unit; of
//                        copies, where a pressure acts, what pressure_acceleration() of lib/predict.h wants
//   springs    rgba32f   one image for each family: (rest length a [m], compliance a [m/N], rest b, compliance b), for
//                        the two forward springs a, b of the family; rest length 0: no spring
//                        structural: right, down; shear: down-right, down-left; bending: right two, down two
//                        bending with a rigidity (lib/bend.h): rest and compliance of the bends over the same pixels;
//                        compliance 0: no bend
//   cell       r32ui     CellBit of cloth_asset.h, and kCellCopyBit of lib/lines.h
//   offset     rgba32f   xyz what position lacks, w = inverse mass; only with ClothParams::fine, see lib/fine.h
// clang-format on
// Buffers: see the structs below. `pixel` is always y * width + x.
#ifndef GEOCLOTH_SHARED_LAYOUT_H
#define GEOCLOTH_SHARED_LAYOUT_H

#include "types.h"

#ifdef __cplusplus
#include <cstddef>
namespace geocloth::shader {
#endif

// Descriptor set 0, one for each cloth.
const uint kBindingParams = 0u;             // uniform  ClothParams
const uint kBindingPosition = 1u;           // image rgba32f
const uint kBindingPrevious = 2u;           // image rgba32f
const uint kBindingCarry = 3u;              // image rgba32f
const uint kBindingNormal = 4u;             // image rgba32f
const uint kBindingSpringsStructural = 5u;  // image rgba32f
const uint kBindingSpringsShear = 6u;       // image rgba32f
const uint kBindingSpringsBending = 7u;     // image rgba32f
const uint kBindingCell = 8u;               // image r32ui
const uint kBindingOffset = 9u;             // image rgba32f, one pixel without ClothParams::fine
const uint kBindingMultipliers = 10u;       // buffer float[], see kMultiplier* (only with relaxation_steps > 1)
const uint kBindingAttachments = 11u;       // buffer Attachment[pixels] (only with max_stretch > 0)
const uint kBindingSeamSprings = 12u;       // buffer SeamSpring[]
const uint kBindingSplitOffset = 13u;       // buffer uint[rows + 1]
const uint kBindingSplitPixel = 14u;        // buffer uint[]
const uint kBindingPins = 15u;              // buffer PinTarget[]
const uint kBindingColliderShapes = 16u;    // buffer ColliderShape[colliders]
const uint kBindingColliderPoses = 17u;     // buffer ColliderPose[(substeps + 1) * colliders], [substep][collider]
const uint kBindingSubsteps = 18u;          // buffer Substep[substeps]
const uint kBindingMeasures = 19u;          // buffer uint[kMeasureCount], bits of non-negative floats, atomicMax
const uint kBindingInverseMass = 20u;       // buffer float[pixels], read when the pins change
const uint kBindingColliderNumbers = 21u;   // buffer float[], see ColliderShape::data
const uint kBindingSelfPoints = 22u;        // buffer SelfPoint[self_points]
const uint kBindingSelfWords = 23u;         // buffer uint[], see lib/self_words.h
const uint kBindingContacts = 24u;          // buffer uint[kContactWords * colliders], see lib/contact_sum.h

// Springs: component c = 0..5 in the order of SpringBit; the multiplier of component c at a pixel is at
// c * pixels + pixel, that of seam bend i at kSpringComponents * pixels + i.
const uint kSpringComponents = 6u;
// Groups: springs of one group share no pixel; component c is projected by the groups 2 c and 2 c + 1.
const uint kSpringGroups = 12u;

const uint kWindWaves = 4u;

// ClothParams::fine, see lib/fine.h.
const uint kFineOff = 0u;
const uint kFineOffsets = 1u;   // constraints act on the offsets
const uint kFineMomentum = 2u;  // and along the directions that springs had when the substep began

const uint kShapePlane = 0u;
const uint kShapeSphere = 1u;
const uint kShapeCapsule = 2u;
const uint kShapeBox = 3u;
const uint kShapeEllipsoid = 4u;
const uint kShapeConvex = 5u;
const uint kShapeMesh = 6u;

const uint kMeasureCopyGap = 0u;      // [m] largest distance between copies
const uint kMeasurePenetration = 1u;  // [m] largest depth below a collider's surface, points that are not pinned
const uint kMeasureWay = 2u;          // [m] longest way in the last substep of a frame, for two frames by turns
const uint kMeasureLeft = 4u;         // points that a carrier leaves behind, for two frames by turns
const uint kMeasureCount = 6u;

// Displacement of every point of a moving rigid frame in substep s: (R - 1) p + shift + drift s.
struct FrameField {
  vec4 row0;  // xyz: row of R - 1, w: component of the shift [m]
  vec4 row1;
  vec4 row2;
  vec4 drift;  // xyz [m]
};

const float kLeaveNear = 2.0f;  // [spacings] ClothParams::leave_near

// What changes from frame to frame and cloth to cloth.
struct ClothParams {
  uint width;
  uint height;
  uint collider_count;
  uint air;           // 1: wind, drag or pressure act
  vec4 gravity_step;  // xyz: dt^2 g [m]; w: dt over that of the frame before
  vec4 wind;          // xyz: mean velocity of the air [m/s]; w: the share of it, gusts too, that the cloth feels
  vec4 stray_step;    // xyz: what dt^2 g strays by [m], see lib/predict.h; w: 1: it does
  vec4 stray_wave;    // xyz: wave vector of that [1/m]; w: its phase [turns], 0..1
  vec4 pressure;      // x: a sixth of it [Pa]; y: six times the largest area for a mass that it acts on [m^2/kg]
  float dt;           // of a substep [s]
  float inverse_dt;   // [1/s]
  float inverse_dt2;  // [1/s^2]
  float keep;         // share of the displacement that a substep keeps: exp(-damping dt), or Zeller's k
  float thickness;    // [m]
  float friction;
  float max_step;    // [m] longest way in a substep; 0: no limit
  float air_factor;  // air density / (2 areal density) [1/m]
  float drag;
  float lift;
  float stretch_limit;     // 1 + max_stretch; 0: no long-range attachments
  float share_structural;  // share of the error that a projection removes: 1, or the seeds' stiffness
  float share_shear;
  float share_bending;
  uint moving;               // 1: the cloth's parent moves in this frame; see lib/frame.h
  uint fine;                 // kFine*
  uint self_points;          // that collide with each other; 0: no self-collision
  uint self_buckets;         // of the hash, a power of two
  float self_distance;       // [m] that points of different layers keep
  float self_reach;          // [m] up to which neighbours are listed
  float leave_near;          // [m] what is nearer to a thin collider stays as it is at a frame's end; see lib/finish.h
  float grip;                // [m] the depth of a contact beyond which friction grows no more; see lib/collide.h
  float carried_at;          // the last substep of a frame with a carrier; below 0: without one
  float left_behind;         // [m] way in it as seen from the carrier of a point that is not taken along
  float spacing;             // [m] of the pixels
  uint self_most_in_bucket;  // a fuller bucket of the hash is left out
  uint inter_points;         // of all cloths that collide with each other; 0: this one with none
  uint inter_buckets;        // of their hash, a power of two
  uint first_shape;          // of the colliders that the cloth meets: all, or a list behind all of some of them
  uint first_pose;           // of those before the first substep; see backend.h
  float sewing_before;       // share of their distance at rest that sewn points may have, at the frame's start
  float sewing_after;        // and at its end
  float contact_scale;       // [1/(kg m)] of contact sums, a power of two; see lib/contact_sum.h
  float unused1;
  float unused2;
  float unused3;
  FrameField whole;
  FrameField taken;
  FrameField carrier;  // the motion of a collider that may take the cloth along
};

// A gust: velocity gust * sin(dot(wave, position) + phase).
struct Wave {
  vec4 wave;  // xyz: wave vector [1/m]; w: phase [turns], 0..1
  vec4 gust;  // xyz [m/s]
};

struct Substep {
  float pin_fraction;    // share of the way that is left to its target that a pinned point goes: 1 / (substeps left)
  float frame_fraction;  // share of the frame that is over after this substep
  float substep_share;   // 1 / substeps
  float unused1;
  Wave waves[kWindWaves];
};

// A pinned pixel; all copies of a point are listed. Held pins have no inverse mass; others keep it.
struct PinTarget {
  vec4 target;  // xyz [m] relative to the origin; w: A / (1 + A + B) of lib/pin.h, 0: not soft
  vec4 start;   // xyz: target at the start of the frame; w: B / (1 + A + B)
  uvec4 pixel;  // x
  vec4 limit;   // x [m] that the point may be from its target, 0: any if soft, else it is held
  vec4 behind;  // xyz [m] from the target to the middle of a ball that the point stays out of; w its radius, 0: none
  vec4 behind_start;  // xyz: the same at the start of the frame
  vec4 bow;           // xyz [m] by which the target's way bows out in the middle of the frame; w 1: it does
  vec4 lean;          // xyz [m] and by how much more later than earlier, see lib/pin.h
};

// Long-range attachment of a pixel: it stays within length * stretch_limit of the anchor, a pinned pixel.
struct Attachment {
  uint anchor;  // pixel; kNoAnchor: none
  float reach;  // [m] to the anchor along the surface at rest (a field named length breaks glslang)
};
const uint kNoAnchor = 0xFFFFFFFFu;

// Over a seam: bending, by a spring from a to b or by the curvature at the middle (lib/bend.h), or a span, a tie or a
// sewing thread from a to b (lib/span.h). Those of one colour share no pixel; a colour is a contiguous range.
struct SeamSpring {
  uint a;
  uint middle;
  uint b;
  float rest;          // [m] of the spring, of the curvature, of the span or of the thread
  float compliance;    // [m/N]
  float chord;         // for the curvature: share of b in the chord at the middle
  float middle_share;  // and share of the middle point's mass that its pixel carries
  float turn;          // and g of lib/bend.h; 0: `beside` is left out
  uint beside;         // pixel of its fourth point
  uint row_a;  // for a tie between whole points: the copies of a, which is the first; kNoRow: it is the only one
  uint row_b;  // and of b
};
const uint kNoRow = 0xFFFFFFFFu;

// A point of a cloth for self-collision, or for the collision between cloths: a valid pixel, of copies the first.
struct SelfPoint {
  vec4 rest;        // xyz [m] at rest, between cloths where it starts; w inverse mass of all copies [1/kg]
  uint pixel;       // the first copy
  uint skip_begin;  // entries skip_begin .. skip_end - 1 of its list in lib/self_words.h; not between cloths
  uint skip_end;
  uint inter_cloth;     // number of its cloth among those that collide
  uint inter_distance;  // bits of a float [m]: what its cloth keeps from others
  uint inter_friction;  // bits of a float
  uint inter_arrival;   // the same number for cloths that came at the same time
  uint unused1;
};

// A collider in its local frame, centred on the origin.
//   plane      half-space y <= 0
//   sphere     a.x radius
//   capsule    about the x axis: a.x half length, a.y radius at -a.x, a.z radius at +a.x, b.x = (a.y - a.z) / length,
//              b.y = tangent of that taper; neither end ball holds the other
//   box        a.xyz half extents
//   ellipsoid  a.xyz radii
//   convex     numbers from data.x on: unit normal and offset of each of data.y planes; inside all n . p <= offset;
//              b.z 1: it has a sharp corner
//   mesh       numbers from data.x on: signed distances [m] at data.y x data.z x data.w nodes, x fastest; a.xyz first
//              node, a.w spacing, b.x = 1 / spacing, b.y margin: no surface is nearer to the sides of the grid, b.z
//              largest depth inside; of a body that deforms they are followed by kWayNumbers for each node: how far
//              [m] the point of the surface that is nearest to it goes in the frame that ends with these distances
// b.w: no point p is nearer than |p| - b.w; no such bound for planes and hulls, whose distance is that to a plane
struct ColliderShape {
  vec4 a;
  vec4 b;
  uvec4 data;
  uint kind;
  float friction;
  float core;  // [m] smallest half width: a way longer than this is swept
  float way;   // [m] no point of it moves farther in a substep of this frame; see collide.h
};

const uint kWayNumbers = 4u;  // three of them count

// World from local: (dot(row0.xyz, p) + row0.w, ...); the rows' xyz are a rotation matrix. The local frame of a body
// that deforms is that of its shape at the end of the frame.
struct ColliderPose {
  vec4 row0;
  vec4 row1;
  vec4 row2;
  vec4 deform;  // x: share of the frame's deformation that is still to come, 0: none; y: longest way [m] of it
};

// Push constants of a dispatch.
struct PassConstants {
  uint substep;           // index into Substep[] and ColliderPose[]
  uint group;             // spring group 0..11
  uint first;             // first seam bend of the colour, first row, first pin
  uint count;             // how many of them; of curvatures: so many times their compliance
  uint read_multiplier;   // 1: XPBD's accumulated multiplier is read (not in the first relaxation step);
                          // of ties and whole ties: only kTieShare is taken
  uint write_multiplier;  // 1: and written (not in the last one)
};

#ifdef __cplusplus
static_assert(sizeof(ClothParams) == 432 && offsetof(ClothParams, whole) == 240 &&
              offsetof(ClothParams, gravity_step) == 16 && offsetof(ClothParams, dt) == 96);
static_assert(sizeof(Wave) == 32 && sizeof(Substep) == 16 + 32 * kWindWaves);
static_assert(sizeof(PinTarget) == 128 && sizeof(Attachment) == 8 && sizeof(SeamSpring) == 44 &&
              sizeof(SelfPoint) == 48);
static_assert(sizeof(ColliderShape) == 64 && sizeof(ColliderPose) == 64 && sizeof(PassConstants) == 24);
}  // namespace geocloth::shader
#endif

#endif
