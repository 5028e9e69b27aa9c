// SPDX-License-Identifier: Apache-2.0
// What the passes read besides the cloth: colliders in their local frames with a pose for every substep, gusts, and the
// numbers that follow from the step. Evaluated here, once and in double precision, so that backends only add and
// multiply.

#include "frame_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "cpu/collider_set.h"
#include "geocloth/asset/vec3d.h"
#include "lib/collide_cell.h"

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

Vec3 middle_of(const Convex& convex) {
  Vec3 sum;
  if (convex.surface.triangle.empty()) return convex.planes.front().point;
  for (const auto& t : convex.surface.triangle)
    for (const uint32_t i : t) sum = sum + convex.surface.position[i];
  return (1.F / (3.F * static_cast<float>(convex.surface.triangle.size()))) * sum;
}

/// 0 for a solid that the planes leave open.
float radius_about(const Convex& convex, const Vec3& center) {
  float radius = 0;
  for (const auto& t : convex.surface.triangle)
    for (const uint32_t i : t) radius = std::max(radius, length(convex.surface.position[i] - center));
  return radius;
}

/// Whether a cone that fits into one of the corners is narrower than 30 degrees from its axis to its side; that of a
/// cube has 35. The axis is the mean of the faces' normals by their angles at the corner, which does not depend on how
/// faces are cut into triangles (Thuermer, Wuethrich 1998, "Computing Vertex Normals from Polygonal Facets").
bool has_sharp_corner(const TriangleSurface& surface) {
  constexpr float kSharp = 0.5F;  // sine
  std::vector<Vec3> axis(surface.position.size());
  using Corners = std::array<uint32_t, 3>;
  const auto normal_of = [&](const Corners& t) {
    const Vec3& a = surface.position[t[0]];
    return normalized(cross(surface.position[t[1]] - a, surface.position[t[2]] - a));
  };
  for (const Corners& t : surface.triangle) {
    for (size_t k = 0; k < 3; ++k) {
      const Vec3& corner = surface.position[t[k]];
      const Vec3 one = normalized(surface.position[t[(k + 1) % 3]] - corner);
      const Vec3 other = normalized(surface.position[t[(k + 2) % 3]] - corner);
      axis[t[k]] = axis[t[k]] + std::acos(std::clamp(dot(one, other), -1.F, 1.F)) * normal_of(t);
    }
  }
  for (Vec3& a : axis) a = normalized(a);
  return std::any_of(surface.triangle.begin(), surface.triangle.end(), [&](const Corners& t) {
    const Vec3 n = normal_of(t);
    const bool has_area = dot(n, n) > 0;
    return has_area && std::any_of(t.begin(), t.end(), [&](uint32_t v) { return dot(n, axis[v]) < kSharp; });
  });
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
  Transform operator()(const Convex& s) const { return {middle_of(s), {}, 1}; }
  Transform operator()(const MeshSolid&) const { return {}; }

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
  std::vector<float>& numbers;

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
  shader::ColliderShape operator()(const Convex& s) const {
    shader::ColliderShape r{};
    r.kind = shader::kShapeConvex;
    r.data = {static_cast<uint32_t>(numbers.size()), static_cast<uint32_t>(s.planes.size()), 0, 0};
    r.core = std::numeric_limits<float>::max();
    const Vec3 center = middle_of(s);
    for (const Plane& plane : s.planes) {
      const float offset = dot(plane.normal, plane.point - center);
      numbers.insert(numbers.end(), {plane.normal.x, plane.normal.y, plane.normal.z, offset});
      r.core = std::min(r.core, std::max(offset, 0.F));
    }
    r.a.x = radius_about(s, center);
    r.b.z = has_sharp_corner(s.surface) ? 1.F : 0.F;
    return r;
  }
  shader::ColliderShape operator()(const MeshSolid& s) const {
    const DistanceField& field = *s.field;
    shader::ColliderShape r = grid_of(field);
    r.b.z = -std::min(0.F, *std::min_element(field.distance.begin(), field.distance.end()));
    r.data.x = static_cast<uint32_t>(numbers.size());
    numbers.insert(numbers.end(), field.distance.begin(), field.distance.end());
    for (const Vec3& way : field.way) numbers.insert(numbers.end(), {way.x, way.y, way.z, 0});
    static_assert(shader::kWayNumbers == 4);
    return r;
  }
};

