// SPDX-License-Identifier: Apache-2.0
// What the passes read besides the cloth: colliders in their local frames with a pose for every substep, gusts, and the
// numbers that follow from the step. Evaluated here, once and in double precision, so that backends only add and
// multiply.

#include "frame_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace geocloth {
namespace {

constexpr double kAirDensity = 1.204;  ///< [kg/m^3] at 20 degrees Celsius

using shader::vec4;

vec4 point4(const Vec3& p, float w) {
  return {p.x, p.y, p.z, w};
}

/// Shortest rotation that takes one unit vector to another.
Quat rotation_between(const Vec3& from, const Vec3& to) {
  const Vec3 axis = cross(from, to);
  const double w = 1.0 + static_cast<double>(dot(from, to));
  if (w < 1e-7) {  // opposite: half a turn about anything across
    const Vec3 other = std::abs(from.x) < 0.5F ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    const Vec3 across = normalized(cross(from, other));
    return {across.x, across.y, across.z, 0};
  }
  const double n = 1.0 / std::sqrt(static_cast<double>(dot(axis, axis)) + w * w);
  return {static_cast<float>(axis.x * n), static_cast<float>(axis.y * n), static_cast<float>(axis.z * n),
          static_cast<float>(w * n)};
}

/// Pose of a shape's local frame (see ColliderShape in layout.h) in the collider's.
struct LocalFrame {
  Transform operator()(const Plane& s) const { return {s.point, rotation_between({0, 1, 0}, normalized(s.normal)), 1}; }
  Transform operator()(const Sphere& s) const { return {s.center, {}, 1}; }
  Transform operator()(const Capsule& s) const {
    const Vec3 axis = s.b - s.a;
    if (is_ball(s)) return {s.radius_a >= s.radius_b ? s.a : s.b, {}, 1};
    return {0.5F * (s.a + s.b), rotation_between({1, 0, 0}, normalized(axis)), 1};
  }
  Transform operator()(const Box& s) const { return {s.center, s.rotate, 1}; }
  Transform operator()(const Ellipsoid& s) const { return {s.center, s.rotate, 1}; }

  /// One end ball of the capsule holds the other.
  static bool is_ball(const Capsule& s) { return length(s.b - s.a) <= std::abs(s.radius_a - s.radius_b); }
};

shader::ColliderShape ball(float radius) {
  shader::ColliderShape r{};
  r.kind = shader::kShapeSphere;
  r.a.x = r.core = radius;
  return r;
}

struct LocalShape {
  shader::ColliderShape operator()(const Plane&) const {
    shader::ColliderShape r{};
    r.kind = shader::kShapePlane;
    r.core = std::numeric_limits<float>::max();
    return r;
  }
  shader::ColliderShape operator()(const Sphere& s) const { return ball(s.radius); }
  shader::ColliderShape operator()(const Capsule& s) const {
    if (LocalFrame::is_ball(s)) return ball(std::max(s.radius_a, s.radius_b));
    shader::ColliderShape r{};
    r.kind = shader::kShapeCapsule;
    const double axis = length(s.b - s.a);
    const double slope = (static_cast<double>(s.radius_a) - s.radius_b) / axis;
    r.a = {static_cast<float>(0.5 * axis), s.radius_a, s.radius_b, 0};
    r.b = {static_cast<float>(slope), static_cast<float>(slope / std::sqrt(1.0 - slope * slope)), 0, 0};
    r.core = std::min(s.radius_a, s.radius_b);
    return r;
  }
  shader::ColliderShape operator()(const Box& s) const {
    shader::ColliderShape r{};
    r.kind = shader::kShapeBox;
    r.a = point4(s.half_extents, 0);
    r.core = std::min({s.half_extents.x, s.half_extents.y, s.half_extents.z});
    return r;
  }
  shader::ColliderShape operator()(const Ellipsoid& s) const {
    shader::ColliderShape r{};
    r.kind = shader::kShapeEllipsoid;
    r.a = point4(s.radii, 0);
    r.core = std::min({s.radii.x, s.radii.y, s.radii.z});
    return r;
  }
};

shader::ColliderPose make_pose(const Transform& t, const Vec3& origin) {
  const double x = t.rotate.x, y = t.rotate.y, z = t.rotate.z, w = t.rotate.w;
  const double s = 2.0 / (x * x + y * y + z * z + w * w);
  const auto row = [](double a, double b, double c, float translate) {
    return vec4{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), translate};
  };
  const Vec3 p = t.translate - origin;
  shader::ColliderPose pose;
  pose.row0 = row(1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), p.x);
  pose.row1 = row(s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x), p.y);
  pose.row2 = row(s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y), p.z);
  return pose;
}

