// SPDX-License-Identifier: Apache-2.0
// Nothing that is out of its documented range gets into the solver: not a number, an infinite length or a negative
// radius would come out again as a cloth that has vanished.

#include "check_input.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "geocloth/asset/error.h"
#include "rest/fabrics.h"

namespace geocloth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Far below anything that is cloth: from less, inverses, squares and their products would leave single precision.
constexpr double kLightest = 1e-6;         ///< [kg/m^2]
constexpr double kSmallestScale = 1e-6;    ///< of a transform
constexpr double kSmallestSpacing = 1e-9;  ///< [m] of a distance field
constexpr double kShortestStep = 1e-7;     ///< [s] of a substep

/// Of 1e-6 a float is a little less.
bool is_at_least(double value, double low) {
  return value >= low || value == static_cast<double>(static_cast<float>(low));
}

std::string number(double value) {
  std::array<char, 32> text{};
  const int length = std::snprintf(text.data(), text.size(), "%.9g", value);
  return {text.data(), static_cast<size_t>(length)};
}

[[noreturn]] void refuse(const std::string& where, const std::string& field, double value, const std::string& rule) {
  throw Error(ErrorCode::invalid_argument, where + ": " + field + " is " + number(value) + "; it must be " + rule);
}

void check_at_least(double value, double low, const std::string& where, const char* field, double high = kInfinity) {
  if (std::isfinite(value) && is_at_least(value, low) && value <= high) return;
  refuse(where, field, value,
         std::isfinite(high) ? "between " + number(low) + " and " + number(high)
                             : "a finite number of at least " + number(low));
}

void check_above(double value, double low, const std::string& where, const char* field, double high = kInfinity) {
  if (std::isfinite(value) && value > low && value <= high) return;
  refuse(where, field, value,
         "a finite number above " + number(low) + (std::isfinite(high) ? " and up to " + number(high) : ""));
}

void check_none_or(double value, double low, const std::string& where, const char* field, double high) {
  if (value == 0 || (std::isfinite(value) && is_at_least(value, low) && value <= high)) return;
  refuse(where, field, value, "0 or between " + number(low) + " and " + number(high));
}

/// Also of what is not a number.
bool is_beyond(float component, float largest) {
  return !(std::abs(component) <= largest);
}

bool is_within(const Vec3& v, float largest) {
  return !is_beyond(v.x, largest) && !is_beyond(v.y, largest) && !is_beyond(v.z, largest);
}

void check_vector(const Vec3& v, float largest, const std::string& where, const char* field) {
  for (const float c : {v.x, v.y, v.z})
    if (is_beyond(c, largest)) {
      refuse(where, field, c, "finite, each component within +-" + number(largest));
    }
}

void check_sizes(const Vec3& v, const std::string& where, const char* field) {
  for (const float c : {v.x, v.y, v.z}) check_above(c, 0, where, field, kLargestLength);
}

void check_rotation(const Quat& q, const std::string& where) {
  const double n = std::sqrt(static_cast<double>(q.x) * q.x + static_cast<double>(q.y) * q.y +
                             static_cast<double>(q.z) * q.z + static_cast<double>(q.w) * q.w);
  if (!(std::abs(n - 1) < 1e-3)) refuse(where, "the length of the quaternion `rotate`", n, "1");
}

/// @param known  how many nodes there are is looked at, and not what they have
void check_field(const DistanceField& f, const std::string& where, bool known) {
  const double nodes = static_cast<double>(f.size[0]) * f.size[1] * f.size[2];  // exact where a vector could be as long
  if (*std::min_element(f.size.begin(), f.size.end()) < 2 || static_cast<double>(f.distance.size()) != nodes) {
    std::string size;
    for (const uint32_t n : f.size) size += (size.empty() ? "" : " x ") + std::to_string(n);
    throw Error(ErrorCode::invalid_argument,
                where + ": its field has " + std::to_string(f.distance.size()) + " distances for " + size +
                    " nodes; it must have one for each, and 2 nodes along each side; see make_distance_field");
  }
  check_at_least(f.spacing, kSmallestSpacing, where, "the field's spacing", kLargestLength);
  check_at_least(f.margin, 0, where, "the field's margin", kLargestLength);
  check_vector(f.low, kLargestLength, where, "the field's low");
  const auto high = [&](float low, uint32_t n) { return low + f.spacing * static_cast<float>(n - 1); };
  check_vector({high(f.low.x, f.size[0]), high(f.low.y, f.size[1]), high(f.low.z, f.size[2])}, kLargestLength, where,
               "the field's last node");
  if (!f.way.empty() && f.way.size() != f.distance.size()) {
    throw Error(ErrorCode::invalid_argument,
                where + ": its field has " + std::to_string(f.way.size()) + " ways for " +
                    std::to_string(f.distance.size()) +
                    " nodes; it must have one for each, or none; see make_deforming_field");
  }
  if (known) return;
  constexpr float kFarthest = 4 * kLargestLength;  // no node is farther from a surface in the grid
  const auto bad =
      std::find_if(f.distance.begin(), f.distance.end(), [](float d) { return !(std::abs(d) <= kFarthest); });
  if (bad != f.distance.end()) refuse(where, "a distance of the field", *bad, "within +-" + number(kFarthest));
  for (const Vec3& way : f.way) check_vector(way, kLargestLength, where, "a way of the field");
}

