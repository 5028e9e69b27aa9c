// SPDX-License-Identifier: Apache-2.0
// Skewed sweeps: pass k works on row t - lag(k) at the time t, so that all passes go through the cloth once, each a few
// rows behind the one before. A pass that touches rows y - up .. y + down may follow another one at a lag of its down
// plus the other's up: then every row that it touches has been through the other, and the other is past it.

#include "cpu/sweep_plan.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "cpu/bend_rows.h"
#include "cpu/limit_rows.h"
#include "cpu/line_stream.h"
#include "cpu/pin_rows.h"
#include "cpu/spring_rows.h"
#include "lib/bend_groups.h"

namespace geocloth::cpu {
namespace {

/// Added to a group of ties: those of its springs that take only a share.
constexpr uint32_t kLastTies = 4;

}  // namespace

class SweepPlanner {
 public:
  SweepPlanner(const ClothState& state, const ClothFrame& cloth, const std::vector<Run>& runs,
               uint32_t relaxation_steps, uint32_t lanes, bool on_offsets)
      : source_{.state = state,
                .cloth = cloth,
                .lanes = lanes,
                .width = state.data.width,
                .height = state.data.height,
                .several = relaxation_steps > 1,
                .strip = rows_at_once(runs, state.data.height),
                .on_offsets = on_offsets},
        runs_(runs),
        relaxation_steps_(relaxation_steps) {
    plan_->lanes_ = lanes;
  }

  /// Widest blocks: three vectors of columns, and one more for the diagonals.
  static bool wide_enough(uint32_t width, uint32_t lanes) { return width >= 3 * lanes + 4; }

  std::unique_ptr<SweepPlan> run(const std::vector<PassStep>& substep) {
    Sweep* sweep = nullptr;  // that passes go on with
    for (const PassStep& step : substep) {
      if (is_with_first_group(step)) continue;
      if (step.pass == Pass::lines) plan_->lines_[step.group] = line_stream(source_, step.group);
      if (!goes_by_rows(step.pass)) {
        plan_->parts_.emplace_back(step);
        sweep = nullptr;
        continue;
      }
      if (sweep == nullptr) sweep = &std::get<Sweep>(plan_->parts_.emplace_back(Sweep{}));
      append(*sweep, step.pass, make_op(step));
    }
    if (!source_.on_offsets) plan_->seams_ = seam_stream(source_.state, source_.cloth, substep, relaxation_steps_);
    for (SweepPlan::Part& part : plan_->parts_)
      if (auto* whole = std::get_if<Sweep>(&part)) lay_turns(*whole, whole->whole);
    return std::move(plan_);
  }

 private:
  void append(Sweep& sweep, Pass pass, SweepOp op) {
    op.pass = pass;
    settled_ = settled_ || pass == Pass::settle;
    op.on_offsets = source_.on_offsets && !settled_;
    op.spills = gives_back(op) || reaches_too_far_down(op);
    lay_reach(op);
    for (const SweepOp& before : sweep.ops) op.lag = std::max(op.lag, before.lag + op.down + before.up);
    sweep.whole.rows.push_back({0, source_.height});
    sweep.whole.end_time = source_.height + op.lag;  // lags ascend
    sweep.strip = source_.strip;
    if (op.kernel == RowKernel::bends_along)
      sweep.scratch = std::max(sweep.scratch, source_.strip * third_lines(op.on_offsets) * op.offset);
    sweep.ops.push_back(op);
  }

  void lay_reach(SweepOp& op) const {
    switch (op.kernel) {
      case RowKernel::normals:
        op.up = op.down = 1;
        break;
      case RowKernel::springs_across:
      case RowKernel::ties_across:
        op.down = rows_below(op);
        break;
      case RowKernel::bends_across:
        op.down = 2;
        break;
      case RowKernel::springs_along:
      case RowKernel::springs_along_two:
      case RowKernel::ties_along:
        op.down = rows_below_halves(op);
        break;
      default:
        break;
    }
  }

  /// Of the last lane of a block, the constraint there or not.
  [[nodiscard]] uint32_t rows_below(const SweepOp& op) const {
    uint32_t column = 0;
    for (const uint32_t p : op.stream->pixel) column = std::max(column, p % source_.width);
    return (column + source_.lanes - 1 + op.offset) / source_.width;
  }

  /// Of both halves of blocks along rows.
  [[nodiscard]] uint32_t rows_below_halves(const SweepOp& op) const {
    uint32_t rows = 0;
    for (size_t k = 0; k < op.stream->pixel.size(); ++k) {
      const uint32_t first = op.stream->pixel[k], last = std::max(first, op.stream->second[k]) + source_.lanes - 1;
      rows = std::max(rows, last / source_.width - first / source_.width);
    }
    return rows;
  }

