// SPDX-License-Identifier: Apache-2.0
// Balls, segments and planes beyond which a collider certainly touches nothing, so that most points need no more than a
// distance to these (bounding volumes; Ericson, Real-Time Collision Detection, 2005, chapter 4).

#include "cpu/collider_guards.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "colliders/reach.h"
#include "cpu/collider_set.h"
#include "lib/collide.h"
#include "lib/finish.h"

namespace geocloth::cpu {
namespace {

constexpr float kGuardRounding = 1e-5F;  // relative

/// A ball around the grid of a mesh's field: beyond the grid the distance is at least that to the grid. What deforms is
/// at most as far from the grid, which holds it at the frame's end, as it still has to go.
void guard_field(const shader::ColliderShape& shape, const shader::ColliderPose& pose, ColliderGuard& guard) {
  const LocalBox grid = box_of_grid(shape);
  const shader::vec3 middle = shader::rigid_to_world(pose, {grid.center.x, grid.center.y, grid.center.z});
  const float radius = length(grid.half) + pose.deform.x * pose.deform.y;
  guard.x = middle.x;
  guard.y = middle.y;
  guard.z = middle.z;
  guard.reach = radius + kGuardRounding * (1 + shader::length3(middle) + radius);
}

}  // namespace

void guard_colliders(const FrameInput& frame, const shader::ClothParams& params, std::vector<ColliderGuard>& guards) {
  const MetColliders met(frame, params);
  const size_t count = met.shapes.size();
  guards.clear();
  for (size_t s = 0; s < frame.substeps.size(); ++s) {
    for (size_t c = 0; c < count; ++c) {
      const shader::ColliderShape& shape = met.shapes[c];
      const shader::ColliderPose& pose = met.poses[(s + 1) * count + c];
      const float x = pose.row0.w, y = pose.row1.w, z = pose.row2.w;
      const float margin = params.thickness + shader::kGripped * params.spacing + 2 * shape.way +
                           kGuardRounding * (1 + std::abs(x) + std::abs(y) + std::abs(z));
      ColliderGuard guard{x, y, z, std::numeric_limits<float>::infinity()};
      switch (shape.kind) {
        case shader::kShapePlane:
          guard = {pose.row0.y, pose.row1.y, pose.row2.y, 0, ColliderGuard::Kind::plane};
          guard.reach = margin + guard.x * x + guard.y * y + guard.z * z;
          break;
        case shader::kShapeSphere:
          guard.reach = margin + shape.a.x * (1 + kGuardRounding);
          break;
        case shader::kShapeCapsule:
          guard.reach = margin + std::max(shape.a.y, shape.a.z) * (1 + kGuardRounding) + shape.a.x * kGuardRounding;
          guard.kind = ColliderGuard::Kind::segment;
          guard.axis_x = pose.row0.x;
          guard.axis_y = pose.row1.x;
          guard.axis_z = pose.row2.x;
          guard.half_length = shape.a.x;
          break;
        case shader::kShapeBox:
          guard.reach = margin + std::hypot(shape.a.x, shape.a.y, shape.a.z) * (1 + kGuardRounding);
          break;
        case shader::kShapeEllipsoid:
          guard.reach = margin + std::max({shape.a.x, shape.a.y, shape.a.z}) * (1 + kGuardRounding);
          break;
        case shader::kShapeMesh:
          guard_field(shape, pose, guard);
          guard.reach += margin;
          break;
        case shader::kShapeConvex:
          // Its distance is the largest height above a plane, less than that to the corners. Where that is m at most,
          // the solid grown about its centre by 1 + m / core holds the point.
          if (!(shape.core > 0) || !(shape.a.x > 0)) break;
          guard.spread = shape.a.x / shape.core * (1 + kGuardRounding);
          guard.reach = (shape.a.x + margin * guard.spread) * (1 + kGuardRounding);
          break;
        default:
          break;  // always near
      }
      guards.push_back(guard);
    }
  }
}

}  // namespace geocloth::cpu
