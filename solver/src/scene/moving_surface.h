// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geocloth/solver/scene.h"

namespace geocloth {

/// A surface that an animation deforms, and what rides on it.
class MovingSurface {
 public:
  /// @param place  from the body's coordinates to those in which all that follows is
  /// @throws Error(invalid_data) when it has a vertex at no finite place, or a triangle of vertices that it has not
  MovingSurface(MovingBody body, const Transform& place);

  /// On to where the next frame ends [s]. @throws as the constructor
  void advance(double time);

  [[nodiscard]] const TriangleSurface& at_end() const { return now_; }       ///< of the frame
  [[nodiscard]] const std::vector<Vec3>& before() const { return before_; }  ///< [m] of all vertices, at its start
  /// Points beside it, by its place when the frame began.
  [[nodiscard]] std::vector<SurfacePlace> places_of(std::span<const Vec3> points) const;
  [[nodiscard]] Vec3 at_start(const SurfacePlace& place) const { return point_of(place, before_); }
  [[nodiscard]] Vec3 at_end(const SurfacePlace& place) const { return point_of(place, now_.position); }
  /// Of the triangle there, a unit; up where it has no area.
  [[nodiscard]] Vec3 normal_at_start(const SurfacePlace& place) const { return normal_of(place, before_); }
  [[nodiscard]] Vec3 normal_at_end(const SurfacePlace& place) const { return normal_of(place, now_.position); }
  /// Where points beside the surface as the file opens are at its place when the frame began; none where that is how
  /// the file opens.
  [[nodiscard]] std::optional<std::vector<Vec3>> carried_from_opening(std::span<const Vec3> points) const;

 private:
  [[nodiscard]] std::vector<Vec3> positions_at(double time) const;
  [[nodiscard]] std::vector<Vec3> placed(std::vector<Vec3> position) const;
  [[nodiscard]] std::vector<SurfacePlace> places_on(const std::vector<Vec3>& position,
                                                    std::span<const Vec3> points) const;
  [[nodiscard]] Vec3 point_of(const SurfacePlace& place, const std::vector<Vec3>& position) const;
  [[nodiscard]] Vec3 normal_of(const SurfacePlace& place, const std::vector<Vec3>& position) const;

  MovingBody body_;
  Transform place_;
  TriangleSurface now_;
  std::vector<Vec3> before_;
};

/// The body of a collider that an animation deforms: in every frame another field, of the same spacing.
class MovingCollider {
 public:
  /// @param spacing  [m] of its fields; 0: of about 300,000 nodes
  /// @throws Error(invalid_argument) as make_distance_field
  MovingCollider(MovingBody body, const Transform& place, float spacing);

  /// On to where the next frame ends [s].
  void advance(double time);

  /// At the end of the frame, in the collider's coordinates.
  [[nodiscard]] const std::shared_ptr<const DistanceField>& field() const { return field_; }
  [[nodiscard]] const MovingSurface& surface() const { return surface_; }
  /// Of its bounding box at the beginning of all [m].
  [[nodiscard]] const Vec3& middle() const { return middle_; }

 private:
  MovingSurface surface_;
  std::shared_ptr<const DistanceField> field_;
  Vec3 middle_;
};

}  // namespace geocloth
