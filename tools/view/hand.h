// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geocloth/solver/solver.h"
#include "view/pick.h"

namespace geocloth::view {

/// A hand that holds a point of a cloth. It pulls by a soft pin, so hard that all of the cloth hangs from it by a sag
/// of two centimetres, and no harder than some times the cloth's weight: where the cloth cannot follow it is not torn
/// apart.
class Hand {
 public:
  /// @param cloth_pixels  valid pixels of that cloth
  Hand(const Picked& picked, uint32_t cloth_pixels);

  /// Where the mouse wants the point, in the plane of the view through where it was taken.
  void move(const ScreenMap& screen, const Vec2& place) { goal_ = screen.in_view_plane(place, taken_.point); }
  [[nodiscard]] uint32_t cloth() const { return taken_.cloth; }
  [[nodiscard]] uint32_t pixel() const { return taken_.pixel; }
  [[nodiscard]] const Vec3& goal() const { return goal_; }
  /// @param now  [m] where the point is
  [[nodiscard]] Pin pin(const Vec3& now) const;

 private:
  Picked taken_;
  Vec3 goal_;
  float frequency_;  ///< [1/s]
};

}  // namespace geocloth::view
