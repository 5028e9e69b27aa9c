// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace geocloth {

/// The passes of a frame. Both backends walk the schedules below; each pass is one function of the cpu backend and one
/// shader in shaders/cloth/, and its name is the name in timings and debug labels.
enum class Pass : uint8_t {
  normals,          ///< per pixel: area-weighted normal of its own cells, made a unit, length in w
  normals_stitch,   ///< per split row: sum over the copies, made a unit, written to every copy
  rescale,          ///< per pixel, in the first substep: the last displacement becomes one of the new step's length
  predict,          ///< per pixel: Verlet with damping, gravity and air; previous = position
  pins,             ///< per pin: one step towards the target
  structural,       ///< per spring, groups 0..3
  shear,            ///< per spring, groups 4..7
  bending,          ///< per spring, groups 8..11
  seam_bends,       ///< per seam bend, one group for each colour
  curvature,        ///< per bend over three pixels in a row, groups 0..5 of lib/bend_groups.h
  seam_curvature,   ///< per seam bend, one group for each colour
  seam_spans,       ///< per span over a seam or tie on one, one group for each colour after those of the bends
  spans,            ///< per span of lib/span.h, groups 0..7, only with max_stretch and colliders
  sew,              ///< per sewing thread, one group for each colour, those of the list over seams that come last
  stitch,           ///< per split row: mass-weighted mean of the copies, written to every copy
  settle,           ///< per pixel: base and offset become the position, only with ClothParams::fine
  limit,            ///< per pixel: long-range attachment; copies are equal before it and so they are after it
  self_drift,       ///< per point of lib/self_words.h: how far it went since neighbours were looked up
  self_clear,       ///< per bucket of the hash: emptied; this and the next two only when points went too far
  self_insert,      ///< per point: into its bucket
  self_find,        ///< per point: lists its neighbours
  self_push,        ///< per point: what its neighbours do to it
  self_move,        ///< per pixel: moves it and its velocity, with friction
  inter_gather,     ///< between cloths, per point: to where the others see it
  inter_drift,      ///< as self_drift, over the points of all cloths that collide with each other
  inter_clear,      ///< as self_clear, and so on
  inter_insert,     ///< as self_insert
  inter_find,       ///< as self_find
  inter_push,       ///< as self_push
  inter_move,       ///< per pixel with a point: as self_move
  collide_cells,    ///< per cell, groups 0..3: triangles that a collider may slip through
  stitch_contacts,  ///< per split row, after it: as stitch, of the copies' velocities too
  collide,          ///< per pixel: largest speed, then colliders with friction; writes position and previous
  hold_way,         ///< per pixel, at a frame's end: its way is put aside, for lib/finish.h
  lines,            ///< per row (group 0) or column (group 1): runs of structural springs at once, lib/lines.h
  ties,             ///< per structural spring, groups 0..3: pulled to its longest length; relaxation 1: by kTieShare
  whole_ties,       ///< per spring at a seam, by colour after seam_spans; as ties
  give_way,         ///< per pixel: out of colliders, and the way that was put aside
  check_copies,     ///< per split row: largest distance between copies
  check_colliders,  ///< per pixel: largest depth in a collider
  measure_motion    ///< per pixel: longest way in the last substep, into the word of its group
};

