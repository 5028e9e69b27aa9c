// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>

#include "geocloth/solver/solver.h"

namespace geocloth {

/// Positions and lengths beyond this [m] are refused: their squares would leave the range of single precision.
inline constexpr float kLargestLength = 1e6F;

inline constexpr float kFastest = 1e6F;  ///< [m/s] along an axis, of what a state is written with

// Of materials; below, inverses, squares and their products would leave single precision.
inline constexpr double kSoftest = 1e-9;   ///< [N/m]
inline constexpr double kLimpest = 1e-12;  ///< [N m]

/// Of a frame.
inline constexpr uint32_t kMostSubsteps = 256;

inline constexpr double kLargestPressure = 1e6;     ///< [Pa] either way
inline constexpr double kLargestPinDistance = 1e4;  ///< [m]
inline constexpr double kLargestBackstop = 100;     ///< [m] of a larger ball single precision has no smooth surface

/// Every field in its documented range. `where` begins the message, e.g. "cloth 2" or "colliders[0] \"ball\"".
/// @throws Error(invalid_argument) naming the field, its value and its range
void check(const SolverSettings& settings);
void check(const Material& material, const std::string& where);
/// Of fabrics that the cloth is made of beside its material.
void check_fabrics(const Material& material, std::span<const Fabric> fabrics, const std::string& where);
/// The same, and their pixels.
void check_fabrics(const ClothDesc& cloth, const std::string& where);
void check(const Transform& transform, const std::string& where);
/// All of it, its asset too.
/// @throws Error(invalid_data) for an asset that validate() refuses, Error(limit) for too many fabrics
void check(const ClothDesc& cloth, const std::string& where);
/// @param known  half a million distances of its field are not looked at, only how many there are
void check(const Collider& collider, const std::string& where, bool known = false);
void check(const Plane& plane, const std::string& where);
void check(const Wind& wind, const std::string& where);
/// [m] between points; below 0: the default.
void check_distance(float distance, const std::string& where);
void check_parent(const Transform& pose, const Vec3& inertia_scale, const std::string& where);
void check_pin_hold(double frequency, double max_distance, const std::string& where);
/// @param held  whether its point is
void check_backstop(const Backstop& backstop, bool held, const std::string& where);
/// Of springs that tear.
void check_tear(double stretch, const std::string& where);
void check_pressure(float pressure, const std::string& where);
void check_gravity_scale(float scale, const std::string& where);
void check_wind_scale(float scale, const std::string& where);
void check_sewing(float share, const std::string& where);
void check_gravity(const Vec3& gravity, const std::string& where);
void check_position(const Vec3& position, const std::string& where);
void check_velocity(const Vec3& velocity, const std::string& where);
// Whether they would pass: who has many of them writes where one is only once it is refused.
[[nodiscard]] bool is_position(const Vec3& position);
[[nodiscard]] bool is_velocity(const Vec3& velocity);
/// Three corners in range that span an area.
void check_cut(const std::array<Vec3, 3>& triangle, const std::string& where);

}  // namespace geocloth
