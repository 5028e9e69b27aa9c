// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geocloth/asset/vec.h"

namespace geocloth {

/// Unit quaternion, w + xi + yj + zk.
struct Quat {
  float x = 0, y = 0, z = 0, w = 1;
  bool operator==(const Quat&) const = default;
};
[[nodiscard]] Quat operator*(const Quat& a, const Quat& b);
[[nodiscard]] Quat conjugate(const Quat& q);
[[nodiscard]] inline Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.F * cross(u, v);
  return v + q.w * t + cross(u, t);
}
/// Rotations about x, then y, then z (fixed axes) [degrees].
[[nodiscard]] Quat quat_from_euler_deg(const Vec3& degrees);
/// Shortest-path spherical interpolation, t in 0..1.
[[nodiscard]] Quat slerp(const Quat& a, const Quat& b, float t);

/// x' = translate + rotate * (scale * x)
struct Transform {
  Vec3 translate = {};
  Quat rotate = {};
  float scale = 1;  ///< of a cloth 1e-6..1e6
};
[[nodiscard]] inline Vec3 apply(const Transform& t, const Vec3& p) {
  return t.translate + rotate(t.rotate, t.scale * p);
}
/// apply(compose(a, b), p) == apply(a, apply(b, p))
[[nodiscard]] Transform compose(const Transform& a, const Transform& b);

/// A pose over time. Linear in translation, spherical in rotation; held before the first and after the last key.
struct Keyframe {
  double time = 0;  ///< [s], ascending
  Vec3 translate = {};
  Quat rotate = {};
  bool teleport = false;  ///< the pose of the key before is held until this one, which is jumped to
  /// The angles that `rotate` is of [degrees], where it was written so: see pose_at().
  std::optional<Vec3> rotate_deg = {};
};
using Motion = std::vector<Keyframe>;
/// A key with teleport lies after `from` and not after `to`.
[[nodiscard]] bool teleports(std::span<const Keyframe> motion, double from, double to);
/// Identity for an empty motion. A rotation goes the short way to the next key. Where one of the angles of both keys
/// changes by 180 degrees or more, the angles are followed as they are written, so that 0 to 360 is a whole turn; but
/// not between keys of less than 0.1 s, as baked motion has them, whose angles may jump from 180 to -180.
[[nodiscard]] Transform pose_at(std::span<const Keyframe> motion, double time);

}  // namespace geocloth
