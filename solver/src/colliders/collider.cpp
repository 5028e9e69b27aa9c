// SPDX-License-Identifier: Apache-2.0
// Distance to a collider for callers on the host: the same functions that the passes use, in the same local frames.

#include "geocloth/solver/collider.h"

#include "cpu/collider_set.h"
#include "frame_input.h"

namespace geocloth {

float signed_distance(const Collider& collider, const Vec3& point) {
  const Transform frame = collider_frame(collider);
  const Vec3 local = rotate(conjugate(frame.rotate), point - frame.translate);
  const shader::vec3 p{local.x, local.y, local.z};
  if (const auto* mesh = std::get_if<MeshSolid>(&collider.shape)) {
    const shader::ColliderShape grid = grid_of(*mesh->field);
    return shader::nearest_of_shape({&grid, nullptr, 1, mesh->field->distance.data()}, grid, p).distance;
  }
  std::vector<float> numbers;
  const shader::ColliderShape shape = collider_shape_of(collider, numbers);
  if (shape.kind == shader::kShapeEllipsoid) return shader::nearest_ellipsoid(shader::xyz(shape.a), p).distance;
  return shader::nearest_of_shape({&shape, nullptr, 1, numbers.data()}, shape, p).distance;
}

}  // namespace geocloth
