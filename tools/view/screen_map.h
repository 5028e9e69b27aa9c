// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "render/camera.h"
#include "render/render_options.h"

namespace geocloth::view {

/// A ray from the eye. The point at the depth d [m] along the view axis is origin + d * direction.
struct Ray {
  Vec3 origin, direction;
};

/// How points of the scene and places of the picture [pixels from the upper left corner] belong together.
class ScreenMap {
 public:
  ScreenMap(const Camera& camera, const PictureSize& size);

  [[nodiscard]] Ray ray(const Vec2& place) const;
  /// [m] along the view axis; behind the eye below 0.
  [[nodiscard]] float depth(const Vec3& point) const;
  /// Not set for a point that is not in front of the eye.
  [[nodiscard]] std::optional<Vec2> place(const Vec3& point) const;
  /// Where the ray through a place meets the plane through a point that faces the camera.
  [[nodiscard]] Vec3 in_view_plane(const Vec2& place, const Vec3& through) const;

 private:
  Vec3 eye_;
  ViewAxes axes_;
  float half_width_, half_height_;  ///< [pixels]
  float slope_;                     ///< of a ray, per pixel
};

}  // namespace geocloth::view
