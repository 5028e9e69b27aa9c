// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "colliders/reach.h"
#include "geocloth/solver/solver.h"
#include "lib/contact_sum.h"
#include "lib/self_words.h"
#include "pass.h"
#include "shared/layout.h"

namespace geocloth {

/// As in ClothParams.
struct SelfNumbers {
  uint32_t points = 0, buckets = 0;
  float distance = 0, reach = 0;  ///< [m]
  uint32_t most_in_bucket = shader::kSelfMostInBucket;
};

/// What self-collision needs of a cloth; empty without it.
struct SelfData {
  SelfNumbers numbers;
  std::vector<shader::SelfPoint> points;
  std::vector<uint32_t> words;             ///< as lib/self_words.h has them, before the first substep
  size_t most_points = 0, most_words = 0;  ///< after any cut

  [[nodiscard]] size_t memory_bytes() const {
    return sizeof(shader::SelfPoint) * points.size() + sizeof(uint32_t) * words.size();
  }
};

/// A cloth that collides with others: where it is among the points of all of them.
struct InterPart {
  uint32_t cloth = 0;
  uint32_t first_point = 0, points = 0;
  uint32_t first_pixel = 0, pixels = 0;  ///< entries of the list in lib/self_words.h
};

/// The cloths that collide with each other; empty without any.
struct InterData {
  SelfData points;  ///< pixels as those of the points are of their cloths
  std::vector<InterPart> parts;
};

/// A cloth is no more: those behind it move up.
void renumber_parts(std::vector<InterPart>& parts, uint32_t removed);

/// How structural springs differ in length. Where cloth hangs by pins, short ones stretch most: they join points of
/// little mass, and a step takes away what it takes per mass.
enum class Evenness : uint8_t {
  even,
  uneven,    ///< the longest by more than a fifth from the shortest, as at the outlines of panels
  squeezed,  ///< many are much shorter than the others, as in squares
};

/// All that a backend needs to know of one cloth, built once by upload.cpp; layout as in shared/layout.h.
struct ClothData {
  uint32_t width = 0, height = 0;
  [[nodiscard]] uint32_t pixel_count() const { return width * height; }

  std::vector<shader::vec4> position;                ///< start; w = inverse mass without pins, 0 where not valid
  std::array<std::vector<shader::vec4>, 3> springs;  ///< structural, shear, bending
  std::vector<uint32_t> cell;
  std::vector<shader::SeamSpring> seam_springs;  ///< over seams, by colour: bends, spans, ties, whole ties,
                                                 ///< threads, bends over what is sewn
  size_t most_seam_springs = 0;                  ///< after any cut: one may make room for some that are left out
  std::vector<uint32_t> seam_color_offset;       ///< colours + 1 entries; empty without any
  uint32_t seam_bend_colors = 0, seam_span_colors = 0, seam_tie_colors = 0, whole_tie_colors = 0, sewing_colors = 0,
           more_sewing_colors = 0, sewn_bend_colors = 0;
  std::vector<uint32_t> split_offset;  ///< rows + 1 entries; empty without rows
  std::vector<uint32_t> split_pixel;
  SelfData self;
  Bending bending = Bending::none;
  /// [s^2] Of the median curvature: its compliance by what its three points have for an inverse mass together.
  float bend_yield = std::numeric_limits<float>::max();
  bool attachments = false;      ///< max_stretch > 0
  bool may_meet_others = false;  ///< it collides with other cloths, if there are some
  Evenness evenness = Evenness::even;
  bool short_seams = false;        ///< parts of it hang on few springs
  uint64_t springs_per_sweep = 0;  ///< springs and seam bends that one relaxation step projects

