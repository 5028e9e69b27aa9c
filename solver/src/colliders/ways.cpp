// SPDX-License-Identifier: Apache-2.0
// How far colliders go in a substep, by themselves and as seen from what is carried along.

#include "colliders/ways.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "colliders/reach.h"
#include "frame_input.h"
#include "lib/frame.h"

namespace geocloth {
namespace {

constexpr float kAnyWay = 1e30F;  ///< [m] no bound

/// What holds a shape: the hull of balls about some of its points [m], in its own frame.
struct Outline {
  std::array<Vec3, 8> point{};
  size_t points = 1;  ///< the first one: the frame's origin
  double radius = 0;  ///< of the balls
};

Outline corners_of(const LocalBox& box) {
  Outline r;
  r.points = r.point.size();
  for (size_t i = 0; i < r.points; ++i) {
    const Vec3 side{(i & 1U) != 0 ? 1.F : -1.F, (i & 2U) != 0 ? 1.F : -1.F, (i & 4U) != 0 ? 1.F : -1.F};
    r.point[i] = box.center + Vec3{side.x * box.half.x, side.y * box.half.y, side.z * box.half.z};
  }
  return r;
}

Outline outline_of(const shader::ColliderShape& shape) {
  switch (shape.kind) {
    case shader::kShapeCapsule:
      return {.point = {Vec3{-shape.a.x, 0, 0}, Vec3{shape.a.x, 0, 0}},
              .points = 2,
              .radius = std::max(shape.a.y, shape.a.z)};
    case shader::kShapeBox:
      return corners_of({{}, {shape.a.x, shape.a.y, shape.a.z}});
    case shader::kShapeEllipsoid:
      return {.radius = std::max({shape.a.x, shape.a.y, shape.a.z})};
    case shader::kShapeMesh:
      return corners_of(box_of_grid(shape));
    default:
      return {.radius = radius_of(shape)};
  }
}

/// How far a point is from the shape at most when its distance as shapes.h has it is 1. A hull has the largest distance
/// to one of its planes; grown about its centre by that over its core it holds the point.
double spread_of(const shader::ColliderShape& shape) {
  if (shape.kind != shader::kShapeConvex) return 1;
  return shape.core > 0 && shape.a.x > 0 ? double{shape.a.x} / shape.core : std::numeric_limits<double>::infinity();
}

/// T + F R of out_of_reach() in collide.h: the way of a ball whose centre goes farthest. A turn of the shape by an
/// angle moves what is at the distance 1 by F = 2 sin(angle / 2), the norm of the change of the rotation matrix by
/// entries over the root of 2.
float way_between(const shader::ColliderPose& a, const shader::ColliderPose& b, const Outline& outline) {
  double turn2 = 0;
  std::array<double, 8> way2{};
  for (const auto& [p, q] : {std::pair{a.row0, b.row0}, std::pair{a.row1, b.row1}, std::pair{a.row2, b.row2}}) {
    const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z, w = q.w - p.w;
    turn2 += 0.5 * (x * x + y * y + z * z);
    for (size_t i = 0; i < outline.points; ++i) {
      const Vec3& at = outline.point[i];
      way2[i] += std::pow(x * at.x + y * at.y + z * at.z + w, 2);
    }
  }
  const double deformed = std::abs(double{b.deform.x} - a.deform.x) * b.deform.y;
  const double farthest = std::sqrt(*std::max_element(way2.begin(), way2.end())) + deformed;
  if (turn2 == 0) return static_cast<float>(farthest);
  const double way = farthest + std::sqrt(turn2) * outline.radius;
  return turn2 < 0.25 && way < static_cast<double>(kAnyWay) ? static_cast<float>(way) : kAnyWay;
}

/// Where a motion takes a pose in a step.
shader::ColliderPose taken_along(const shader::ColliderPose& pose, const shader::FrameField& motion, float step) {
  const auto turned = [&](shader::vec3 axis) { return axis + shader::field_turn(motion, axis); };
  const shader::vec3 x = turned({pose.row0.x, pose.row1.x, pose.row2.x});
  const shader::vec3 y = turned({pose.row0.y, pose.row1.y, pose.row2.y});
  const shader::vec3 z = turned({pose.row0.z, pose.row1.z, pose.row2.z});
  const shader::vec3 from{pose.row0.w, pose.row1.w, pose.row2.w};
  const shader::vec3 to = from + shader::field_at(motion, step, from);
  return {{x.x, y.x, z.x, to.x}, {x.y, y.y, z.y, to.y}, {x.z, y.z, z.z, to.z}, pose.deform};
}

}  // namespace

void measure_ways(std::span<shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                  uint32_t substeps, double margin) {
  for (size_t i = 0; i < shapes.size(); ++i) {
    Outline outline = outline_of(shapes[i]);
    if (margin > 0) outline.radius += margin * spread_of(shapes[i]);
    shapes[i].way = 0;
    for (uint32_t s = 0; s < substeps; ++s) {
      shapes[i].way = std::max(shapes[i].way,
                               way_between(poses[s * shapes.size() + i], poses[(s + 1) * shapes.size() + i], outline));
    }
  }
}

float way_beside(std::span<const shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                 uint32_t collider, const shader::FrameField& motion, float step) {
  const Outline outline = outline_of(shapes[collider]);
  const size_t last = poses.size() - 2 * shapes.size();
  float way = 0;
  for (const size_t k : {size_t{collider}, last + collider}) {  // it moves evenly in between
    way = std::max(way, way_between(taken_along(poses[k], motion, step), poses[k + shapes.size()], outline));
  }
  return way;
}

}  // namespace geocloth