/// @param p  [m] relative to the origin
shader::ColliderPose make_pose(const Vec3& p, const Quat& rotate) {
  const double x = rotate.x, y = rotate.y, z = rotate.z, w = rotate.w;
  const double s = 2.0 / (x * x + y * y + z * z + w * w);
  const auto row = [](double a, double b, double c, float translate) {
    return vec4{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), translate};
  };
  shader::ColliderPose pose;
  pose.row0 = row(1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y), p.x);
  pose.row1 = row(s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x), p.y);
  pose.row2 = row(s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y), p.z);
  return pose;
}

/// The place of a collider's frame from which on its points are counted: of a plane the nearest to the origin, as a
/// slope may be given by a point that is far away, and what friction may hold is less than single precision has there.
Vec3 near_place(const Collider& collider, const Transform& frame, const Vec3& origin) {
  if (!std::holds_alternative<Plane>(collider.shape)) return {};
  const Vec3 seen = rotate(conjugate(frame.rotate), origin - frame.translate);
  return {seen.x, 0, seen.z};
}

/// Where a frame is before substep s on its way from `a` to `b`, as seen from the origin, and `turned` from there. In
/// single precision a frame a hundred metres out would go by 4 um more or less in each substep; friction takes cloth
/// along by what a collider goes, and it would slip.
Vec3 place_on_way(const Vec3& a, const Vec3& b, uint32_t s, uint32_t substeps, const Vec3& turned, const Vec3& origin) {
  const double t = static_cast<double>(s) / substeps;
  const Vec3d start = to_double(a) - to_double(origin), end = to_double(b) - to_double(origin);
  return to_float((1 - t) * start + t * end + to_double(turned));
}

/// Axis times angle [rad], the shorter way round.
Vec3 rotation_vector(const Quat& q) {
  const double x = q.x, y = q.y, z = q.z, w = q.w;
  const double sine = std::sqrt(x * x + y * y + z * z);
  if (!(sine > 0)) return {};
  const double scale = 2 * std::atan2(w < 0 ? -sine : sine, std::abs(w)) / sine;
  return {static_cast<float>(scale * x), static_cast<float>(scale * y), static_cast<float>(scale * z)};
}

using Matrix = std::array<std::array<double, 3>, 3>;

/// R - 1 of a rotation by the vector `turn`: sin K + (1 - cos) K K with K = [axis] (Rodrigues), in double precision,
/// for both terms are small.
Matrix turn_less_one(const Vec3& turn) {
  const double angle = std::sqrt(static_cast<double>(dot(turn, turn)));
  const double s = angle > 0 ? std::sin(angle) / angle : 0;
  const double c = angle > 0 ? 2 * std::pow(std::sin(0.5 * angle) / angle, 2) : 0;
  const double x = turn.x, y = turn.y, z = turn.z;
  return {{{-c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y},
           {c * x * y + s * z, -c * (x * x + z * z), c * y * z - s * x},
           {c * x * z - s * y, c * y * z + s * x, -c * (x * x + y * y)}}};
}

Vec3 product(const Matrix& m, const Vec3& v) {
  const auto row = [&](size_t i) { return static_cast<float>(m[i][0] * v.x + m[i][1] * v.y + m[i][2] * v.z); };
  return {row(0), row(1), row(2)};
}

/// Field of a rotation by the vector `turn` about a centre that goes on by `center_step` each substep, and a shift.
shader::FrameField frame_field(const Vec3& turn, const Vec3& shift, const Vec3& center_step, const Vec3& center) {
  const Matrix m = turn_less_one(turn);
  const auto times = [&](size_t i, const Vec3& v) { return m[i][0] * v.x + m[i][1] * v.y + m[i][2] * v.z; };
  const auto row = [&](size_t i, float along) {
    return vec4{static_cast<float>(m[i][0]), static_cast<float>(m[i][1]), static_cast<float>(m[i][2]),
                static_cast<float>(static_cast<double>(along) - times(i, center))};
  };
  const auto drift = [&](size_t i) { return static_cast<float>(-times(i, center_step)); };
  return {row(0, shift.x), row(1, shift.y), row(2, shift.z), {drift(0), drift(1), drift(2), 0}};
}

/// A family of gusts: share of the gust speed, multiple of the slowest frequency, how far the wave runs and blows
/// sideways and upwards relative to the wind. The frequencies have no common multiple, so the wind never repeats.
struct Gust {
  double share, frequency, wave_side, wave_up, blow_side, blow_up;
};
constexpr std::array<Gust, shader::kWindWaves> kGusts{{{0.45, 1, 0.3, 0.1, 0.0, 0.0},
                                                       {0.25, std::numbers::sqrt3, -0.6, 0.4, 0.6, 0.1},
                                                       {0.18, std::numbers::pi, 0.9, -0.5, -0.5, 0.5},
                                                       {0.12, 2 * std::numbers::e, -1.1, -0.9, 0.3, -0.8}}};

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

