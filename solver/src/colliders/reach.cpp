// SPDX-License-Identifier: Apache-2.0
// Which cloths a moving collider may touch in a frame: the box about the collider in its own frame, turned into the
// world at each of its poses and widened by the way to the next pose, against the box about the cloth (the overlap of
// boxes in Ericson, Real-Time Collision Detection, 2005, 4.2). Planes are half-spaces against the box's nearest corner.

#include "colliders/reach.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace geocloth {
namespace {

using shader::vec4;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

LocalBox box_of_shape(const shader::ColliderShape& shape) {
  const vec4& a = shape.a;
  switch (shape.kind) {
    case shader::kShapeSphere:
      return {{}, {a.x, a.x, a.x}};
    case shader::kShapeCapsule: {
      const float radius = std::max(a.y, a.z);
      return {{}, {a.x + radius, radius, radius}};
    }
    case shader::kShapeBox:
    case shader::kShapeEllipsoid:
      return {{}, {a.x, a.y, a.z}};
    case shader::kShapeConvex:
      return a.x > 0 ? LocalBox{{}, {a.x, a.x, a.x}} : LocalBox{{}, {kInfinity, kInfinity, kInfinity}};
    case shader::kShapeMesh:
      return box_of_grid(shape);
    default:
      return {{}, {kInfinity, kInfinity, kInfinity}};
  }
}

float on_axis(const vec4& row, const Vec3& p) {
  return row.x * p.x + row.y * p.y + row.z * p.z;
}

/// Half the width of a turned box along an axis of the world.
float half_width(const vec4& row, const Vec3& half) {
  return std::abs(row.x) * half.x + std::abs(row.y) * half.y + std::abs(row.z) * half.z;
}

bool plane_reaches(const shader::ColliderPose& pose, const ClothBox& box, float margin) {
  const Vec3 normal{pose.row0.y, pose.row1.y, pose.row2.y};  // the local y axis
  const Vec3 nearest{normal.x > 0 ? box.low.x : box.high.x, normal.y > 0 ? box.low.y : box.high.y,
                     normal.z > 0 ? box.low.z : box.high.z};
  return dot(normal, nearest - Vec3{pose.row0.w, pose.row1.w, pose.row2.w}) <= margin;
}

/// A box without bounds.
bool is_endless(const LocalBox& box) {
  return box.half.x == kInfinity;
}

/// About a turned box, widened.
ClothBox box_at(const LocalBox& local, const shader::ColliderPose& pose, float wide) {
  const Vec3 middle{on_axis(pose.row0, local.center) + pose.row0.w, on_axis(pose.row1, local.center) + pose.row1.w,
                    on_axis(pose.row2, local.center) + pose.row2.w};
  const Vec3 half{half_width(pose.row0, local.half) + wide, half_width(pose.row1, local.half) + wide,
                  half_width(pose.row2, local.half) + wide};
  return {middle - half, middle + half};
}

/// [m] A body that deforms is as far from its grid, which holds it at the frame's end, as it still has to go.
float way_to_next(const shader::ColliderShape& shape, const shader::ColliderPose& pose) {
  return shape.way + pose.deform.x * pose.deform.y;
}

}  // namespace

LocalBox box_of_grid(const shader::ColliderShape& shape) {
  const float step = 0.5F * shape.a.w;
  const Vec3 half{step * static_cast<float>(shape.data.y - 1), step * static_cast<float>(shape.data.z - 1),
                  step * static_cast<float>(shape.data.w - 1)};
  return {Vec3{shape.a.x, shape.a.y, shape.a.z} + half, half};
}

ClothBox box_of(const ClothAsset& asset, std::span<const vec4> position) {
  ClothBox box;
  for (uint32_t p = 0; p < position.size(); ++p)
    if (asset.valid(p)) box.add({position[p].x, position[p].y, position[p].z});
  return box;
}

ClothBox swept_box(std::span<const shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                   uint32_t collider) {
  const shader::ColliderShape& shape = shapes[collider];
  const LocalBox local = box_of_shape(shape);
  if (is_endless(local)) return {{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};
  ClothBox swept;
  for (size_t k = collider; k < poses.size(); k += shapes.size()) {
    const ClothBox box = box_at(local, poses[k], way_to_next(shape, poses[k]));
    swept.add(box.low);
    swept.add(box.high);
  }
  return swept;
}

bool are_near(const ClothBox& a, const ClothBox& b, float margin) {
  return a.low.x - margin <= b.high.x && b.low.x - margin <= a.high.x && a.low.y - margin <= b.high.y &&
         b.low.y - margin <= a.high.y && a.low.z - margin <= b.high.z && b.low.z - margin <= a.high.z;
}

bool may_reach(std::span<const shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
               uint32_t collider, const ClothBox& box, float margin) {
  const shader::ColliderShape& shape = shapes[collider];
  const LocalBox local = box_of_shape(shape);
  for (size_t k = collider; k < poses.size(); k += shapes.size()) {
    const float wide = margin + way_to_next(shape, poses[k]);
    // The passes meet planes where they are at the end of a substep, and sweep all else.
    const bool reached = shape.kind == shader::kShapePlane
                             ? plane_reaches(poses[k], box, margin)
                             : is_endless(local) || are_near(box_at(local, poses[k], wide), box, 0);
    if (reached) return true;
  }
  return false;
}

}  // namespace geocloth