  [[nodiscard]] uint32_t split_rows() const {
    return split_offset.empty() ? 0 : static_cast<uint32_t>(split_offset.size() - 1);
  }
};

/// What one collider did to a cloth in a frame, see lib/contact_sum.h: impulse and moment, by
/// ClothParams::contact_scale.
using ContactSum = std::array<int64_t, shader::kContactValues>;

/// What looking up near points has left for the substeps to come.
struct FoundPoints {
  uint32_t age = 0;             ///< as in lib/self_words.h; 0: nothing
  std::vector<uint32_t> words;  ///< see found_words() of rest/self_points.h
};

/// All of a cloth that its next frame follows from, besides what that is told.
struct ClothMemory {
  std::vector<shader::vec4> position, previous, carry;  ///< one per pixel
  std::vector<shader::vec4> offset;                     ///< the same with SimulationData::fine, else empty
  FoundPoints found;                                    ///< with self-collision
  std::array<float, 2> longest_way{};                   ///< [m] by word
  std::array<uint32_t, 2> left_behind{};                ///< points, by word
};

struct SimulationData {
  std::vector<ClothData> cloths;
  InterData inter;
  uint32_t relaxation_steps = 1;
  bool fine = false;            ///< ClothParams::fine is not kFineOff, in every frame
  bool check = false;           ///< measure after every substep
  bool timings = false;         ///< measure every pass
  bool contact_forces = false;  ///< sum what colliders do to cloth
  SolverPath path = SolverPath::automatic;
};

/// One cloth in one frame.
struct ClothFrame {
  shader::ClothParams params;
  std::vector<shader::PinTarget> pins;  ///< ascending by pixel, all copies listed

  uint32_t cell_rounds = 0;   ///< see ScheduleOptions
  bool asleep = false;        ///< nothing is done: everything stays as it is
  bool sewn = false;          ///< sewing threads hold
  bool seams_closed = false;  ///< and have drawn seams together
  bool held_open = false;     ///< a fast collider may open cells, which ties at the frame's end would draw over it
  bool restless = false;      ///< ties at the frame's end move it for ever, though nothing disturbs it
  bool pulled_apart = false;  ///< two of its pins are farther from each other than the cloth may stretch
  bool slack_pins = false;    ///< attachments to its pins are slack: they lie one above the other, as a flag's on its
                              ///< pole, or the cloth sags between them, or few springs carry it

  /// The set of pinned pixels differs from the last frame's, or masses do: inverse_mass, and attachments unless they
  /// are empty, replace what the backend holds, before the first substep. Positions stay.
  bool pins_changed = false;
  std::vector<float> inverse_mass;              ///< one per pixel
  std::vector<shader::Attachment> attachments;  ///< one per pixel; empty where there are none, or as they were
};

/// One frame. Poses and waves are already evaluated for every substep.
struct FrameInput {
  /// All colliders, and after them again those that a cloth meets which does not meet all: see
  /// ClothParams::first_shape.
  std::vector<shader::ColliderShape> shapes;
  /// (substeps + 1) * colliders: pose s is before substep s, s + 1 after it; then those of the other lists as well.
  std::vector<shader::ColliderPose> poses;
  std::shared_ptr<const std::vector<float>>
      collider_numbers;  ///< see shader::ColliderShape; another one when it changes
  std::vector<shader::Substep> substeps;
  std::vector<ClothFrame> cloths;
  bool deforms = false;         ///< a collider does, see shader::ColliderPose::deform
  bool may_sleep = false;       ///< cloth that comes to rest: no pass at the frame's end may go on moving it
  bool measure_motion = false;  ///< for longest_way()
  uint32_t motion_word = 0;     ///< 0 or 1 by turns
};

/// The colliders that a cloth meets in a frame.
struct MetColliders {
  MetColliders(const FrameInput& frame, const shader::ClothParams& params)
      : shapes(std::span(frame.shapes).subspan(params.first_shape, params.collider_count)),
        poses(std::span(frame.poses)
                  .subspan(params.first_pose, (frame.substeps.size() + 1) * size_t{params.collider_count})) {}

  std::span<const shader::ColliderShape> shapes;
  std::span<const shader::ColliderPose> poses;  ///< (substeps + 1) * shapes
};

/// About all points of a cloth.
struct Whereabouts {
  ClothBox box;   ///< [m]
  float way = 0;  ///< [m] that one of them went in the last substep, at most
};

/// What differs between the ways to run the passes. Positions are relative to the solver's origin everywhere.
class SolverBackend {
 public:
  SolverBackend() = default;
  SolverBackend(const SolverBackend&) = delete;
  SolverBackend& operator=(const SolverBackend&) = delete;
  virtual ~SolverBackend() = default;