struct ShapeCheck {
  const std::string& where;
  bool known;
  void operator()(const Plane& s) const { check(s, where); }
  void operator()(const Sphere& s) const {
    check_vector(s.center, kLargestLength, where, "center");
    check_above(s.radius, 0, where, "radius", kLargestLength);
  }
  void operator()(const Capsule& s) const {
    check_vector(s.a, kLargestLength, where, "a");
    check_vector(s.b, kLargestLength, where, "b");
    check_above(s.radius_a, 0, where, "radius", kLargestLength);
    check_above(s.radius_b, 0, where, "radius_b", kLargestLength);
  }
  void operator()(const Box& s) const {
    check_vector(s.center, kLargestLength, where, "center");
    check_sizes(s.half_extents, where, "half_extents");
    check_rotation(s.rotate, where);
  }
  void operator()(const Ellipsoid& s) const {
    check_vector(s.center, kLargestLength, where, "center");
    check_sizes(s.radii, where, "radii");
    check_rotation(s.rotate, where);
  }
  void operator()(const Convex& s) const {
    if (s.planes.empty()) throw Error(ErrorCode::invalid_argument, where + ": has no planes; see convex_hull");
    if (s.planes.size() > kMostConvexPlanes) {
      throw Error(ErrorCode::invalid_argument, where + ": has " + std::to_string(s.planes.size()) +
                                                   " planes; it may have " + std::to_string(kMostConvexPlanes) +
                                                   ": see convex_hull, or make it a body of triangles");
    }
    for (const Plane& plane : s.planes) (*this)(plane);
    for (const auto& triangle : s.surface.triangle)
      for (const uint32_t i : triangle) {
        if (i >= s.surface.position.size()) {
          throw Error(ErrorCode::invalid_argument, where + ": a triangle of its surface refers to position " +
                                                       std::to_string(i) + ", but there are " +
                                                       std::to_string(s.surface.position.size()));
        }
        check_vector(s.surface.position[i], kLargestLength, where, "a position of its surface");
      }
  }
  void operator()(const MeshSolid& s) const {
    if (!s.field) throw Error(ErrorCode::invalid_argument, where + ": has no field; see make_distance_field");
    check_field(*s.field, where, known);
  }
};

/// Points of finer grids would have more neighbours than are listed.
void check_points(const ClothDesc& cloth, float distance, const std::string& where) {
  constexpr float kMostSpacings = 3;
  check_distance(distance, where);
  const float most = kMostSpacings * cloth.asset->spacing * cloth.transform.scale;
  if (distance <= most) return;
  throw Error(ErrorCode::invalid_argument,
              where + ": distance is " + std::to_string(distance) + " m; it must be at most " + std::to_string(most) +
                  " m, three times the spacing: convert with a wider one, or leave it out");
}

/// The seeds' parameters: not set when negative, else 0..1.
void check_share(double value, const std::string& where, const char* field) {
  if (!(value < 0 && std::isfinite(value))) check_at_least(value, 0, where, field, 1);
}

}  // namespace

void check_position(const Vec3& position, const std::string& where) {
  check_vector(position, kLargestLength, where, "a position");
}

void check_velocity(const Vec3& velocity, const std::string& where) {
  check_vector(velocity, kFastest, where, "a velocity");
}

bool is_position(const Vec3& position) {
  return is_within(position, kLargestLength);
}

bool is_velocity(const Vec3& velocity) {
  return is_within(velocity, kFastest);
}

