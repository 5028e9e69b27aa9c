// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "geocloth/asset/vec.h"

namespace geocloth {

/// An axis-parallel box; empty until something is in it.
struct Bounds {
  Vec3 low{1e30F, 1e30F, 1e30F}, high{-1e30F, -1e30F, -1e30F};  ///< [m]

  [[nodiscard]] bool empty() const { return low.x > high.x; }
  [[nodiscard]] Vec3 center() const { return (low + high) * 0.5F; }
  [[nodiscard]] float diagonal() const { return empty() ? 0 : length(high - low); }
  void include(const Vec3& point);
  void include(const Bounds& other);
};
[[nodiscard]] Bounds bounds_of(std::span<const Vec3> points);
[[nodiscard]] Bounds grown(const Bounds& bounds, float margin);
[[nodiscard]] Bounds intersection(const Bounds& a, const Bounds& b);

/// A pinhole camera that looks from eye to target, +y up.
struct Camera {
  Vec3 eye, target;                ///< [m]
  float field_of_view_deg = 28.F;  ///< vertical
};

/// Round the middle of what is shown. Azimuth 0 looks at it from +z, 90 from +x; elevation 90 from above.
struct OrbitCamera {
  float azimuth_deg = 30, elevation_deg = 12;
  std::optional<float> distance;  ///< [m]; not set: as near as everything stays in the picture
};
using CameraChoice = std::variant<OrbitCamera, Camera>;

/// "azimuth,elevation" or "azimuth,elevation,distance" [degrees, degrees, m], or "ex,ey,ez,tx,ty,tz": eye and target
/// [m].
/// @throws Error(invalid_argument)
[[nodiscard]] CameraChoice parse_camera(const std::string& text);

/// The camera of a choice for a picture of `subject`.
/// @param aspect     width / height of the picture
/// @param all_round  leave room for every azimuth, for a turntable
[[nodiscard]] Camera place_camera(const CameraChoice& choice, const Bounds& subject, float aspect,
                                  bool all_round = false);

/// Unit vectors of a view, at right angles: to the right and up in the picture, and from the target to the eye.
struct ViewAxes {
  Vec3 right, up, back;
};
[[nodiscard]] ViewAxes view_axes(const Vec3& eye, const Vec3& target);

/// Column-major 4 x 4 matrices for Vulkan's clip space (y down, depth 0..1).
using Matrix4 = std::array<float, 16>;
[[nodiscard]] Matrix4 operator*(const Matrix4& a, const Matrix4& b);
[[nodiscard]] Matrix4 look_at(const Vec3& eye, const Vec3& target);
[[nodiscard]] Matrix4 perspective(float field_of_view_deg, float aspect, float near, float far);
/// A box of half the given width and height around the view axis.
[[nodiscard]] Matrix4 orthographic(float half_width, float half_height, float near, float far);

}  // namespace geocloth
