// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geocloth/solver/solver.h"
#include "shared/layout.h"

namespace geocloth {

/// Where in time a frame lies.
struct FrameClock {
  double start = 0;  ///< [s]
  double dt = 0;     ///< [s] of a substep
  uint32_t substeps = 1;
};

/// Where the local frame of a collider's shape (see shared/layout.h) lies in the world.
[[nodiscard]] Transform collider_frame(const Collider& collider);
/// Whether two of them are the same.
[[nodiscard]] bool same_place(const Transform& a, const Transform& b);
/// Of a body, for questions of distance: its numbers are the field's own, and how deep it is stays 0.
[[nodiscard]] shader::ColliderShape grid_of(const DistanceField& field);
/// @param numbers  those of convex hulls and meshes are appended
[[nodiscard]] shader::ColliderShape collider_shape_of(const Collider& collider, std::vector<float>& numbers);

/// Poses of all colliders before the first substep and after each: (substeps + 1) * colliders, relative to the origin.
/// From and to have as many entries; translations go straight, rotations along the shortest arc.
/// @param from   frames of their shapes, see collider_frame()
/// @param deform  [m] how far a point of each one's surface goes at most by which it deforms in the frame, see
///   longest_deformation()
/// @param poses   replaced; its memory is used again
void collider_poses(std::span<const Transform> from, std::span<const Collider> to, std::span<const float> deform,
                    uint32_t substeps, const Vec3& origin, std::vector<shader::ColliderPose>& poses);

/// [m] The longest way of a body's surface in the frame of its field; 0 for what keeps its shape.
[[nodiscard]] float longest_deformation(const Collider& collider);

/// [m] of a ball about the origin of a shape's frame that holds all of it; infinite where none does.
[[nodiscard]] double radius_of(const shader::ColliderShape& shape);

/// [m] Half of what a collider is thick: where it is thinnest, of a body where it is thickest.
[[nodiscard]] float thickness_of(const shader::ColliderShape& shape);

/// Whether a collider is thin enough, or has edges or corners that are, to slip through between pixels. A body is as
/// thick as its thickest part: triangle contact with a body costs ten times what its pixels cost.
/// @param spacing  [m] of the pixels
[[nodiscard]] bool may_slip_through(const shader::ColliderShape& shape, float spacing);

/// Whether one of them opens cells between points, which only a substep's contacts keep apart.
[[nodiscard]] bool may_open_cells(std::span<const shader::ColliderShape> shapes, float spacing);

/// Pin fractions and gusts of every substep.
/// @param inputs  replaced; its memory is used again
void substep_inputs(const FrameClock& clock, const std::optional<Wind>& wind, const Vec3& origin,
                    std::vector<shader::Substep>& inputs);

/// How a pin holds its point, see Pin.
struct PinHold {
  float frequency = 0, max_distance = 0;  ///< [1/s], [m]
  bool operator==(const PinHold&) const = default;
};
/// A ball that a pinned point stays out of; see Backstop.
struct BackBall {
  Vec3 from, to;     ///< [m] from the target to its middle at the start and at the end of the frame
  float radius = 0;  ///< [m] 0: none
  bool operator==(const BackBall&) const = default;
};
/// By how much the way of a pin's target is off its chord; see lib/pin.h.
struct PinBow {
  Vec3 middle, lean;  ///< [m]
  bool bows = false;
};
/// @param from, to  where the target is at the start and at the end of the frame, relative to the origin
[[nodiscard]] shader::PinTarget pin_target(uint32_t pixel, const Vec3& from, const Vec3& to, const PinHold& hold,
                                           const BackBall& back, const PinBow& bow, double dt);

/// The motion from one pose to another in steps that are this share of it: displacement field of lib/frame.h, by steps.
[[nodiscard]] shader::FrameField motion_field(const Transform& from, const Transform& to, float share,
                                              const Vec3& origin);

/// How a cloth's parent that turns gets from one pose to the next: evenly about a centre that goes straight. What is
/// far from the centre goes on an arc, so it is where the cloth is, whatever the poses count from; pins that turn with
/// the parent go on the same arcs, else they would pull to and fro at the cloth that is taken along.
class ParentWay {
 public:
  /// @param center  [m, world] that goes straight, at the start
  ParentWay(const Transform& from, const Transform& to, const Vec3& center);
  [[nodiscard]] bool turns() const { return turns_; }
  [[nodiscard]] const Vec3& center() const { return center_; }
  [[nodiscard]] const Vec3& shift() const { return shift_; }  ///< [m] way of the centre
  [[nodiscard]] const Vec3& turn() const { return turn_; }    ///< [rad] axis times angle, in the world
  /// [m] from the parent's place to the centre as it is seen on the mean of the frame: shift() is that of the parent's
  /// place and turn() x arm().
  [[nodiscard]] const Vec3& arm() const { return arm_; }
  /// Of a pin [m, world]; a straight one has none, nor has what does not turn as the parent does.
  [[nodiscard]] PinBow bow_of(const Vec3& from, const Vec3& to) const;

 private:
  Vec3 center_, turn_, shift_, arm_;
  std::array<std::array<std::array<double, 3>, 3>, 4> turned_{};  ///< R - 1 after each quarter of the frame
  bool turns_ = false;
};

/// Motion of a cloth's parent over a frame, as both fields of lib/frame.h; nothing moves between equal poses.
/// @param way            between the two poses
/// @param inertia_scale  per axis of the parent: 1 the cloth feels all of the motion, 0 it is taken along
void set_frame_motion(shader::ClothParams& params, const Transform& from, const Transform& to, const ParentWay& way,
                      const Vec3& inertia_scale, uint32_t substeps, const Vec3& origin);

/// Largest strain of the long-range attachments, 0: none. An automatic one lies above what the weight of the cloth
/// stretches it by at the bottom of a swing on the earth, what the wind draws a flag by and what a pressure [Pa] does,
/// so that only the solver's own softness is cut off.
/// @param reach  [m] of the longest attachment; counts up to 10 m
[[nodiscard]] float largest_stretch(const Material& material, const Vec3& gravity, const std::optional<Wind>& wind,
                                    float pressure, float reach);

/// How gravity strays, as of lib/predict.h; p.dt is there.
/// @param share   of gravity
/// @param size    [m] of the cloth
/// @param origin  [m] of its positions
void set_imperfection(float share, const Vec3& gravity, float size, const Vec3& origin, shader::ClothParams& p);

/// The numbers of one material in one frame. width, height and collider_count are left 0.
/// @param wind_scale  see Solver::set_wind_scale
/// @param pressure    [Pa] see Solver::set_pressure
[[nodiscard]] shader::ClothParams cloth_params(const Material& material, const FrameClock& clock, const Vec3& gravity,
                                               const std::optional<Wind>& wind, float wind_scale, float pressure);

}  // namespace geocloth