void check_cut(const std::array<Vec3, 3>& triangle, const std::string& where) {
  constexpr double kThinnest = 1e-6;  // height over the longest side
  for (const Vec3& corner : triangle) check_vector(corner, kLargestLength, where, "a corner of the triangle");
  double longest = 0;
  for (size_t i = 0; i < 3; ++i) {
    longest = std::max(longest, static_cast<double>(length(triangle[(i + 1) % 3] - triangle[i])));
  }
  const Vec3 u = triangle[1] - triangle[0], v = triangle[2] - triangle[0];
  const double height = longest > 0 ? static_cast<double>(length(cross(u, v))) / longest : 0;
  if (height > kThinnest * longest) return;
  throw Error(ErrorCode::invalid_argument,
              where + ": the triangle has no area; give three corners that do not lie on one line");
}

void check_pin_hold(double frequency, double max_distance, const std::string& where) {
  check_at_least(frequency, 0, where, "frequency", 1e4);
  check_at_least(max_distance, 0, where, "max_distance", kLargestPinDistance);
}

void check_backstop(const Backstop& backstop, bool held, const std::string& where) {
  constexpr float kUnit = 1e-3F;
  if (held)
    throw Error(ErrorCode::invalid_argument, where +
                                                 ": a backstop is for points that are not held; give it a "
                                                 "max_distance");
  if (!(std::abs(length(backstop.outward) - 1) <= kUnit))
    throw Error(ErrorCode::invalid_argument, where + ": the normal of its backstop must have the length 1");
  check_at_least(backstop.distance, 0, where, "the distance of its backstop", kLargestBackstop);
  check_above(backstop.radius, 0, where, "the radius of its backstop", kLargestBackstop);
}

void check_tear(double stretch, const std::string& where) {
  check_above(stretch, 1, where, "the stretch that it tears at", 1e6);
}

void check_pressure(float pressure, const std::string& where) {
  if (std::abs(pressure) <= kLargestPressure) return;
  refuse(where, "pressure", pressure,
         "between " + number(-kLargestPressure) + " and " + number(kLargestPressure) + " Pa");
}

void check_gravity_scale(float scale, const std::string& where) {
  constexpr float kLargest = 100;
  if (!(std::abs(scale) <= kLargest)) refuse(where, "gravity_scale", scale, "between -100 and 100");
}

void check_wind_scale(float scale, const std::string& where) {
  constexpr float kLargest = 100;
  if (!(scale >= 0 && scale <= kLargest)) refuse(where, "wind_scale", scale, "between 0 and 100");
}

void check_sewing(float share, const std::string& where) {
  constexpr float kLargest = 1e6F;
  if (!(share >= 0 && share <= kLargest)) refuse(where, "share of a seam's gap", share, "between 0 and 1e6");
}

void check_gravity(const Vec3& gravity, const std::string& where) {
  check_vector(gravity, 1e4F, where, "gravity");
}

void check(const SolverSettings& s) {
  const std::string where = "settings";
  check_at_least(s.threads, 1, where, "threads", 1024);
  check_above(s.frame_time, 0, where, "frame_time", 10);
  check_at_least(s.substeps, 1, where, "substeps", kMostSubsteps);
  if (!(s.frame_time / s.substeps >= kShortestStep)) {
    refuse(where, "a substep, frame_time / substeps,", s.frame_time / s.substeps,
           "at least " + number(kShortestStep) + " s");
  }
  check_at_least(s.relaxation_steps, 1, where, "relaxation_steps", 256);
  check_gravity(s.gravity, where);
  check_at_least(s.imperfection, 0, where, "imperfection", 0.01);
  check_at_least(s.sleep_speed, 0, where, "sleep_speed", 1e4);
  check_at_least(s.sleep_time, 0, where, "sleep_time", 1e6);
}

void check(const Material& m, const std::string& where) {
  check_at_least(m.areal_density, kLightest, where, "areal_density", 1e4);
  check_at_least(m.stretch_warp, kSoftest, where, "stretch_warp", 1e12);
  check_at_least(m.stretch_weft, kSoftest, where, "stretch_weft", 1e12);
  check_none_or(m.shear, kSoftest, where, "shear", 1e12);
  check_none_or(m.bend_warp, kLimpest, where, "bend_warp", 1e6);
  check_none_or(m.bend_weft, kLimpest, where, "bend_weft", 1e6);
  if (!(m.bend_bias < 0 && std::isfinite(m.bend_bias))) check_none_or(m.bend_bias, kLimpest, where, "bend_bias", 1e6);
  check_at_least(m.damping, 0, where, "damping");
  check_at_least(m.thickness, 0, where, "thickness", 1);
  check_at_least(m.friction, 0, where, "friction", 1e3);
  check_at_least(m.max_speed, 0, where, "max_speed");
  if (!(m.max_stretch < 0 && std::isfinite(m.max_stretch))) check_at_least(m.max_stretch, 0, where, "max_stretch");
  check_share(m.stiffness, where, "stiffness");
  check_share(m.bend_stiffness, where, "bend_stiffness");
  check_share(m.verlet_damping, where, "verlet_damping");
}

