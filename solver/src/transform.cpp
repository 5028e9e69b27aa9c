// SPDX-License-Identifier: Apache-2.0
// Rigid poses and their interpolation over time. Spherical interpolation: Shoemake 1985, "Animating rotation with
// quaternion curves"; computed in double precision, because collider velocities are differences of poses.

#include "geocloth/solver/transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace geocloth {
namespace {

struct Quat64 {
  double x, y, z, w;
};

Quat to_unit(const Quat64& q) {
  const double n = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  if (!(n > 0)) return {};
  return {static_cast<float>(q.x / n), static_cast<float>(q.y / n), static_cast<float>(q.z / n),
          static_cast<float>(q.w / n)};
}

Quat about_axis(int axis, double degrees) {
  const double half = 0.5 * degrees * std::numbers::pi / 180;
  Quat64 q{0, 0, 0, std::cos(half)};
  (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = std::sin(half);
  return to_unit(q);
}

/// About x, then y, then z.
Quat about_axes(double x, double y, double z) {
  return about_axis(2, z) * about_axis(1, y) * about_axis(0, x);
}

/// Whether the way from a to b is that of their angles, not the short one.
bool turns_as_written(const Keyframe& a, const Keyframe& b) {
  constexpr float kHalfTurn = 180;       // [degrees]
  constexpr double kBaked = 0.1 - 1e-9;  // [s] 0.3 - 0.2 is less than 0.1
  if (!a.rotate_deg || !b.rotate_deg || b.time - a.time < kBaked) return false;
  const Vec3 turn = *b.rotate_deg - *a.rotate_deg;
  return std::max({std::abs(turn.x), std::abs(turn.y), std::abs(turn.z)}) >= kHalfTurn;
}

/// t in 0..1, in double precision: of many turns single precision would leave a tremble.
Quat rotation_between(const Keyframe& a, const Keyframe& b, double t) {
  if (!turns_as_written(a, b)) return slerp(a.rotate, b.rotate, static_cast<float>(t));
  const Vec3 &from = *a.rotate_deg, &to = *b.rotate_deg;
  const auto angle = [&](float first, float last) { return first + t * (double{last} - first); };
  return about_axes(angle(from.x, to.x), angle(from.y, to.y), angle(from.z, to.z));
}

}  // namespace

Quat operator*(const Quat& a, const Quat& b) {
  const Quat64 p{a.x, a.y, a.z, a.w};
  return to_unit({p.w * b.x + p.x * b.w + p.y * b.z - p.z * b.y, p.w * b.y - p.x * b.z + p.y * b.w + p.z * b.x,
                  p.w * b.z + p.x * b.y - p.y * b.x + p.z * b.w, p.w * b.w - p.x * b.x - p.y * b.y - p.z * b.z});
}

Quat conjugate(const Quat& q) {
  return {-q.x, -q.y, -q.z, q.w};
}

Quat quat_from_euler_deg(const Vec3& degrees) {
  return about_axes(degrees.x, degrees.y, degrees.z);
}

Quat slerp(const Quat& a, const Quat& b, float t) {
  const double along = static_cast<double>(a.x) * b.x + static_cast<double>(a.y) * b.y +
                       static_cast<double>(a.z) * b.z + static_cast<double>(a.w) * b.w;
  const double sign = along < 0 ? -1 : 1;
  const double angle = std::acos(std::min(sign * along, 1.0));
  const double sine = std::sin(angle);
  const double wa = sine > 1e-9 ? std::sin((1.0 - t) * angle) / sine : 1.0 - t;
  const double wb = sign * (sine > 1e-9 ? std::sin(t * angle) / sine : t);
  return to_unit({wa * a.x + wb * b.x, wa * a.y + wb * b.y, wa * a.z + wb * b.z, wa * a.w + wb * b.w});
}

Transform compose(const Transform& a, const Transform& b) {
  return {apply(a, b.translate), a.rotate * b.rotate, a.scale * b.scale};
}

bool teleports(std::span<const Keyframe> motion, double from, double to) {
  return std::any_of(motion.begin(), motion.end(),
                     [&](const Keyframe& key) { return key.teleport && key.time > from && key.time <= to; });
}

Transform pose_at(std::span<const Keyframe> motion, double time) {
  if (motion.empty()) return {};
  const auto after =
      std::upper_bound(motion.begin(), motion.end(), time, [](double t, const Keyframe& key) { return t < key.time; });
  if (after == motion.begin()) return {motion.front().translate, motion.front().rotate, 1};
  const Keyframe& a = *(after - 1);
  if (after == motion.end() || after->teleport) return {a.translate, a.rotate, 1};
  const Keyframe& b = *after;
  const double t = (time - a.time) / (b.time - a.time);
  return {a.translate + static_cast<float>(t) * (b.translate - a.translate), rotation_between(a, b, t), 1};
}

}  // namespace geocloth