constexpr float kAnyWay = 1e30F;  ///< [m] no bound

/// Radius about the local origin of the shape with the thickest cloth on it (1 m).
double radius_of(const shader::ColliderShape& shape) {
  switch (shape.kind) {
    case shader::kShapeSphere:
      return 1.0 + shape.a.x;
    case shader::kShapeCapsule:
      return 1.0 + shape.a.x + std::max(shape.a.y, shape.a.z);
    case shader::kShapeBox:
    case shader::kShapeEllipsoid:
      return 1.0 + std::hypot(shape.a.x, shape.a.y, shape.a.z);
    default:
      return std::numeric_limits<double>::infinity();
  }
}

/// T + F R of out_of_reach() in collide.h; F is the Frobenius norm of the change of the rotation matrix.
float way_between(const shader::ColliderPose& a, const shader::ColliderPose& b, double radius) {
  double turn2 = 0, shift2 = 0;
  for (const auto& [p, q] : {std::pair{a.row0, b.row0}, std::pair{a.row1, b.row1}, std::pair{a.row2, b.row2}}) {
    const double x = q.x - p.x, y = q.y - p.y, z = q.z - p.z, w = q.w - p.w;
    turn2 += x * x + y * y + z * z;
    shift2 += w * w;
  }
  if (turn2 == 0) return static_cast<float>(std::sqrt(shift2));
  const double way = std::sqrt(shift2) + std::sqrt(turn2) * radius;
  return turn2 < 0.25 && way < static_cast<double>(kAnyWay) ? static_cast<float>(way) : kAnyWay;
}

/// A family of gusts: share of the gust speed, multiple of the slowest frequency, how far the wave runs and blows
/// sideways and upwards relative to the wind.
struct Gust {
  double share, frequency, wave_side, wave_up, blow_side, blow_up;
};
constexpr std::array<Gust, shader::kWindWaves> kGusts{{{0.45, 1.0, 0.3, 0.1, 0.0, 0.0},
                                                       {0.25, 1.73, -0.6, 0.4, 0.6, 0.1},
                                                       {0.18, 3.11, 0.9, -0.5, -0.5, 0.5},
                                                       {0.12, 5.27, -1.1, -0.9, 0.3, -0.8}}};

