// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/camera.h"
#include "render/render_options.h"

namespace geocloth::view {

/// A camera that a mouse turns about a point, moves and brings nearer. Ways are in pixels of the picture.
class OrbitView {
 public:
  /// As near as all of the subject is seen, from where it is looked at now.
  void frame(const Bounds& subject, const PictureSize& size);
  /// To the right: what is looked at turns to the right with the mouse.
  void orbit(const Vec2& way);
  /// What is looked at stays under the mouse.
  void pan(const Vec2& way, const PictureSize& size);
  /// @param steps  of the wheel; above 0: nearer
  void zoom(float steps);
  /// Goes along [m].
  void shift(const Vec3& way) { target_ += way; }
  [[nodiscard]] Camera camera() const;

 private:
  float azimuth_deg_ = OrbitCamera{}.azimuth_deg, elevation_deg_ = OrbitCamera{}.elevation_deg;
  Vec3 target_;
  float distance_ = 1;  ///< [m]
  float size_ = 1;      ///< [m] diagonal of the subject
};

}  // namespace geocloth::view