  /// Whether lanes without a constraint, over the end of a row, write rows that no constraint leads to: of springs in
  /// different rows none share a pixel, of such lanes some do.
  [[nodiscard]] bool reaches_too_far_down(const SweepOp& op) const {
    const bool across = op.kernel == RowKernel::springs_across || op.kernel == RowKernel::ties_across;
    return across && rows_below(op) > (op.offset + 1) / source_.width;
  }

  /// Passes that write what follows a row as they found it.
  [[nodiscard]] bool gives_back(const SweepOp& op) const {
    const std::vector<uint32_t>&first = op.stream->pixel, &second = op.stream->second;
    const auto end_of = [&](uint32_t p) { return p % source_.width + source_.lanes; };
    for (size_t k = 0; k < second.size(); ++k) {
      const bool unused = second[k] == first[k] + source_.lanes;  // or right behind it, which comes to the same
      if (end_of(first[k]) + (unused ? source_.lanes : 0) > source_.width || end_of(second[k]) > source_.width)
        return true;
    }
    return false;
  }

  /// A pass begins with what has to wait for roots and divisions: it should go on for so many pixels then. More would
  /// be out of the nearest cache when the next pass comes.
  static uint32_t rows_at_once(const std::vector<Run>& runs, uint32_t height) {
    constexpr uint32_t kPixels = 1400, kLeast = 4, kMost = 16;
    uint64_t pixels = 0;
    for (const Run& run : runs) pixels += run.last - run.first;
    const uint64_t wanted = uint64_t{kPixels} * height;
    return static_cast<uint32_t>(std::clamp<uint64_t>(wanted / std::max<uint64_t>(pixels, 1), kLeast, kMost));
  }

  /// Groups that bends_along() does with the first one.
  static bool is_with_first_group(const PassStep& step) {
    return step.pass == Pass::curvature && shader::bend_component(step.group) == 4 && (step.group > 0 || step.again);
  }

  static bool goes_by_rows(Pass pass) {
    switch (pass) {
      case Pass::normals:
      case Pass::predict:
      case Pass::pins:
      case Pass::structural:
      case Pass::shear:
      case Pass::bending:
      case Pass::curvature:
      case Pass::spans:
      case Pass::settle:
      case Pass::limit:
      case Pass::collide:
      case Pass::hold_way:
      case Pass::ties:
      case Pass::give_way:
      case Pass::check_colliders:
        return true;
      default:
        return false;
    }
  }

  SweepOp make_op(const PassStep& step) {
    switch (step.pass) {
      case Pass::normals:
        return over_runs(RowKernel::normals);
      case Pass::predict:
        return over_runs(RowKernel::predict);
      case Pass::settle:
        return over_runs(RowKernel::settle);
      case Pass::collide:
        return over_runs(RowKernel::collide);
      case Pass::hold_way:
        return over_runs(RowKernel::hold_way);
      case Pass::ties:
        return kept({step.pass, step.group + (step.relaxation > 0 ? kLastTies : 0)}, ties);
      case Pass::give_way:
        return over_runs(RowKernel::give_way);
      case Pass::check_colliders:
        return over_runs(RowKernel::check_colliders);
      case Pass::pins:
        return pins();
      case Pass::curvature:
        return bends(step);
      case Pass::spans:
        return kept(step, span_rows);
      case Pass::limit:
        return limit();
      default:
        return relaxed(step, spring_rows);
    }
  }

  /// There and back the constraints of a group are laid out once, too.
  SweepOp bends(const PassStep& step) {
    const auto lay_out = [&](const RowSource& source, uint32_t, RowStream& stream) {
      return bend_rows(source, step, stream);
    };
    SweepOp op = step.order == BendOrder::there_and_back ? kept(step, lay_out) : relaxed(step, lay_out);
    op.order = step.order;
    return op;
  }

  using LayOut = SweepOp (*)(const RowSource&, uint32_t group, RowStream&);
  static SweepOp ties(const RowSource& source, uint32_t group, RowStream& stream) {
    return tie_rows(source, group % kLastTies, group >= kLastTies, stream);
  }