/// Waves that travel with the wind: at a fixed point gust k has the frequency f_k, and its length is speed / f_k.
void add_gusts(shader::Substep& substep, const Wind& wind, double time, const Vec3& origin) {
  const double speed = length(wind.velocity);
  if (speed <= 0 || wind.turbulence <= 0) return;
  const Vec3 along = normalized(wind.velocity);
  const Vec3 side = normalized(cross(along, std::abs(along.y) < 0.9F ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
  const Vec3 up = cross(side, along);
  for (uint32_t k = 0; k < shader::kWindWaves; ++k) {
    const Gust& g = kGusts[k];
    const double frequency = g.frequency * wind.frequency;
    const Vec3 wave = static_cast<float>(frequency / speed) *
                      (along + static_cast<float>(g.wave_side) * side + static_cast<float>(g.wave_up) * up);
    const double phase = 0.37 * k - frequency * time + static_cast<double>(dot(wave, origin));
    const Vec3 blow = normalized(along + static_cast<float>(g.blow_side) * side + static_cast<float>(g.blow_up) * up);
    substep.waves[k].wave = point4(wave, static_cast<float>(phase - std::floor(phase)));
    substep.waves[k].gust = point4(static_cast<float>(g.share * wind.turbulence * speed) * blow, 0);
  }
}

}  // namespace

Transform collider_frame(const Collider& collider) {
  return compose({collider.pose.translate, collider.pose.rotate, 1}, std::visit(LocalFrame{}, collider.shape));
}

shader::ColliderShape collider_shape_of(const Collider& collider) {
  shader::ColliderShape shape = std::visit(LocalShape{}, collider.shape);
  shape.friction = collider.friction;
  return shape;
}

std::vector<shader::ColliderPose> collider_poses(std::span<const Collider> from, std::span<const Collider> to,
                                                 uint32_t substeps, const Vec3& origin) {
  std::vector<shader::ColliderPose> poses;
  poses.reserve(from.size() * (substeps + 1));
  for (uint32_t s = 0; s <= substeps; ++s) {
    const float t = static_cast<float>(s) / static_cast<float>(substeps);
    for (size_t i = 0; i < from.size(); ++i) {
      const Transform a = collider_frame(from[i]);
      const Transform b = collider_frame(to[i]);
      const Vec3 translate = s == substeps ? b.translate : a.translate + t * (b.translate - a.translate);
      poses.push_back(
          make_pose({translate, a.rotate == b.rotate ? b.rotate : slerp(a.rotate, b.rotate, t), 1}, origin));
    }
  }
  return poses;
}

void measure_ways(std::span<shader::ColliderShape> shapes, std::span<const shader::ColliderPose> poses,
                  uint32_t substeps) {
  for (size_t i = 0; i < shapes.size(); ++i) {
    shapes[i].way = 0;
    for (uint32_t s = 0; s < substeps; ++s) {
      shapes[i].way = std::max(shapes[i].way, way_between(poses[s * shapes.size() + i],
                                                          poses[(s + 1) * shapes.size() + i], radius_of(shapes[i])));
    }
  }
}

std::vector<shader::Substep> substep_inputs(const FrameClock& clock, const std::optional<Wind>& wind,
                                            const Vec3& origin) {
  std::vector<shader::Substep> inputs(clock.substeps, shader::Substep{});
  for (uint32_t s = 0; s < clock.substeps; ++s) {
    inputs[s].pin_fraction = 1.F / static_cast<float>(clock.substeps - s);
    if (wind) add_gusts(inputs[s], *wind, clock.start + s * clock.dt, origin);
  }
  return inputs;
}

shader::ClothParams cloth_params(const Material& m, const FrameClock& clock, const Vec3& gravity,
                                 const std::optional<Wind>& wind) {
  const double dt = clock.dt;
  const auto step = [&](float g) { return static_cast<float>(g * dt * dt); };
  const auto share = [](float stiffness) { return stiffness >= 0 ? stiffness : 1.F; };
  shader::ClothParams p{};
  p.gravity_step = {step(gravity.x), step(gravity.y), step(gravity.z), 0};
  p.dt = static_cast<float>(dt);
  p.inverse_dt = static_cast<float>(1 / dt);
  p.inverse_dt2 = static_cast<float>(1 / (dt * dt));
  p.keep = m.verlet_damping >= 0 ? m.verlet_damping : static_cast<float>(std::exp(-m.damping * dt));
  p.thickness = m.thickness;
  p.friction = m.friction;
  p.max_step = static_cast<float>(m.max_speed * dt);
  p.stretch_limit = m.max_stretch > 0 ? 1 + m.max_stretch : 0;
  p.share_structural = p.share_shear = share(m.stiffness);
  p.share_bending = share(m.bend_stiffness);
  if (wind && (wind->drag > 0 || wind->lift > 0)) {
    p.air = 1;
    p.wind = point4(wind->velocity, 0);
    p.air_factor = static_cast<float>(kAirDensity / (2.0 * m.areal_density));
    p.drag = wind->drag;
    p.lift = wind->lift;
  }
  return p;
}

}  // namespace geocloth
