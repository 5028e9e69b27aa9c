// SPDX-License-Identifier: Apache-2.0
// How far colliders go in a substep, by themselves and as seen from what is carried along.

#include "colliders/ways.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "colliders/reach.h"
#include "frame_input.h"

namespace geocloth {
namespace {

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
  const double farthest = std::sqrt(*std::max_element(way2.begin(), way2.end()));
  if (turn2 == 0) return static_cast<float>(farthest);
  const double way = farthest + std::sqrt(turn2) * outline.radius;
  return turn2 < 0.25 && way < static_cast<double>(kAnyWay) ? static_cast<float>(way) : kAnyWay;
}

/// A rigid motion, or a pose, in double precision.
struct Rigid {
  std::array<std::array<double, 3>, 3> turn{};
  std::array<double, 3> shift{};
};

Rigid rigid_of(const shader::ColliderPose& pose) {
  const auto row = [](const shader::vec4& r) { return std::array<double, 3>{r.x, r.y, r.z}; };
  return {{row(pose.row0), row(pose.row1), row(pose.row2)}, {pose.row0.w, pose.row1.w, pose.row2.w}};
}

Rigid rigid_of(const shader::FrameField& motion) {
  Rigid r = rigid_of(shader::ColliderPose{motion.row0, motion.row1, motion.row2});
  for (size_t i = 0; i < 3; ++i) r.turn[i][i] += 1;
  return r;
}

/// First b, then a.
Rigid after(const Rigid& a, const Rigid& b) {
  Rigid r;
  for (size_t i = 0; i < 3; ++i) {
    r.shift[i] = a.shift[i];
    for (size_t k = 0; k < 3; ++k) {
      r.shift[i] += a.turn[i][k] * b.shift[k];
      for (size_t j = 0; j < 3; ++j) r.turn[i][j] += a.turn[i][k] * b.turn[k][j];
    }
  }
  return r;
}

Rigid inverse(const Rigid& a) {
  Rigid r;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      r.turn[i][j] = a.turn[j][i];
      r.shift[i] -= a.turn[j][i] * a.shift[j];
    }
  }
  return r;
}

shader::vec4 row_of(const Rigid& a, size_t i) {
  return {static_cast<float>(a.turn[i][0]), static_cast<float>(a.turn[i][1]), static_cast<float>(a.turn[i][2]),
          static_cast<float>(a.shift[i])};
}

shader::FrameField field_of(Rigid a) {
  for (size_t i = 0; i < 3; ++i) a.turn[i][i] -= 1;
  return {row_of(a, 0), row_of(a, 1), row_of(a, 2), {0, 0, 0, 0}};
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

shader::FrameField last_motion(const ColliderPath& path, size_t collider) {
  const Rigid before = rigid_of(path.pose(path.substeps - 1, collider));
  return field_of(after(rigid_of(path.pose(path.substeps, collider)), inverse(before)));
}

shader::FrameField scaled(const shader::FrameField& motion, double times) {
  const auto t = static_cast<float>(times);
  const auto row = [t](const shader::vec4& r) { return shader::vec4{t * r.x, t * r.y, t * r.z, t * r.w}; };
  return {row(motion.row0), row(motion.row1), row(motion.row2), row(motion.drift)};
}

float way_beside(const shader::ColliderShape& shape, const ColliderPath& path, size_t collider,
                 const shader::FrameField& motion) {
  const Outline outline = outline_of(shape);
  const Rigid taken = rigid_of(motion);
  float way = 0;
  for (const uint32_t s : {0U, path.substeps - 1}) {  // it moves evenly in between
    const Rigid along = after(taken, rigid_of(path.pose(s, collider)));
    const shader::ColliderPose there{row_of(along, 0), row_of(along, 1), row_of(along, 2)};
    way = std::max(way, way_between(there, path.pose(s + 1, collider), outline));
  }
  return way;
}

}  // namespace geocloth