struct PassInfo {
  Pass pass;
  std::string_view name;
  std::string_view shader;  ///< file in shaders/cloth/
};
inline constexpr std::array<PassInfo, 41> kPasses{{
    {Pass::normals, "normals", "normals.comp"},
    {Pass::normals_stitch, "normals_stitch", "normals_stitch.comp"},
    {Pass::rescale, "rescale", "rescale.comp"},
    {Pass::predict, "predict", "predict.comp"},
    {Pass::pins, "pins", "pins.comp"},
    {Pass::structural, "structural", "springs.comp"},
    {Pass::shear, "shear", "springs.comp"},
    {Pass::bending, "bending", "springs.comp"},
    {Pass::seam_bends, "seam_bends", "seam_bends.comp"},
    {Pass::curvature, "curvature", "curvature.comp"},
    {Pass::seam_curvature, "seam_curvature", "seam_curvature.comp"},
    {Pass::seam_spans, "seam_spans", "seam_spans.comp"},
    {Pass::spans, "spans", "spans.comp"},
    {Pass::sew, "sew", "sew.comp"},
    {Pass::stitch, "stitch", "stitch.comp"},
    {Pass::settle, "settle", "settle.comp"},
    {Pass::limit, "limit", "limit.comp"},
    {Pass::self_drift, "self_drift", "self_drift.comp"},
    {Pass::self_clear, "self_clear", "self_clear.comp"},
    {Pass::self_insert, "self_insert", "self_insert.comp"},
    {Pass::self_find, "self_find", "self_find.comp"},
    {Pass::self_push, "self_push", "self_push.comp"},
    {Pass::self_move, "self_move", "self_move.comp"},
    {Pass::inter_gather, "inter_gather", "inter_gather.comp"},
    {Pass::inter_drift, "inter_drift", "self_drift.comp"},
    {Pass::inter_clear, "inter_clear", "self_clear.comp"},
    {Pass::inter_insert, "inter_insert", "self_insert.comp"},
    {Pass::inter_find, "inter_find", "self_find.comp"},
    {Pass::inter_push, "inter_push", "self_push.comp"},
    {Pass::inter_move, "inter_move", "inter_move.comp"},
    {Pass::collide_cells, "collide_cells", "collide_cells.comp"},
    {Pass::stitch_contacts, "stitch_contacts", "stitch_contacts.comp"},
    {Pass::collide, "collide", "collide.comp"},
    {Pass::hold_way, "hold_way", "hold_way.comp"},
    {Pass::lines, "lines", "lines.comp"},
    {Pass::ties, "ties", "ties.comp"},
    {Pass::whole_ties, "whole_ties", "whole_ties.comp"},
    {Pass::give_way, "give_way", "give_way.comp"},
    {Pass::check_copies, "check_copies", "check_copies.comp"},
    {Pass::check_colliders, "check_colliders", "check_colliders.comp"},
    {Pass::measure_motion, "measure_motion", "measure_motion.comp"},
}};
[[nodiscard]] constexpr const PassInfo& info(Pass pass) {
  return kPasses[static_cast<size_t>(pass)];
}

/// Passes over a colour of the list over seams.
[[nodiscard]] constexpr bool is_over_seams(Pass pass) {
  return pass == Pass::seam_bends || pass == Pass::seam_curvature || pass == Pass::seam_spans ||
         pass == Pass::whole_ties || pass == Pass::sew;
}

/// In which order the three groups of curvatures along a line are projected. Each of them moves three points, so what a
/// sweep of the groups leaves of an error turns in the plane of complex numbers, and a stiff cloth that goes on as it
/// moved gains energy from it; there and back again the groups are a symmetric operator, whose shares are real and
/// between 0 and 1, and it cannot.
enum class BendOrder : uint8_t {
  forward,
  backward,        ///< in the second half of a few relaxation steps
  there_and_back,  ///< the first and the second group twice, each time with twice the compliance
};

/// One entry of a schedule: a pass over all of a cloth, or one group of springs of it.
struct PassStep {
  Pass pass;
  uint32_t group = 0;       ///< spring group 0..11, group 0..5 of the curvatures, or a colour of the list over seams
  uint32_t relaxation = 0;  ///< 0..relaxation_steps - 1
  BendOrder order = BendOrder::forward;  ///< of the curvatures
  bool again = false;                    ///< a group's second time, on the way back

  friend bool operator==(const PassStep&, const PassStep&) = default;
};

/// Of a group of curvatures: so many times its compliance.
[[nodiscard]] constexpr uint32_t compliance_times(const PassStep& step) {
  return step.order == BendOrder::there_and_back && step.group % 3 != 2 ? 2 : 1;
}

/// Those of a cloth that collides with itself.
[[nodiscard]] constexpr bool is_of_self_collision(Pass pass) {
  return pass >= Pass::self_drift && pass <= Pass::self_move;
}

/// Passes over the points of all cloths that collide with each other, once for all of them.
[[nodiscard]] constexpr bool is_between_cloths(Pass pass) {
  return pass >= Pass::inter_drift && pass <= Pass::inter_push;
}

