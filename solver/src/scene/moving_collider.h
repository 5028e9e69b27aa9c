// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "geocloth/solver/scene.h"

namespace geocloth {

/// The body of a collider that an animation deforms.
class MovingCollider {
 public:
  /// @param place  from the body's coordinates to the collider's
  /// @throws Error(invalid_argument) as make_distance_field
  MovingCollider(MovingBody body, const Transform& place);

  /// On to where the next frame ends [s].
  void advance(double time);

  /// At the end of the frame. Collider's coordinates, as all that follows.
  [[nodiscard]] const std::shared_ptr<const DistanceField>& field() const { return field_; }
  /// Middle of its bounding box at the beginning of all [m].
  [[nodiscard]] const Vec3& middle() const { return middle_; }
  /// By its place when the frame began.
  [[nodiscard]] SurfacePlace place_of(const Vec3& point) const;
  [[nodiscard]] Vec3 at_start(const SurfacePlace& place) const { return point_of(place, before_); }
  [[nodiscard]] Vec3 at_end(const SurfacePlace& place) const { return point_of(place, field_->surface.position); }

 private:
  [[nodiscard]] TriangleSurface surface_at(double time) const;
  [[nodiscard]] Vec3 point_of(const SurfacePlace& place, const std::vector<Vec3>& position) const;

  MovingBody body_;
  Transform place_;
  std::vector<Vec3> before_;  ///< [m] of all vertices when the frame began
  std::shared_ptr<const DistanceField> field_;
  Vec3 middle_;
};

}  // namespace geocloth