  /// Runs all substeps of a frame and its normals, for the cloths that are not asleep; for others, which need another
  /// number of substeps, it may be called again in the same frame. May return before the work is done.
  virtual void run_frame(const FrameInput& frame) = 0;
  /// Blocks until everything submitted is done. @throws Error(device) if the device failed
  virtual void wait() = 0;

  /// These wait. One vec4 per pixel; the meaning of w is that of shared/layout.h.
  virtual void read_positions(uint32_t cloth, std::vector<shader::vec4>& out) = 0;
  virtual void read_previous(uint32_t cloth, std::vector<shader::vec4>& out) = 0;
  /// What position - previous lacks to the displacement of the last substep.
  virtual void read_carry(uint32_t cloth, std::vector<shader::vec4>& out) = 0;
  virtual void read_normals(uint32_t cloth, std::vector<shader::vec4>& out) = 0;
  /// Replaces positions (w included), previous positions; clears carry and offsets; recomputes the normals.
  virtual void write_state(uint32_t cloth, std::span<const shader::vec4> position,
                           std::span<const shader::vec4> previous) = 0;

  /// Where a cloth is between two frames; nothing where that is not known without waiting for the device.
  [[nodiscard]] virtual std::optional<Whereabouts> whereabouts(uint32_t cloth) const = 0;

  /// These wait. What was read brings back the same bits in the frames to come, also on another backend.
  virtual void read_memory(uint32_t cloth, ClothMemory& out) = 0;
  /// Recomputes the normals, too.
  /// @param pins  pins, inverse_mass and attachments as ClothFrame has them when the pins have changed
  virtual void write_memory(uint32_t cloth, const ClothMemory& memory, const ClothFrame& pins) = 0;
  /// Of the points of all cloths that collide with each other, which there must be.
  virtual void read_found(FoundPoints& out) = 0;
  virtual void write_found(const FoundPoints& found) = 0;

  /// Subtracts whole metres from all positions and previous positions of all cloths; waits.
  virtual void shift(const Vec3& by) = 0;

  /// Adds a cloth behind the others; waits.
  virtual void add_cloth(ClothData data) = 0;
  /// Those behind it move up; waits. replace_inter() has to follow if it is one of the cloths that collide with each
  /// other.
  virtual void remove_cloth(uint32_t cloth) = 0;

  /// Replaces springs, cells, bends over seams and the split-vertex table by those of the same cloth after a cut, or
  /// before one, or of another material; waits. Positions stay, and masses until pins change.
  virtual void replace_topology(uint32_t cloth, ClothData data) = 0;
  /// Replaces the points of the cloths that collide with each other after a cut of one, by those before one, or where
  /// they are other cloths, if any; waits.
  virtual void replace_inter(InterData inter) = 0;

  /// [m] the longest way of a point of a cloth in the last substep of the frame before the last one, which had measured
  /// into this word. Waits for that frame, as the next run_frame() does anyway.
  virtual float longest_way(uint32_t cloth, uint32_t word) = 0;
  /// Points of a cloth that are not pinned and went far beside ClothParams::carrier in that frame.
  virtual uint32_t left_behind(uint32_t cloth, uint32_t word) = 0;

  /// What the colliders did to a cloth in the last frame in which it was not asleep, in the order in which it met them;
  /// only with SimulationData::contact_forces. Waits.
  virtual void read_contacts(uint32_t cloth, std::vector<ContactSum>& out) = 0;

  /// Fills backend, device, path, threads, passes, copy_gap and penetration; waits.
  virtual void fill_statistics(SolverStatistics& statistics) = 0;
};

/// The schedule of one cloth in one frame.
[[nodiscard]] ScheduleOptions schedule_options(const SimulationData& data, uint32_t cloth, const FrameInput& frame);

/// Plain C++ over threads; the result does not depend on their number.
[[nodiscard]] std::unique_ptr<SolverBackend> make_cpu_backend(SimulationData data, uint32_t threads);
/// @param device  part of a device's name; empty: the best one, a software device only when there is no other
/// @throws Error(device) when no device fits, with the reason for each
[[nodiscard]] std::unique_ptr<SolverBackend> make_vulkan_backend(SimulationData data, const std::string& device);

}  // namespace geocloth
