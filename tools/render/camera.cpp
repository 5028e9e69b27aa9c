// SPDX-License-Identifier: GPL-3.0-or-later
// A camera that frames its subject: with the view direction given, the nearest distance at which every corner of the
// box is inside the picture is a maximum of eight linear bounds.
#include "render/camera.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "geocloth/asset/error.h"

namespace geocloth {
namespace {

constexpr float kRoomAround = 1.06F;  ///< room left around the subject

float radians(float degrees) {
  return degrees * std::numbers::pi_v<float> / 180.F;
}

/// Unit vector from the target to the eye.
Vec3 orbit_direction(const OrbitCamera& orbit) {
  const float a = radians(orbit.azimuth_deg), e = radians(std::clamp(orbit.elevation_deg, -89.9F, 89.9F));
  return {std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
}

/// The same box turned to every azimuth.
Bounds swept_round(const Bounds& box) {
  const Vec3 half = (box.high - box.low) * 0.5F, middle = box.center();
  const float radius = std::hypot(half.x, half.z);
  return {middle - Vec3{radius, half.y, radius}, middle + Vec3{radius, half.y, radius}};
}

float framing_distance(const Bounds& box, const ViewAxes& axes, float field_of_view_deg, float aspect) {
  const float tall = std::tan(radians(field_of_view_deg) / 2) / kRoomAround, wide = tall * aspect;
  float distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 c = Vec3{(corner & 1) != 0 ? box.high.x : box.low.x, (corner & 2) != 0 ? box.high.y : box.low.y,
                        (corner & 4) != 0 ? box.high.z : box.low.z} -
                   box.center();
    const float towards = dot(c, axes.back);
    distance =
        std::max({distance, std::abs(dot(c, axes.right)) / wide + towards, std::abs(dot(c, axes.up)) / tall + towards});
  }
  return distance;
}

std::vector<float> parse_numbers(const std::string& text) {
  std::vector<float> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (true) {
    float value = 0;
    const auto [stop, failure] = std::from_chars(at, end, value);
    if (failure != std::errc() || !std::isfinite(value)) return {};
    numbers.push_back(value);
    if (stop == end) return numbers;
    if (*stop != ',') return {};
    at = stop + 1;
  }
}

}  // namespace

void Bounds::include(const Vec3& p) {
  low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

void Bounds::include(const Bounds& other) {
  if (other.empty()) return;
  include(other.low);
  include(other.high);
}

Bounds bounds_of(std::span<const Vec3> points) {
  Bounds bounds;
  for (const Vec3& point : points)
    if (is_finite(point)) bounds.include(point);
  return bounds;
}

Bounds grown(const Bounds& bounds, float margin) {
  if (bounds.empty()) return bounds;
  const Vec3 m{margin, margin, margin};
  return {bounds.low - m, bounds.high + m};
}

Bounds intersection(const Bounds& a, const Bounds& b) {
  const Bounds common{{std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y), std::max(a.low.z, b.low.z)},
                      {std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y), std::min(a.high.z, b.high.z)}};
  const bool apart = common.low.x > common.high.x || common.low.y > common.high.y || common.low.z > common.high.z;
  return apart ? Bounds{} : common;
}

CameraChoice parse_camera(const std::string& text) {
  const std::vector<float> n = parse_numbers(text);
  if (n.size() == 2) return OrbitCamera{n[0], n[1], std::nullopt};
  if (n.size() == 3 && n[2] > 0) return OrbitCamera{n[0], n[1], n[2]};
  if (n.size() == 6 && Vec3{n[0], n[1], n[2]} != Vec3{n[3], n[4], n[5]})
    return Camera{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  throw Error(ErrorCode::invalid_argument,
              fmt::format("{} is no camera; give azimuth,elevation or azimuth,elevation,distance [degrees, m], or six "
                          "numbers: eye and target [m]",
                          text));
}

Camera place_camera(const CameraChoice& choice, const Bounds& subject, float aspect, bool all_round) {
  if (const auto* fixed = std::get_if<Camera>(&choice)) return *fixed;
  const auto& orbit = std::get<OrbitCamera>(choice);
  Bounds box = subject.empty() ? Bounds{{-1, -1, -1}, {1, 1, 1}} : subject;
  if (box.diagonal() < 1e-6F) box = grown(box, 0.5F);
  if (all_round) box = swept_round(box);
  Camera camera{.eye = {}, .target = box.center()};
  const Vec3 direction = orbit_direction(orbit);
  const ViewAxes axes = view_axes(camera.target + direction, camera.target);
  const float distance = orbit.distance.value_or(framing_distance(box, axes, camera.field_of_view_deg, aspect));
  camera.eye = camera.target + direction * distance;
  return camera;
}

ViewAxes view_axes(const Vec3& eye, const Vec3& target) {
  const Vec3 difference = eye - target;
  const Vec3 back = length(difference) > 0 ? normalized(difference) : Vec3{0, 0, 1};
  const Vec3 across = cross(Vec3{0, 1, 0}, back);
  const Vec3 right = length(across) > 1e-6F ? normalized(across) : Vec3{1, 0, 0};
  return {right, cross(back, right), back};
}

Matrix4 operator*(const Matrix4& a, const Matrix4& b) {
  Matrix4 product{};
  for (size_t column = 0; column < 4; ++column)
    for (size_t row = 0; row < 4; ++row)
      for (size_t k = 0; k < 4; ++k) product[column * 4 + row] += a[k * 4 + row] * b[column * 4 + k];
  return product;
}

Matrix4 look_at(const Vec3& eye, const Vec3& target) {
  const ViewAxes v = view_axes(eye, target);
  return {v.right.x, v.up.x, v.back.x, 0, v.right.y,          v.up.y,          v.back.y,          0,
          v.right.z, v.up.z, v.back.z, 0, -dot(v.right, eye), -dot(v.up, eye), -dot(v.back, eye), 1};
}

Matrix4 perspective(float field_of_view_deg, float aspect, float near, float far) {
  const float f = 1 / std::tan(radians(field_of_view_deg) / 2);
  return {f / aspect, 0, 0, 0, 0, -f, 0, 0, 0, 0, far / (near - far), -1, 0, 0, near * far / (near - far), 0};
}

Matrix4 orthographic(float half_width, float half_height, float near, float far) {
  return {1 / half_width, 0, 0, 0, 0, -1 / half_height, 0, 0, 0, 0, 1 / (near - far), 0, 0, 0, near / (near - far), 1};
}

}  // namespace geocloth
