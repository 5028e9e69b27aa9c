// SPDX-License-Identifier: GPL-3.0-or-later
#include "view/orbit_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geocloth::view {
namespace {

constexpr float kDegreesPerPixel = 0.35F;
constexpr float kMaxElevation = 89;                ///< [degrees] straight from above a picture has no upper side
constexpr float kZoomStep = 0.88F;                 ///< of the distance, per step of the wheel
constexpr float kNearest = 0.08F, kFarthest = 20;  ///< distance as a share of the subject's diagonal

}  // namespace

void OrbitView::frame(const Bounds& subject, const PictureSize& size) {
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  const Camera camera = place_camera(OrbitCamera{azimuth_deg_, elevation_deg_, std::nullopt}, subject, aspect);
  target_ = camera.target;
  distance_ = std::max(length(camera.eye - camera.target), 1e-4F);
  size_ = subject.diagonal() > 1e-6F ? subject.diagonal() : distance_;
}

void OrbitView::orbit(const Vec2& way) {
  azimuth_deg_ = std::remainder(azimuth_deg_ - kDegreesPerPixel * way.x, 360.F);
  elevation_deg_ = std::clamp(elevation_deg_ + kDegreesPerPixel * way.y, -kMaxElevation, kMaxElevation);
}

void OrbitView::pan(const Vec2& way, const PictureSize& size) {
  const Camera now = camera();
  const ViewAxes axes = view_axes(now.eye, now.target);
  const float tall = 2 * std::tan(now.field_of_view_deg * std::numbers::pi_v<float> / 360) * distance_;
  const float per_pixel = tall / static_cast<float>(size.height);
  target_ += (-way.x * per_pixel) * axes.right + (way.y * per_pixel) * axes.up;
}

void OrbitView::zoom(float steps) {
  distance_ = std::clamp(distance_ * std::pow(kZoomStep, steps), kNearest * size_, kFarthest * size_);
}

Camera OrbitView::camera() const {
  Bounds here;
  here.include(target_);
  return place_camera(OrbitCamera{azimuth_deg_, elevation_deg_, distance_}, here, 1);
}

}  // namespace geocloth::view
