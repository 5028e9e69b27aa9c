// SPDX-License-Identifier: Apache-2.0
// Distance to a collider for callers on the host: the same functions that the passes use, in the same local frames.

#include "geocloth/solver/collider.h"

#include "check_input.h"
#include "cpu/collider_set.h"
#include "frame_input.h"

namespace geocloth {

struct SignedDistance::Impl {
  Transform frame;
  std::shared_ptr<const DistanceField> field;  ///< of a mesh
  std::vector<float> numbers;                  ///< of the shape, but for a mesh's
  shader::ColliderShape shape;
};

SignedDistance::SignedDistance(const Collider& collider) {
  check(collider, "the collider whose distance is wanted", true);
  auto impl = std::make_unique<Impl>();
  impl->frame = collider_frame(collider);
  if (const auto* mesh = std::get_if<MeshSolid>(&collider.shape)) {
    impl->field = mesh->field;
    impl->shape = grid_of(*mesh->field);
  } else {
    impl->shape = collider_shape_of(collider, impl->numbers);
  }
  impl_ = std::move(impl);
}
SignedDistance::~SignedDistance() = default;
SignedDistance::SignedDistance(SignedDistance&&) noexcept = default;
SignedDistance& SignedDistance::operator=(SignedDistance&&) noexcept = default;

float SignedDistance::operator()(const Vec3& point) const {
  const shader::ColliderShape& shape = impl_->shape;
  const Vec3 local = rotate(conjugate(impl_->frame.rotate), point - impl_->frame.translate);
  const shader::vec3 p{local.x, local.y, local.z};
  if (shape.kind == shader::kShapeEllipsoid)
    return shader::nearest_ellipsoid(shader::xyz(shape.a), p, shader::kEllipsoidSteps).distance;
  const float* const numbers = impl_->field ? impl_->field->distance.data() : impl_->numbers.data();
  return shader::nearest_of_shape({&shape, nullptr, 1, numbers}, shape, p).distance;
}

float signed_distance(const Collider& collider, const Vec3& point) {
  return SignedDistance(collider)(point);
}

}  // namespace geocloth