double radius_of(const shader::ColliderShape& shape) {
  switch (shape.kind) {
    case shader::kShapeSphere:
      return double{shape.a.x};
    case shader::kShapeCapsule:
      return double{shape.a.x} + std::max(shape.a.y, shape.a.z);
    case shader::kShapeBox:
    case shader::kShapeEllipsoid:
      return std::hypot(shape.a.x, shape.a.y, shape.a.z);
    case shader::kShapeConvex:
      return shape.a.x > 0 ? double{shape.a.x} : std::numeric_limits<double>::infinity();
    case shader::kShapeMesh: {
      const auto farthest = [&](float low, uint32_t nodes) {
        return std::max(std::abs(low), std::abs(low + shape.a.w * static_cast<float>(nodes - 1)));
      };
      return std::hypot(farthest(shape.a.x, shape.data.y), farthest(shape.a.y, shape.data.z),
                        farthest(shape.a.z, shape.data.w));
    }
    default:
      return std::numeric_limits<double>::infinity();
  }
}

float thickness_of(const shader::ColliderShape& shape) {
  return shader::half_thickness(shape);
}

Transform collider_frame(const Collider& collider) {
  return compose({collider.pose.translate, collider.pose.rotate, 1}, std::visit(LocalFrame{}, collider.shape));
}

bool same_place(const Transform& a, const Transform& b) {
  return a.translate == b.translate && a.rotate == b.rotate;
}

shader::ColliderShape grid_of(const DistanceField& field) {
  shader::ColliderShape r{};
  r.kind = shader::kShapeMesh;
  r.a = point4(field.low, field.spacing);
  r.b = {1 / field.spacing, field.margin, 0, 0};
  r.data = {0, field.size[0], field.size[1], field.size[2]};
  r.core = field.spacing;  // thinner parts do not show in the grid
  return r;
}

shader::ColliderShape collider_shape_of(const Collider& collider, std::vector<float>& numbers) {
  shader::ColliderShape shape = std::visit(LocalShape{numbers}, collider.shape);
  shape.friction = collider.friction;
  const bool has_ball = shape.kind != shader::kShapePlane && shape.kind != shader::kShapeConvex;
  shape.b.w = has_ball ? static_cast<float>(radius_of(shape)) : std::numeric_limits<float>::max();
  return shape;
}

float longest_deformation(const Collider& collider) {
  const auto* body = std::get_if<MeshSolid>(&collider.shape);
  float most = 0;
  if (body == nullptr) return most;
  for (const Vec3& way : body->field->way) most = std::max(most, dot(way, way));
  return std::sqrt(most);
}

void collider_poses(std::span<const Transform> from, std::span<const Collider> to, std::span<const float> deform,
                    uint32_t substeps, const Vec3& origin, std::vector<shader::ColliderPose>& poses) {
  poses.resize(from.size() * (substeps + 1));
  for (size_t i = 0; i < from.size(); ++i) {
    const Transform& a = from[i];
    const Transform b = collider_frame(to[i]);
    const Vec3 place = near_place(to[i], a, origin);
    const bool goes = a.translate != b.translate;
    for (uint32_t s = 0; s <= substeps; ++s) {
      const float t = static_cast<float>(s) / static_cast<float>(substeps);
      const Quat turn = a.rotate == b.rotate ? b.rotate : slerp(a.rotate, b.rotate, t);
      const Vec3 turned = rotate(turn, place);
      const Vec3 seen =
          goes ? place_on_way(a.translate, b.translate, s, substeps, turned, origin) : b.translate + turned - origin;
      shader::ColliderPose& pose = poses[s * from.size() + i];
      pose = make_pose(seen, turn);
      pose.deform = deform[i] > 0 ? vec4{1 - t, deform[i], 0, 0} : vec4{};
    }
  }
}

bool may_slip_through(const shader::ColliderShape& shape, float spacing) {
  return shader::meets_triangles(spacing, shape);
}

bool may_open_cells(std::span<const shader::ColliderShape> shapes, float spacing) {
  return std::any_of(shapes.begin(), shapes.end(),
                     [&](const shader::ColliderShape& s) { return shader::opens_cells(spacing, s); });
}