void check_fabrics(const Material& material, std::span<const Fabric> fabrics, const std::string& where) {
  const auto in_physical_units = [](const Material& m, const std::string& whose) {
    if (m.stiffness >= 0 || m.bend_stiffness >= 0)
      throw Error(ErrorCode::invalid_argument, whose +
                                                   ": a cloth of several fabrics needs materials in physical units; "
                                                   "leave out stiffness and bend_stiffness");
  };
  if (!fabrics.empty()) in_physical_units(material, where + ": material");
  for (size_t f = 0; f < fabrics.size(); ++f) {
    const std::string whose = where + ": fabric " + std::to_string(f);
    check(fabrics[f].material, whose);
    in_physical_units(fabrics[f].material, whose);
  }
}

void check_fabrics(const ClothDesc& cloth, const std::string& where) {
  if (cloth.fabrics.size() > kMostFabrics) {
    throw Error(ErrorCode::limit, where + ": has " + std::to_string(cloth.fabrics.size()) + " fabrics; there can be " +
                                      std::to_string(kMostFabrics));
  }
  check_fabrics(cloth.material, cloth.fabrics, where);
  for (size_t f = 0; f < cloth.fabrics.size(); ++f) {
    for (const uint32_t p : cloth.fabrics[f].pixels) {
      if (p < cloth.asset->pixel_count() && cloth.asset->valid(p)) continue;
      throw Error(ErrorCode::invalid_argument, where + ": fabric " + std::to_string(f) + ": pixel " +
                                                   std::to_string(p) + " is not one of the cloth's");
    }
  }
}

void check(const ClothDesc& cloth, const std::string& where) {
  if (!cloth.asset) throw Error(ErrorCode::invalid_argument, where + ": asset is null");
  validate(*cloth.asset);
  check(cloth.material, where + ": material");
  check_fabrics(cloth, where);
  check(cloth.transform, where + ": transform");
  if (cloth.self_collision) check_points(cloth, cloth.self_collision->distance, where + ": self_collision");
  if (cloth.inter_collision) check_points(cloth, cloth.inter_collision->distance, where + ": inter_collision");
  for (uint32_t p = 0; p < cloth.asset->pixel_count(); ++p) {
    if (!cloth.asset->valid(p)) continue;
    const Vec3 place = apply(cloth.transform, cloth.asset->rest_position[p]);
    if (!is_position(place)) check_position(place, where + ": pixel " + std::to_string(p));
  }
}

void check(const Transform& t, const std::string& where) {
  check_vector(t.translate, kLargestLength, where, "translate");
  check_rotation(t.rotate, where);
  check_at_least(t.scale, kSmallestScale, where, "scale", 1e6);
}

void check_distance(float distance, const std::string& where) {
  if (!(distance < 0 && std::isfinite(distance))) check_above(distance, 0, where, "distance", kLargestLength);
}

void check_parent(const Transform& pose, const Vec3& inertia_scale, const std::string& where) {
  check(pose, where);
  if (pose.scale != 1.F) refuse(where, "scale", pose.scale, "1");
  for (const float s : {inertia_scale.x, inertia_scale.y, inertia_scale.z}) {
    check_at_least(s, 0, where, "inertia_scale", 1);
  }
}

void check(const Plane& p, const std::string& where) {
  check_vector(p.point, kLargestLength, where, "point");
  const double n = length(p.normal);
  if (!(std::abs(n - 1) < 1e-3)) refuse(where, "the length of normal", n, "1");
}

void check(const Collider& c, const std::string& where, bool known) {
  const std::string name = where + (c.name.empty() ? "" : " \"" + c.name + "\"");
  std::visit(ShapeCheck{name, known}, c.shape);
  check_at_least(c.friction, 0, name, "friction", 1e3);
  check_vector(c.pose.translate, kLargestLength, name, "pose.translate");
  check_rotation(c.pose.rotate, name);
  if (c.pose.scale != 1.F) refuse(name, "pose.scale", c.pose.scale, "1: give the shape another size");
}

void check(const Wind& w, const std::string& where) {
  check_vector(w.velocity, 1e4F, where, "velocity");
  check_at_least(w.turbulence, 0, where, "turbulence", 1e3);
  check_above(w.frequency, 0, where, "frequency", 1e4);
  check_at_least(w.drag, 0, where, "drag", 1e4);
  check_at_least(w.lift, 0, where, "lift", 1e4);
}

}  // namespace geocloth