  /// With several relaxation steps the constraints of a group are laid out once, and their multipliers are kept there.
  template <class LayOutGroup>
  SweepOp relaxed(const PassStep& step, const LayOutGroup& lay_out) {
    const auto known = first_relaxation_.find({step.pass, step.group});
    SweepOp op = known != first_relaxation_.end() ? known->second : lay_out(source_, step.group, new_stream());
    if (relaxation_steps_ == 1) return op;
    if (known == first_relaxation_.end()) {
      RowStream& stream = *plan_->streams_.back();
      stream.multipliers.resize(stream.pixel.size() * source_.lanes + 1);  // somewhere, even for no blocks
      op.multipliers = stream.multipliers.data();
      first_relaxation_.emplace(std::pair{step.pass, step.group}, op);
    }
    op.read_multipliers = step.relaxation > 0;
    op.write_multipliers = step.relaxation + 1 < relaxation_steps_;
    return op;
  }

  /// What has no multipliers is laid out once, too.
  template <class LayOutGroup>
  SweepOp kept(const PassStep& step, const LayOutGroup& lay_out) {
    const auto known = first_relaxation_.find({step.pass, step.group});
    if (known != first_relaxation_.end()) return known->second;
    const SweepOp op = lay_out(source_, step.group, new_stream());
    return first_relaxation_.emplace(std::pair{step.pass, step.group}, op).first->second;
  }

  RowStream& new_stream() { return *plan_->streams_.emplace_back(std::make_unique<RowStream>()); }

  SweepOp over_runs(RowKernel kernel) {
    const bool whole_vectors = kernel != RowKernel::normals;
    RowStream*& stream = run_streams_[whole_vectors ? 1 : 0];
    if (stream == nullptr) {
      stream = &new_stream();
      stream->runs = whole_vectors ? vectors_of(runs_) : runs_;
      first_of_rows(*stream, stream->runs.size(), [&](size_t k) { return stream->runs[k].first; });
    }
    return {.kernel = kernel, .stream = stream};
  }

  /// Runs of whole vectors, from multiples of their lanes on, that hold these: rows are such multiples, too.
  [[nodiscard]] std::vector<Run> vectors_of(const std::vector<Run>& runs) const {
    std::vector<Run> all;
    for (const Run& run : runs) {
      const Run own{run.first / source_.lanes * source_.lanes,
                    (run.last + source_.lanes - 1) / source_.lanes * source_.lanes};
      const uint32_t end = all.empty() ? 0 : all.back().last;  // at most that of a row
      if (own.first < end || (own.first == end && own.first % source_.width != 0)) {
        all.back().last = own.last;
      } else {
        all.push_back(own);
      }
    }
    return all;
  }

  SweepOp pins() {
    RowStream& stream = new_stream();
    stream.runs = pin_blocks(source_.cloth.pins, source_.width, source_.lanes);
    first_of_rows(stream, stream.runs.size(), [&](size_t k) { return stream.runs[k].first; });
    plan_->pins_ = &stream;
    return {.kernel = RowKernel::pins, .stream = &stream};
  }

  /// Entries whose pixels ascend.
  template <class PixelOf>
  void first_of_rows(RowStream& stream, size_t count, const PixelOf& pixel_of) const {
    size_t k = 0;
    for (uint32_t y = 0; y <= source_.height; ++y) {
      while (k < count && pixel_of(k) < size_t{y} * source_.width) ++k;
      stream.row_first.push_back(static_cast<uint32_t>(k));
    }
  }

  /// Anchors are laid out in the order that they have in the plan.
  SweepOp limit() {
    plan_->anchor_of_pin_ = order_anchors(source_);
    return limit_rows(source_, plan_->anchor_of_pin_, new_stream());
  }

