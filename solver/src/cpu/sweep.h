// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cpu/cloth_state.h"
#include "cpu/passes.h"
#include "lib/span.h"

namespace geocloth::cpu {

/// What a pass does with one row of the image. "Down" and "across" name the row's springs: across rows they lead to a
/// row below and are next to each other, along a row their ends are.
enum class RowKernel : uint8_t {
  normals,            ///< runs
  predict,            ///< runs of whole vectors
  pins,               ///< runs of a vector at most
  springs_across,     ///< blocks: rest, inverse, compliance
  springs_along,      ///< two halves over every second column and its neighbour: rest, inverse, compliance
  ties_across,        ///< as springs_across, pulling only, also spans over rows: longest, inverse
  ties_along,         ///< as springs_along, pulling only: longest, inverse
  springs_along_two,  ///< two halves over two of four columns and the next two: rest, inverse, compliance
  bends_across,       ///< blocks: rest, inverse, chord, compliance
  bends_along,        ///< all three groups; blocks over every third column, from places in the scratch on: rest,
                      ///< inverse, chord, compliance
  spans_along,        ///< as ties_across, blocks of kSpanLanes at most
  short_spans_along,  ///< as ties_across, blocks of kShortSpanLanes at most
  settle,             ///< runs of whole vectors
  limit,              ///< blocks: longest; anchors
  collide,            ///< runs of whole vectors
  hold_way,           ///< runs of whole vectors
  give_way,           ///< runs of whole vectors
  check_colliders     ///< runs of whole vectors
};

/// Springs over so many pixels share none when no more of them than that lie next to each other.
inline constexpr uint32_t kSpanLanes = shader::kSpanPixels, kShortSpanLanes = shader::kShortSpanPixels;

/// Where bends_along takes a row apart to, of lines so many floats long: of each residue modulo 3 three coordinates and
/// the inverse mass, and where bends act on offsets three of the base. Rows of a strip follow each other, and the next
/// strip's take their place.
[[nodiscard]] constexpr uint32_t third_lines(bool on_offsets) {
  return on_offsets ? 21 : 12;
}
[[nodiscard]] inline uint32_t third_row(uint32_t y, uint32_t strip, uint32_t line, bool on_offsets) {
  return y % strip * third_lines(on_offsets) * line;
}

/// Neighbouring pixels, first <= i < last.
struct Run {
  uint32_t first, last;

  friend bool operator==(const Run&, const Run&) = default;
};

/// What a kernel works through, row by row. A block is as many constraints as a vector has lanes, from a pixel on; its
/// constants lie in the order of the lanes, so that nothing is gathered. Lanes without a constraint have the inverse 0.
/// Compliances are only there with several relaxation steps.
struct RowStream {
  std::vector<uint32_t> row_first;  ///< height + 1 entries: the row's blocks or runs
  std::vector<uint32_t>
      group_first;              ///< bends_along: for each group as row_first, which counts the blocks of all three
  std::vector<uint32_t> pixel;  ///< first pixel of a block
  std::vector<uint32_t>
      second;  ///< springs along rows: that of its second half, as many pixels wide as a vector; maybe in the next row
  std::vector<uint8_t> beside;  ///< limit: for each row whether each lane's anchor lies beside the lane's before
  Floats constants;
  std::vector<float> multipliers;      ///< of constraints with several relaxation steps, for each lane
  std::vector<uint32_t> first_anchor;  ///< limit: of as many as a block has lanes
  std::vector<int32_t> anchors;        ///< limit: for each lane the one of those that holds it
  std::vector<Run> runs;
  std::vector<uint32_t> third_first;  ///< bends_along: height + 1 entries: the row's runs of thirds
  std::vector<Run> thirds;            ///< those that its bends reach, from a whole number of vectors on

  friend bool operator==(const RowStream&, const RowStream&) = default;
};

/// Columns that lines along rows are turned by at a time.
inline constexpr uint32_t kTurned = 4;
/// Floats for each point and lane in a LineStream, in what goes from one sweep along it to the next, and in what rows
/// are turned to.
inline constexpr uint32_t kLineFloats = 3, kLineKept = 8, kLineTurned = 6;

/// As many rows or columns side by side as a vector has lanes, and of those the points that a spring leads to.
struct LineBlock {
  uint32_t first;    ///< pixel of the first lane's first point
  uint32_t points;   ///< along rows a multiple of kTurned
  uint32_t lines;    ///< along rows: that the image has of a vector's
  size_t constants;  ///< place of the first point's

  friend bool operator==(const LineBlock&, const LineBlock&) = default;
};

/// What line relaxation works through in one direction. Blocks share no point.
struct LineStream {
  std::vector<LineBlock> blocks;
  float diagonal = 1;        ///< line_diagonal() of lib/lines.h
  uint32_t most_points = 0;  ///< of a block
  Floats constants;  ///< of each point: for each lane its weight, 0 where it stays, the square of its spring's longest
                     ///< length or 0, and whether it has a way