void substep_inputs(const FrameClock& clock, const std::optional<Wind>& wind, const Vec3& origin,
                    std::vector<shader::Substep>& inputs) {
  inputs.assign(clock.substeps, shader::Substep{});
  for (uint32_t s = 0; s < clock.substeps; ++s) {
    inputs[s].pin_fraction = 1.F / static_cast<float>(clock.substeps - s);
    inputs[s].frame_fraction = static_cast<float>(s + 1) / static_cast<float>(clock.substeps);
    inputs[s].substep_share = 1.F / static_cast<float>(clock.substeps);
    if (wind) add_gusts(inputs[s], *wind, clock.start + s * clock.dt, origin);
  }
}

shader::FrameField motion_field(const Transform& from, const Transform& to, float share, const Vec3& origin) {
  const Vec3 shift = share * (to.translate - from.translate);
  const Vec3 turn = share * rotation_vector(conjugate(from.rotate) * to.rotate);
  return frame_field(rotate(from.rotate, turn), shift, shift, from.translate - origin);
}

ParentWay::ParentWay(const Transform& from, const Transform& to, const Vec3& center)
    : center_(center), turn_(rotate(from.rotate, rotation_vector(conjugate(from.rotate) * to.rotate))) {
  turns_ = from.rotate != to.rotate;
  const Vec3 arm = center - from.translate;
  for (size_t k = 0; k < turned_.size(); ++k)
    turned_[k] = turn_less_one(static_cast<float>(k + 1) / static_cast<float>(turned_.size()) * turn_);
  // The mean velocity of the end of the arm over its chord is that of a turn about its start with this arm.
  const double half = 0.5 * length(turn_);
  const auto chord_of_arc = static_cast<float>(half > 0 ? std::sin(half) / half : 1);
  arm_ = chord_of_arc * (arm + product(turned_[1], arm));
  shift_ = (to.translate - from.translate) + product(turned_[3], arm);
}

PinBow ParentWay::bow_of(const Vec3& from, const Vec3& to) const {
  constexpr float kLike = 0.5F;  // of what the parent turns it by: what it may be beside that
  if (!turns_) return {};
  const Vec3 arm = from - center_, turned = product(turned_[3], arm);
  const Vec3 beside = (to - from) - shift_ - turned;
  if (!(length(beside) <= kLike * length(turned))) return {};
  const auto off_chord = [&](size_t k) {
    return product(turned_[k], arm) - static_cast<float>(k + 1) / static_cast<float>(turned_.size()) * turned;
  };
  constexpr float kLeanAtQuarter = 0.375F;  // of lean: 4 t (1 - t) (1 - 2 t)
  return {off_chord(1), (0.5F / kLeanAtQuarter) * (off_chord(2) - off_chord(0)), true};
}

void set_frame_motion(shader::ClothParams& params, const Transform& from, const Transform& to, const ParentWay& way,
                      const Vec3& inertia_scale, uint32_t substeps, const Vec3& origin) {
  if (from.translate == to.translate && from.rotate == to.rotate) return;
  const Quat back = conjugate(from.rotate);
  const float step = 1.F / static_cast<float>(substeps);
  const Vec3 shift = step * (to.translate - from.translate);
  const Vec3 turn = step * rotation_vector(back * to.rotate);  // about the parent's axes
  const Vec3 taken{1 - inertia_scale.x, 1 - inertia_scale.y, 1 - inertia_scale.z};
  const auto share = [&](const Vec3& v) { return Vec3{taken.x * v.x, taken.y * v.y, taken.z * v.z}; };
  const Vec3 taken_turn = rotate(from.rotate, share(turn));
  const Vec3 taken_shift = rotate(from.rotate, share(rotate(back, shift)));
  params.moving = 1;
  if (!way.turns()) {
    params.whole = motion_field(from, to, step, origin);
    params.taken = frame_field(taken_turn, taken_shift, shift, from.translate - origin);
    return;
  }
  const Vec3 center = way.center() - origin, center_step = step * way.shift();
  params.whole = frame_field(step * way.turn(), center_step, center_step, center);
  params.taken = frame_field(taken_turn, taken_shift + cross(taken_turn, way.arm()), center_step, center);
}

