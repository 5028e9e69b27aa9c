// SPDX-License-Identifier: GPL-3.0-or-later
#include "view/screen_map.h"

#include <cmath>
#include <numbers>

namespace geocloth::view {

ScreenMap::ScreenMap(const Camera& camera, const PictureSize& size)
    : eye_(camera.eye),
      axes_(view_axes(camera.eye, camera.target)),
      half_width_(static_cast<float>(size.width) / 2),
      half_height_(static_cast<float>(size.height) / 2),
      slope_(std::tan(camera.field_of_view_deg * std::numbers::pi_v<float> / 360) / half_height_) {}

Ray ScreenMap::ray(const Vec2& place) const {
  const float right = (place.x - half_width_) * slope_, up = (half_height_ - place.y) * slope_;
  return {eye_, right * axes_.right + up * axes_.up - axes_.back};
}

float ScreenMap::depth(const Vec3& point) const {
  return dot(eye_ - point, axes_.back);
}

std::optional<Vec2> ScreenMap::place(const Vec3& point) const {
  const float ahead = depth(point);
  if (!(ahead > 0)) return std::nullopt;
  const Vec3 way = point - eye_;
  const float pixels = 1 / (slope_ * ahead);
  return Vec2{half_width_ + dot(way, axes_.right) * pixels, half_height_ - dot(way, axes_.up) * pixels};
}

Vec3 ScreenMap::in_view_plane(const Vec2& place, const Vec3& through) const {
  const Ray to = ray(place);
  return to.origin + depth(through) * to.direction;
}

}  // namespace geocloth::view