  friend bool operator==(const LineStream&, const LineStream&) = default;
};

/// Blocks that run_lines() goes through at a time.
inline constexpr uint32_t kLinesAtOnce = 2;
/// Floats that it needs for each of them.
[[nodiscard]] inline size_t line_kept(const LineStream& stream, uint32_t lanes) {
  return size_t{kLineKept + kLineTurned} * lanes * stream.most_points;
}

/// first <= y < last; none when first is not below last.
struct RowRange {
  uint32_t first, last;
};

/// One pass in a sweep: from the time t to t + n of the sweep it works on the rows t - lag .. t + n - 1 - lag.
struct SweepOp {
  RowKernel kernel;
  Pass pass = Pass::predict;  ///< whose time it is
  uint32_t lag = 0;
  uint32_t up = 0, down = 0;  ///< rows above and below its own that the kernel touches
  bool spills = false;  ///< rows of this pass that touch the same one must not be worked on at the same time: lanes
                        ///< over the end of a row write what they found
  uint32_t offset = 0;  ///< pixels from one end of a constraint to the next; bends_along: see ThirdRow
  BendOrder order = BendOrder::forward;  ///< of bends_along
  float share = 1;
  bool on_offsets = false;  ///< it is done before points settle, see lib/fine.h
  const RowStream* stream = nullptr;
  float* multipliers = nullptr;  ///< the stream's; nullptr: of one relaxation step
  bool read_multipliers = false, write_multipliers = false;
};

/// What a pass does before the next one goes on: some rows, and their blocks or runs first .. last - 1.
struct SweepTurn {
  uint32_t op;
  RowRange rows;
  uint32_t first, last;
};

/// Rows of a sweep that are worked on by one thread between two waits.
struct SweepBand {
  std::vector<RowRange> rows;  ///< of each pass
  uint32_t first_time = 0, end_time = 0;
  std::vector<SweepTurn> turns;  ///< one after the other; those with nothing to do are left out
};

/// Passes that run through the rows together.
struct Sweep {
  std::vector<SweepOp> ops;
  SweepBand whole;       ///< all of its rows
  uint32_t scratch = 0;  ///< floats of SweepFrame::scratch
  uint32_t strip = 1;    ///< times that pass: rows that a pass works on before the next one does
};

/// The rows of a pass that a band has from a time on to another one.
[[nodiscard]] inline RowRange rows_between(const RowRange& own, const SweepOp& op, uint32_t time, uint32_t end) {
  return {std::max(own.first, time - std::min(time, op.lag)), std::min(own.last, end - std::min(end, op.lag))};
}

/// Lists what a band of a sweep does.
inline void lay_turns(const Sweep& sweep, SweepBand& band) {
  band.turns.clear();
  for (uint32_t time = band.first_time; time < band.end_time; time += sweep.strip) {
    const uint32_t next = std::min(band.end_time, time + sweep.strip);
    for (uint32_t k = 0; k < sweep.ops.size(); ++k) {
      const SweepOp& op = sweep.ops[k];
      const RowRange rows = rows_between(band.rows[k], op, time, next);
      if (rows.first >= rows.last) continue;
      const std::vector<uint32_t>& entries = op.stream->row_first;
      const uint32_t first = entries[rows.first], last = entries[rows.last];
      if (first < last) band.turns.push_back({k, rows, first, last});
    }
  }
}

/// A collider from which a point that is this far away is certainly not touched, per substep.
struct ColliderGuard {
  enum class Kind : uint8_t { plane, ball, segment };
  float x, y, z;  ///< centre, or a plane's normal
  float reach;    ///< [m] radius, thickness, the collider's own way and rounding, or a plane's height
  Kind kind = Kind::ball;
  float spread = 1;  ///< a point may be nearer to the collider than to the guard by so many times less
  float axis_x = 0, axis_y = 0, axis_z = 0;  ///< of a segment through the centre
  float half_length = 0;                     ///< [m]
};

/// What is the same for all substeps of a frame.
struct SweepFrame {
  const PassContext* contexts = nullptr;  ///< one for each substep
  ClothState* state = nullptr;
  const Sweep* sweep = nullptr;
  const float* anchors = nullptr;         ///< for each substep x, y, z of every anchor, each `anchor_line` long
  uint32_t anchor_line = 0;               ///< whole lines of the cache
  const float* pins = nullptr;            ///< of this frame, see pin_rows.h
  const ColliderGuard* guards = nullptr;  ///< for each substep one for each collider
  bool collide_all = false;               ///< no point is certainly untouched, or points change without being touched
  float* penetration = nullptr;           ///< [m] of each substep, raised by check_colliders
  float* scratch = nullptr;               ///< memory for a strip, Sweep::scratch long; of one thread
  double* seconds = nullptr;              ///< one for each pass, added to; none: not measured
};

/// Runs a band of the sweep of one substep.
/// @param lanes  of the vectors that the streams were made for
void run_sweep(uint32_t lanes, const SweepFrame& frame, uint32_t substep, const SweepBand& band);

/// Unit normals of the pixels of some rows from their own cells.
/// @param runs  none reaches over the end of a row
void run_normals(uint32_t lanes, ClothState& state, std::span<const Run> runs);

/// The pass collide_cells: one group's cells, without those that no collider can reach.
/// @param rows  of the group: every other row of the image that has one below
void run_cells(uint32_t lanes, const SweepFrame& frame, uint32_t substep, uint32_t group, RowRange rows);

/// The pass lines: some blocks along rows (group 0) or columns.
/// @param kept  memory of line_kept() floats for each block, at most kLinesAtOnce, that nobody else works with
void run_lines(uint32_t lanes, ClothState& state, const LineStream& stream, uint32_t group, uint32_t first,
               uint32_t last, float* kept);

/// Lanes of this processor's vectors.
[[nodiscard]] uint32_t vector_lanes();
/// Name of the instruction set that is used.
[[nodiscard]] const char* vector_target();

}  // namespace geocloth::cpu