shader::PinTarget pin_target(uint32_t pixel, const Vec3& from, const Vec3& to, const PinHold& hold,
                             const BackBall& back, const PinBow& bow, double dt) {
  shader::PinTarget target{point4(to, 0),
                           point4(from, 0),
                           {pixel, 0, 0, 0},
                           {hold.max_distance, 0, 0, 0},
                           point4(back.to, back.radius),
                           point4(back.from, 0),
                           point4(bow.middle, bow.bows ? 1.F : 0.F),
                           point4(bow.lean, 0)};
  if (!(hold.frequency > 0)) return target;
  const double turn = 2 * std::numbers::pi * static_cast<double>(hold.frequency) * dt;
  const double a = turn * turn, b = 2 * turn;
  target.target.w = static_cast<float>(a / (1 + a + b));
  target.start.w = static_cast<float>(b / (1 + a + b));
  return target;
}

float largest_stretch(const Material& m, const Vec3& gravity, const std::optional<Wind>& wind, float pressure,
                      float reach) {
  // A sheet that has swung down from level is longer by 1.5 times its weight over its stiffness. Where less or nothing
  // draws it down it is not held tighter than on the earth: what colliders and hands draw it by is not known here.
  constexpr float kSolverStrain = 0.001F, kSwing = 1.5F, kEarth = 9.81F;
  constexpr float kLongestGarment = 10;  // [m] a larger one is most often a file whose unit was not told
  constexpr float kFlagDrag = 0.15F;     // of all of its area, by which a flag that streams pulls at its pole
  if (m.max_stretch >= 0) return m.max_stretch;
  if (m.stiffness >= 0) return 0;  // the seeds' cloth is as elastic as its step
  float load = kSwing * m.areal_density * std::max(length(gravity), kEarth);  // [N/m^2]
  if (wind) {
    const float of_wind = 0.5F * static_cast<float>(kAirDensity) * dot(wind->velocity, wind->velocity);
    load += kFlagDrag * std::max(wind->drag, wind->lift) * of_wind;
  }
  load += std::abs(pressure);
  return kSolverStrain + load * std::min(reach, kLongestGarment) / std::min(m.stretch_warp, m.stretch_weft);
}

void set_imperfection(float share, const Vec3& gravity, float size, const Vec3& origin, shader::ClothParams& p) {
  constexpr float kWaves = 2;                                                         // in as much as a cloth is large
  const auto step = static_cast<float>(4.0 * share * length(gravity) * p.dt * p.dt);  // a wave goes up by a quarter
  if (!(step > 0 && size > 0)) return;
  p.stray_step = point4(step * Vec3{0.48F, 0.36F, 0.8F}, 1);  // in no plane that cloth is likely to lie in
  const Vec3 wave = (kWaves / size) * Vec3{0.62F, 0.31F, 0.72F};
  const double turns = double{wave.x} * origin.x + double{wave.y} * origin.y + double{wave.z} * origin.z;
  p.stray_wave = point4(wave, static_cast<float>(turns - std::floor(turns)));
}

shader::ClothParams cloth_params(const Material& m, const FrameClock& clock, const Vec3& gravity,
                                 const std::optional<Wind>& wind, float wind_scale, float pressure) {
  constexpr float kLargestArea = 1.25F;  // of that at rest
  const double dt = clock.dt;
  const auto step = [&](float g) { return static_cast<float>(g * dt * dt); };
  const auto share = [](float stiffness) { return stiffness >= 0 ? stiffness : 1.F; };
  shader::ClothParams p{};
  p.carried_at = -1;
  p.gravity_step = {step(gravity.x), step(gravity.y), step(gravity.z), 0};
  p.dt = static_cast<float>(dt);
  p.inverse_dt = static_cast<float>(1 / dt);
  p.inverse_dt2 = static_cast<float>(1 / (dt * dt));
  p.keep = m.verlet_damping >= 0 ? m.verlet_damping : static_cast<float>(std::exp(-m.damping * dt));
  p.thickness = m.thickness;
  p.friction = m.friction;
  p.max_step = static_cast<float>(m.max_speed * dt);
  p.share_structural = p.share_shear = share(m.stiffness);
  p.share_bending = share(m.bend_stiffness);
  if (wind && (wind->drag > 0 || wind->lift > 0)) {
    p.air = 1;
    p.wind = point4(wind->velocity, wind_scale);
    p.air_factor = static_cast<float>(kAirDensity / (2.0 * m.areal_density));
    p.drag = wind->drag;
    p.lift = wind->lift;
  }
  if (pressure != 0) {
    p.air = 1;
    p.pressure.x = pressure / 6;
    p.pressure.y = 6 * kLargestArea / m.areal_density;
  }
  return p;
}

}  // namespace geocloth