/// How the cloth resists bending.
enum class Bending : uint8_t {
  none,
  springs,   ///< the seeds' way, over two pixels: passes bending and seam_bends
  curvature  ///< with a rigidity: passes curvature and seam_curvature
};

/// What a schedule depends on besides the pass list. Passes that would do nothing are left out.
struct ScheduleOptions {
  uint32_t substeps = 1;  ///< of the frame
  uint32_t relaxation_steps = 1;
  bool rescale = false;  ///< the step's length differs from the last frame's
  bool air = false;      ///< wind or drag acts: normals are needed in every substep
  bool pins = false;     ///< the cloth has pins in this frame
  bool splits = false;   ///< the split-vertex table has rows
  Bending bending = Bending::none;
  bool stiff_bends = false;  ///< stiffer than one sweep of them can be
  bool fine = false;         ///< constraints act on offsets
  bool attachments = false;  ///< max_stretch > 0 and pins
  /// max_stretch > 0 and colliders: attachments pull too late around them. Or pins that squeezed springs hang from,
  /// that lie one above the other or that it sags between, or in wind.
  bool spans = false;
  /// Like the spans, and where uneven springs hang from pins; but not on offsets, not where a collider is fast, not
  /// between pins that are pulled apart, and not for cloth that is to fall asleep: what ties pull together sinks back
  /// at a centimetre a second.
  bool ties = false;  ///< and lines
  bool self_collision = false;
  bool inter_collision = false;  ///< the cloth collides with others
  bool collide = false;          ///< colliders, or max_speed > 0
  uint32_t cell_rounds = 0;      ///< over the cells, where a collider is so thin that it may slip through
  bool check = false;            ///< measure copies and colliders after every substep
  bool asleep = false;           ///< the frame has no passes
  bool motion = false;           ///< how far points go is measured after the last substep
  uint32_t motion_word = 0;      ///< 0 or 1, for even and odd frames
  uint32_t seam_bend_colors = 0, seam_span_colors = 0, seam_tie_colors = 0, whole_tie_colors = 0;
  /// Of the threads, and of more rounds of some, after the others where they come last; 0 while none of them hold.
  uint32_t sewing_colors = 0, more_sewing_colors = 0;
  uint32_t sewn_bend_colors = 0;  ///< behind these, while what is sewn is closed

  bool operator==(const ScheduleOptions&) const = default;
};

/// Those that the passes of substeps and of a frame's end follow from: what comes after them, or in no frame at all,
/// changes from frame to frame.
[[nodiscard]] inline ScheduleOptions options_of_substeps(ScheduleOptions options) {
  options.asleep = options.motion = false;
  options.motion_word = 0;
  return options;
}

/// The passes of one substep in their order:
///   [rescale] [normals] predict pins { shear, [sew], stitch, bends over seams, [spans over seams, spans], bending or
///   curvature, structural, [sew], stitch } x relaxation [settle] limit [self_drift .. self_move]
///   [inter_gather .. inter_move] { collide_cells, stitch_contacts } x rounds, collide [check]
[[nodiscard]] std::vector<PassStep> substep_schedule(const ScheduleOptions& options);

/// Of a substep of a cloth that collides with others those passes that they all do at once: inter_gather of each, those
/// between cloths once, inter_move of each.
[[nodiscard]] std::span<const PassStep> inter_schedule();

/// The passes of one substep before and after those; all of them are before where the cloth collides with no other.
struct SubstepHalves {
  std::vector<PassStep> before, after;
};
[[nodiscard]] SubstepHalves substep_halves(const ScheduleOptions& options);

/// The passes after those of a frame's last substep, which belong to it: hold_way, lines x 2, { [whole_ties], ties,
/// [ties on seams, sew, stitch] } x 3 (where cloth hangs by seams: x 1, lines x 2, x 5), [whole_ties], give_way
/// [check], or none.
[[nodiscard]] std::vector<PassStep> finish_schedule(const ScheduleOptions& options);

/// The passes after all of a frame: normals [measure_motion].
[[nodiscard]] std::vector<PassStep> frame_schedule(const ScheduleOptions& options);

}  // namespace geocloth