  const RowSource source_;
  const std::vector<Run>& runs_;
  uint32_t relaxation_steps_;
  bool settled_ = false;  ///< by the passes until now
  std::unique_ptr<SweepPlan> plan_ = std::make_unique<SweepPlan>();
  std::array<RowStream*, 2> run_streams_{};                        ///< of pixels, of whole vectors
  std::map<std::pair<Pass, uint32_t>, SweepOp> first_relaxation_;  ///< of what comes again, by pass and group
};

std::unique_ptr<SweepPlan> SweepPlan::make(const ClothState& state, const std::vector<PassStep>& substep,
                                           const ClothFrame& cloth, const std::vector<Run>& runs,
                                           uint32_t relaxation_steps) {
  for (uint32_t lanes = vector_lanes(); lanes >= 4; lanes /= 2) {
    if (!SweepPlanner::wide_enough(state.data.width, lanes)) continue;
    const bool on_offsets =
        std::ranges::any_of(substep, [](const PassStep& step) { return step.pass == Pass::settle; });
    return SweepPlanner(state, cloth, runs, relaxation_steps, lanes, on_offsets).run(substep);
  }
  return nullptr;
}

namespace {

/// But for the streams and what follows from them.
bool are_alike(const SweepOp& a, const SweepOp& b) {
  const auto facts = [](const SweepOp& op) {
    return std::tuple(op.kernel, op.pass, op.lag, op.up, op.down, op.spills, op.offset, op.order, op.share,
                      op.on_offsets);
  };
  return facts(a) == facts(b);
}

bool are_alike(const SweepPlan::Part& a, const SweepPlan::Part& b) {
  if (a.index() != b.index()) return false;
  if (const auto* step = std::get_if<PassStep>(&a)) return *step == std::get<PassStep>(b);
  const auto &one = std::get<Sweep>(a), &other = std::get<Sweep>(b);
  return one.strip == other.strip && one.scratch == other.scratch &&
         std::equal(one.ops.begin(), one.ops.end(), other.ops.begin(), other.ops.end(),
                    [](const SweepOp& x, const SweepOp& y) { return are_alike(x, y); });
}

}  // namespace

bool SweepPlan::can_stand_for(const SweepPlan& other) const {
  // Plans lay their streams out in the order of their passes: with equal passes each has its stream at the same place.
  const auto are_equal = [](const std::unique_ptr<RowStream>& a, const std::unique_ptr<RowStream>& b) {
    return a->multipliers.empty() && *a == *b;
  };
  return lanes_ == other.lanes_ && anchor_of_pin_ == other.anchor_of_pin_ && lines_ == other.lines_ &&
         seams_ == other.seams_ &&
         std::equal(parts_.begin(), parts_.end(), other.parts_.begin(), other.parts_.end(),
                    [](const Part& a, const Part& b) { return are_alike(a, b); }) &&
         std::equal(streams_.begin(), streams_.end(), other.streams_.begin(), other.streams_.end(), are_equal);
}

size_t SweepPlan::memory_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values.front()); };
  size_t sum = 0;
  for (const auto& s : streams_) {
    sum += bytes(s->row_first) + bytes(s->group_first) + bytes(s->pixel) + bytes(s->second) + bytes(s->beside) +
           bytes(s->constants) + bytes(s->multipliers) + bytes(s->anchors) + bytes(s->first_anchor) + bytes(s->runs) +
           bytes(s->third_first) + bytes(s->thirds);
  }
  for (const LineStream& s : lines_) sum += bytes(s.blocks) + bytes(s.constants);
  return sum + seams_.memory_bytes();
}

size_t SweepPlan::bytes_per_substep() const {
  constexpr size_t kPoint = 3 * sizeof(float);
  size_t pixels = 0;
  for (const auto& s : streams_) {
    if (s.get() == pins_) continue;
    for (const Run& run : s->runs) pixels += run.last - run.first;
  }
  size_t sum = 0;
  for (const Part& part : parts_) {
    if (!std::holds_alternative<Sweep>(part)) continue;
    bool moves_history = false, on_offsets = false;
    for (const SweepOp& op : std::get<Sweep>(part).ops) {
      moves_history = moves_history || op.kernel == RowKernel::predict || op.kernel == RowKernel::collide ||
                      op.kernel == RowKernel::hold_way;
      on_offsets = on_offsets || op.on_offsets;
      sum += sizeof(float) * (op.stream->constants.size() + op.stream->anchors.size()) +
             sizeof(uint32_t) * (op.stream->pixel.size() + op.stream->second.size());
      if (op.kernel == RowKernel::pins) sum += op.stream->runs.size() * kPinFloats * lanes_ * sizeof(float);
      if (op.kernel == RowKernel::normals) sum += pixels * (sizeof(uint32_t) + kPoint + sizeof(float));
    }
    sum += pixels * (2 * kPoint + sizeof(float));         // position both ways, inverse mass
    if (moves_history) sum += pixels * (2 * kPoint * 2);  // previous and carry both ways
    if (on_offsets) sum += pixels * (2 * kPoint);         // both ways, too
  }
  return sum;
}

std::vector<Run> valid_runs(const ClothState& state) {
  std::vector<Run> runs;
  const uint32_t width = state.data.width;
  for (uint32_t i = 0; i < state.pixel_count(); ++i) {
    if (!(state.inverse_mass[i] > 0)) continue;
    if (runs.empty() || runs.back().last != i || i % width == 0) runs.push_back({i, i});
    runs.back().last = i + 1;
  }
  return runs;
}

}  // namespace geocloth::cpu
