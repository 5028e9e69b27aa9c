// SPDX-License-Identifier: Apache-2.0
// Skewed sweeps: pass k works on row t - lag(k) at the time t, so that all passes go through the cloth once, each a few
// rows behind the one before. A pass that touches rows y - up .. y + down may follow another one at a lag of its down
// plus the other's up: then every row that it touches has been through the other, and the other is past it. Constants
// are laid out in the order of the vectors' lanes, with only those blocks that hold a constraint.

#include "cpu/sweep_plan.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "cpu/spans.h"
#include "cpu/springs.h"
#include "lib/bend.h"
#include "lib/bend_groups.h"
#include "lib/lines.h"
#include "lib/spring_groups.h"

namespace geocloth::cpu {
namespace {

/// How the lanes of a block lie in the image. The last one of a row may reach over its end.
struct BlockShape {
  RowKernel kernel;
  uint32_t span;           ///< columns that a block reads and writes
  uint32_t period, phase;  ///< its first column is `phase` modulo `period`
  uint32_t end;            ///< columns before this one may have constraints' first ends
};

/// Lane of the constraint that starts `column` columns after its block; see even_columns() in constraints_inl.h.
uint32_t lane_of(RowKernel kernel, uint32_t column, uint32_t lanes) {
  const bool high = column >= lanes;
  const uint32_t c = high ? column - lanes : column;
  switch (kernel) {
    case RowKernel::springs_along:
      return c / 4 * 4 + c % 4 / 2 + (high ? 2 : 0);
    case RowKernel::springs_along_two:
      return c / 4 * 4 + c % 4 + (high ? 2 : 0);
    default:
      return column;
  }
}

/// Added to a group of ties: those of its springs that take only a share.
constexpr uint32_t kLastTies = 4;

/// Rows between two bands that one thread makes up for while others wait: from here on it is cheaper to go through the
/// rows once more.
constexpr uint32_t kShortGap = 16;

/// Rows above and below its own that a kernel touches.
struct Reach {
  uint32_t up = 0, down = 0;
};

}  // namespace

class SweepPlanner {
 public:
  SweepPlanner(const ClothState& state, const ClothFrame& cloth, const std::vector<Run>& runs,
               uint32_t relaxation_steps, bool in_bands, uint32_t lanes)
      : state_(state),
        cloth_(cloth),
        runs_(runs),
        relaxation_steps_(relaxation_steps),
        in_bands_(in_bands),
        lanes_(lanes),
        width_(state.data.width),
        height_(state.data.height),
        strip_(rows_at_once(runs, state.data.height, in_bands && state.data.split_rows() == 0)) {
    plan_->lanes_ = lanes;
  }

  /// Widest blocks: three vectors of columns, and one more for the diagonals.
  static bool wide_enough(uint32_t width, uint32_t lanes) { return width >= 3 * lanes + 4; }

  std::unique_ptr<SweepPlan> run(const std::vector<PassStep>& substep) {
    const bool whole =
        std::all_of(substep.begin(), substep.end(), [](const PassStep& s) { return goes_by_rows(s.pass); });
    for (const PassStep& step : substep) {
      if (is_with_first_group(step)) continue;
      if (step.pass == Pass::lines) lay_out_lines(step.group);
      if (!goes_by_rows(step.pass)) {
        plan_->parts_.emplace_back(step);
        continue;
      }
      const auto* sweep = plan_->parts_.empty() ? nullptr : std::get_if<Sweep>(&plan_->parts_.back());
      const bool too_far = in_bands_ && !whole && sweep != nullptr && sweep->last_lag + sweep->last_rise > kShortGap;
      if (sweep == nullptr || too_far) {
        plan_->parts_.emplace_back(Sweep{});
        reaches_.clear();
      }
      append(std::get<Sweep>(plan_->parts_.back()), step.pass, make_op(step));
    }
    return std::move(plan_);
  }

 private:
  void append(Sweep& sweep, Pass pass, SweepOp op) {
    op.pass = pass;
    const Reach reach = reach_of(op);
    if (gives_back(op)) op.lag = reach.down;  // a band below has begun with its first row already
    for (size_t k = 0; k < sweep.ops.size(); ++k) {
      op.lag = std::max(op.lag, sweep.ops[k].lag + reach.down + reaches_[k].up);
      op.rise = std::max(op.rise, sweep.ops[k].rise + reach.up + reaches_[k].down);
    }
    sweep.ops.push_back(op);
    reaches_.push_back(reach);
    sweep.last_lag = op.lag;
    sweep.last_rise = op.rise;
    sweep.strip = strip_;
    if (op.kernel == RowKernel::bends_along) sweep.scratch = std::max(sweep.scratch, strip_ * kThirdLines * op.offset);
    for (const Reach& other : reaches_) {
      sweep.longest_reach = std::max({sweep.longest_reach, reach.up + other.down, other.up + reach.down});
    }
    // The next substep's pass j at t is on row t - lag(j); this one's pass k has to be through row t - lag(j) + down(j)
    // + up(k) by then, and so at the time t + distance.
    int64_t distance = 0;
    for (size_t j = 0; j < sweep.ops.size(); ++j)
      for (size_t k = 0; k < sweep.ops.size(); ++k)
        distance = std::max(
            distance, int64_t{sweep.ops[k].lag} + reaches_[k].up + reaches_[j].down - int64_t{sweep.ops[j].lag} + 1);
    sweep.distance = static_cast<uint32_t>(distance);
  }

  [[nodiscard]] Reach reach_of(const SweepOp& op) const {
    switch (op.kernel) {
      case RowKernel::normals:
        return {1, 1};
      case RowKernel::springs_across:
      case RowKernel::ties_across:
        return {0, rows_below(op)};
      case RowKernel::bends_across:
        return {0, 2};
      default:
        return gives_back(op) ? Reach{0, 1} : Reach{};
    }
  }

  /// Of the last lane of a block, the constraint there or not.
  [[nodiscard]] uint32_t rows_below(const SweepOp& op) const {
    uint32_t column = 0;
    for (const uint32_t p : op.stream->pixel) column = std::max(column, p % width_);
    return (column + lanes_ - 1 + op.offset) / width_;
  }

  /// Passes that write what follows a row as they found it.
  [[nodiscard]] bool gives_back(const SweepOp& op) const {
    if (op.kernel != RowKernel::springs_along && op.kernel != RowKernel::springs_along_two &&
        op.kernel != RowKernel::ties_along) {
      return false;
    }
    const std::vector<uint32_t>& blocks = op.stream->pixel;
    return std::any_of(blocks.begin(), blocks.end(), [&](uint32_t p) { return p % width_ + 2 * lanes_ > width_; });
  }

  /// A pass begins with what has to wait for roots and divisions: it should go on for so many pixels then. More would
  /// be out of the nearest cache when the next pass comes. Threads that follow each other from substep to substep do so
  /// strip by strip, and wait less where these are short.
  static uint32_t rows_at_once(const std::vector<Run>& runs, uint32_t height, bool followed) {
    constexpr uint32_t kPixels = 1400, kPixelsFollowed = 700, kLeast = 4, kMost = 16;
    uint64_t pixels = 0;
    for (const Run& run : runs) pixels += run.last - run.first;
    const uint64_t wanted = uint64_t{followed ? kPixelsFollowed : kPixels} * height;
    return static_cast<uint32_t>(std::clamp<uint64_t>(wanted / std::max<uint64_t>(pixels, 1), kLeast, kMost));
  }

  /// Groups that bends_along() does with the first one.
  static bool is_with_first_group(const PassStep& step) {
    return step.pass == Pass::curvature && shader::bend_component(step.group) == 4 && step.group > 0;
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
      case Pass::collide:
        return over_runs(RowKernel::collide);
      case Pass::hold_way:
        return over_runs(RowKernel::hold_way);
      case Pass::ties:
        return kept({step.pass, step.group + (step.relaxation > 0 ? kLastTies : 0)}, &SweepPlanner::ties);
      case Pass::give_way:
        return over_runs(RowKernel::give_way);
      case Pass::check_colliders:
        return over_runs(RowKernel::check_colliders);
      case Pass::pins:
        return pins();
      case Pass::curvature:
        return relaxed(step, &SweepPlanner::bends);
      case Pass::spans:
        return kept(step, &SweepPlanner::spans);
      case Pass::limit:
        return limit();
      default:
        return relaxed(step, &SweepPlanner::springs);
    }
  }

  /// With several relaxation steps the constraints of a group are laid out once, and their multipliers are kept there.
  SweepOp relaxed(const PassStep& step, SweepOp (SweepPlanner::*lay_out)(uint32_t)) {
    const auto known = first_relaxation_.find({step.pass, step.group});
    SweepOp op = known != first_relaxation_.end() ? known->second : (this->*lay_out)(step.group);
    if (relaxation_steps_ == 1) return op;
    if (known == first_relaxation_.end()) {
      RowStream& stream = *plan_->streams_.back();
      stream.multipliers.resize(stream.pixel.size() * lanes_ + 1);  // somewhere, even for no blocks
      op.multipliers = stream.multipliers.data();
      first_relaxation_.emplace(std::pair{step.pass, step.group}, op);
    }
    op.read_multipliers = step.relaxation > 0;
    op.write_multipliers = step.relaxation + 1 < relaxation_steps_;
    return op;
  }

  /// What has no multipliers is laid out once, too.
  SweepOp kept(const PassStep& step, SweepOp (SweepPlanner::*lay_out)(uint32_t)) {
    const auto known = first_relaxation_.find({step.pass, step.group});
    if (known != first_relaxation_.end()) return known->second;
    return first_relaxation_.emplace(std::pair{step.pass, step.group}, (this->*lay_out)(step.group)).first->second;
  }

  [[nodiscard]] bool several() const { return relaxation_steps_ > 1; }

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
      const Run own{run.first / lanes_ * lanes_, (run.last + lanes_ - 1) / lanes_ * lanes_};
      const uint32_t end = all.empty() ? 0 : all.back().last;  // at most that of a row
      if (own.first < end || (own.first == end && own.first % width_ != 0)) {
        all.back().last = own.last;
      } else {
        all.push_back(own);
      }
    }
    return all;
  }

  SweepOp pins() {
    RowStream& stream = new_stream();
    first_of_rows(stream, cloth_.pins.size(), [&](size_t k) { return cloth_.pins[k].pixel.x; });
    return {.kernel = RowKernel::pins, .stream = &stream};
  }

  /// Entries whose pixels ascend.
  template <class PixelOf>
  void first_of_rows(RowStream& stream, size_t count, const PixelOf& pixel_of) const {
    size_t k = 0;
    for (uint32_t y = 0; y <= height_; ++y) {
      while (k < count && pixel_of(k) < size_t{y} * width_) ++k;
      stream.row_first.push_back(static_cast<uint32_t>(k));
    }
  }

  /// Vectors of neighbouring columns. They lie within cache lines: that is worth more than the lanes that it leaves
  /// idle.
  static BlockShape vectors(RowKernel kernel, uint32_t lanes, uint32_t end) { return {kernel, lanes, lanes, 0, end}; }

  /// Lays blocks over the constraints of a row that has(x) tells, each where the first one is that is not covered yet.
  /// They do not overlap: what a block has just written and the next one reads in other pieces keeps the processor
  /// waiting.
  /// fill(block, lane, x) writes a lane's constants.
  template <class Has, class Add, class Fill>
  void cover_row(const BlockShape& shape, uint32_t y, const Has& has, const Add& add, const Fill& fill) {
    for (uint32_t x = shape.phase; x < shape.end;) {
      if (!has(x)) {
        ++x;
        continue;
      }
      const uint32_t start = x - (x - shape.phase) % shape.period;
      add(y * width_ + start);
      uint32_t covered = x;
      for (; covered < start + shape.span; ++covered) {
        if (covered < shape.end && has(covered)) fill(lane_of(shape.kernel, covered - start, lanes_), covered);
      }
      x = covered;
    }
  }

  /// They lie where the structural springs do.
  SweepOp ties(uint32_t group) {
    SweepOp op = lay_out_springs(group % kLastTies, true, group < kLastTies ? 1 : shader::kTieShare);
    op.kernel = op.kernel == RowKernel::springs_along ? RowKernel::ties_along : RowKernel::ties_across;
    op.share = 1;
    return op;
  }

  SweepOp springs(uint32_t group) { return lay_out_springs(group, false); }

  SweepOp lay_out_springs(uint32_t group, bool tie, float tie_share = 1) {
    const uint32_t component = shader::group_component(group), odd = group % 2;
    const bool along = shader::group_by_column(group) == 1;
    const RowKernel kernel = !along           ? RowKernel::springs_across
                             : component == 0 ? RowKernel::springs_along
                                              : RowKernel::springs_along_two;
    const shader::uvec2 end = shader::spring_end(component, 1, 0);
    const uint32_t offset = end.y * width_ + end.x - 1;
    BlockShape shape = vectors(kernel, lanes_, width_);
    if (component == 0) shape = {kernel, 2 * lanes_, 2, odd, width_};
    if (component == 4) shape = {kernel, 2 * lanes_, 4, 2 * odd, width_};
    RowStream& stream = new_stream();
    const auto in_row = [&](uint32_t y) { return along || group_has_line(group, y); };
    const auto in_column = [&](uint32_t x) { return !along || group_has_line(group, x); };
    for (uint32_t y = 0; y < height_; ++y) {
      stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
      if (!in_row(y)) continue;
      const auto inverse_of = [&](uint32_t x) {
        return in_column(x) ? tie_share * spring_inverse(component, y * width_ + x, offset, !tie) : 0.F;
      };
      cover_row(
          shape, y, [&](uint32_t x) { return inverse_of(x) > 0; },
          [&](uint32_t first) { add_block(stream, first, several() ? 3 : 2, lanes_); },
          [&](uint32_t lane, uint32_t x) {
            float* block = &stream.constants[stream.constants.size() - size_t{several() ? 3U : 2U} * lanes_];
            block[lane] = state_.rest[component][y * width_ + x] * (tie ? cloth_.params.stretch_limit : 1.F);
            block[lanes_ + lane] = inverse_of(x);
            if (several()) block[2 * lanes_ + lane] = scaled_compliance(component, y * width_ + x);
          });
    }
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    return {.kernel = kernel, .offset = offset, .share = share_of(cloth_.params, component), .stream = &stream};
  }

  static void add_block(RowStream& stream, uint32_t first, uint32_t constants, uint32_t lanes) {
    stream.pixel.push_back(first);
    stream.constants.resize(stream.constants.size() + size_t{constants} * lanes, 0.F);
  }

  static bool group_has_line(uint32_t group, uint32_t line) {
    const uint32_t odd = group % 2;
    return (group < 8 ? line % 2 : line / 2 % 2) == odd;
  }

  /// 1 / (w + compliance), as spring.h has it; 0 where the spring does not exist or cannot move.
  [[nodiscard]] float spring_inverse(uint32_t component, size_t a, uint32_t offset, bool compliant) const {
    if (!(state_.rest[component][a] > 0)) return 0;
    const float w = state_.inverse_mass[a] + state_.inverse_mass[a + offset];
    if (!(w > 0)) return 0;
    return 1.F / (compliant ? w + scaled_compliance(component, a) : w);
  }

  [[nodiscard]] float scaled_compliance(uint32_t component, size_t a) const {
    return state_.compliance[component][a] * cloth_.params.inverse_dt2;
  }

  /// Down the columns one group; along the rows, where the groups follow each other in every row, all three.
  SweepOp bends(uint32_t group) {
    if (shader::bend_component(group) == 4) return bends_along();
    RowStream& stream = new_stream();
    const BlockShape shape = vectors(RowKernel::bends_across, lanes_, width_);
    for (uint32_t y = 0; y < height_; ++y) {
      stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
      if (y % 3 == group % 3 && y + 2 < height_)
        cover_bends(stream, shape, y, [&](uint32_t x) { return bend_constants(5, y * width_ + x, width_); });
    }
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    return {.kernel = RowKernel::bends_across, .offset = width_, .stream = &stream};
  }

  /// Columns of a group are 0 for its first one, 1 for the third one after it, ...
  SweepOp bends_along() {
    RowStream& stream = new_stream();
    const uint32_t thirds = width_ / 3;  // complete ones; WideRows keeps cloth out of the columns behind
    const BlockShape shape = vectors(RowKernel::bends_along, lanes_, thirds);
    // A line of the scratch holds the vectors of thirds, and where the last block begins at the next one, one more.
    const uint32_t line = (thirds / lanes_ + 2) * lanes_;
    stream.thirds.assign(height_, {thirds, 0});
    stream.row_first.assign(height_ + 1, 0);
    for (uint32_t group = 0; group < 3; ++group) {
      for (uint32_t y = 0; y < height_; ++y) {
        const size_t before = stream.pixel.size();
        stream.group_first.push_back(static_cast<uint32_t>(before));
        cover_bends(stream, shape, 0, [&](uint32_t n) {
          const uint32_t x = 3 * n + group;
          return x + 2 < 3 * thirds ? bend_constants(4, y * width_ + x, 1) : BendConstants{};
        });
        const auto blocks = std::span(stream.pixel).subspan(before);
        reach_thirds(blocks, thirds, stream.thirds[y]);
        stream.row_first[y + 1] += static_cast<uint32_t>(blocks.size());
        for (uint32_t& block : blocks) block += third_row(y, strip_, line);
      }
      stream.group_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    }
    std::partial_sum(stream.row_first.begin(), stream.row_first.end(), stream.row_first.begin());
    return {.kernel = RowKernel::bends_along, .offset = line, .stream = &stream};
  }

  /// Lets thirds of a row, from a whole number of vectors on, hold those that blocks reach.
  void reach_thirds(std::span<const uint32_t> blocks, uint32_t thirds, Run& run) const {
    for (const uint32_t first : blocks) {
      run.first = std::min(run.first, first - first % lanes_);
      run.last = std::max(run.last, std::min(thirds, first + lanes_ + 1));
    }
  }

  /// @param constants_of  of the bend that starts in a column, or with the inverse 0
  template <class ConstantsOf>
  void cover_bends(RowStream& stream, const BlockShape& shape, uint32_t y, const ConstantsOf& constants_of) {
    cover_row(
        shape, y, [&](uint32_t x) { return constants_of(x).inverse > 0; },
        [&](uint32_t first) { add_block(stream, first, several() ? 4 : 3, lanes_); },
        [&](uint32_t lane, uint32_t x) {
          const BendConstants c = constants_of(x);
          float* block = &stream.constants[stream.constants.size() - size_t{several() ? 4U : 3U} * lanes_];
          block[lane] = c.rest;
          block[lanes_ + lane] = c.inverse;
          block[2 * lanes_ + lane] = c.chord;
          if (several()) block[3 * lanes_ + lane] = c.compliance;
        });
  }

  struct BendConstants {
    float rest = 0, inverse = 0, chord = 0, compliance = 0;
  };
  /// The weights as bend.h has them, for a middle point that carries all of its mass.
  [[nodiscard]] BendConstants bend_constants(uint32_t component, size_t a, uint32_t offset) const {
    const float compliance = scaled_compliance(component, a);
    if (!(compliance > 0)) return {};
    const std::vector<float>& along = state_.rest[component - 4];
    const float chord = shader::chord_share(along[a], along[a + offset]), back = 1.F - chord;
    const float wa = state_.inverse_mass[a], wm = state_.inverse_mass[a + offset];
    const float wb = state_.inverse_mass[a + 2 * size_t{offset}];
    const float w = wa * back * back + wm * 1.F + wb * chord * chord;
    return {state_.rest[component][a], 1.F / (w + compliance), chord, compliance};
  }

  SweepOp spans(uint32_t group) {
    const uint32_t component = shader::span_component(group);
    const bool along = component == 0;
    const RowKernel kernel = along ? RowKernel::spans_along : RowKernel::ties_across;
    const uint32_t lanes = along ? std::min(lanes_, kSpanLanes) : lanes_;
    const uint32_t offset = shader::kSpanPixels * (along ? 1 : width_);
    const BlockShape shape = vectors(kernel, lanes, width_ - (along ? shader::kSpanPixels : 0));
    RowStream& stream = new_stream();
    for (uint32_t y = 0; y < height_; ++y) {
      stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
      if (!along && y + shader::kSpanPixels >= height_) continue;
      const auto length_of = [&](uint32_t x) {
        const size_t a = size_t{y} * width_ + x;
        const bool moves = state_.inverse_mass[a] + state_.inverse_mass[a + offset] > 0;
        return shader::span_starts(group, x, y) && moves ? span_length(state_, component, a) : 0.F;
      };
      cover_row(
          shape, y, [&](uint32_t x) { return length_of(x) > 0; },
          [&](uint32_t first) { add_block(stream, first, 2, lanes); },
          [&](uint32_t lane, uint32_t x) {
            const size_t a = size_t{y} * width_ + x;
            float* block = &stream.constants[stream.constants.size() - 2 * size_t{lanes}];
            block[lane] = length_of(x) * cloth_.params.stretch_limit;
            block[lanes + lane] = 1.F / (state_.inverse_mass[a] + state_.inverse_mass[a + offset]);
          });
    }
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    return {.kernel = kernel, .offset = offset, .stream = &stream};
  }

  /// Lines along rows (group 0) go as far as some point of them has a spring, in as many columns as are turned at once.
  void lay_out_lines(uint32_t group) {
    LineStream& stream = plan_->lines_[group];
    stream.diagonal = shader::line_diagonal(cloth_.params.inverse_dt2);
    const bool along = group == 0;
    const uint32_t lines = along ? height_ : width_, length = along ? width_ : height_, at_once = along ? kTurned : 1;
    for (uint32_t line = 0; line < lines; line += lanes_) {
      const uint32_t count = std::min(lanes_, lines - line);
      bool goes_on = false;
      for (uint32_t k = 0; k < length; k += at_once) {
        bool any = false;
        for (uint32_t n = 0; n < at_once * count; ++n) any = any || is_in_line(group, line + n % count, k + n / count);
        if (any && !goes_on) {
          const uint32_t first = along ? line * width_ + k : k * width_ + line;
          stream.blocks.push_back({first, 0, count, stream.constants.size()});
        }
        goes_on = any;
        if (!any) continue;
        stream.blocks.back().points += at_once;
        for (uint32_t i = k; i < k + at_once; ++i) add_line_points(stream, group, line, count, i);
      }
    }
  }

  void add_line_points(LineStream& stream, uint32_t group, uint32_t line, uint32_t count, uint32_t k) const {
    const size_t place = stream.constants.size();
    stream.constants.resize(place + size_t{kLineFloats} * lanes_, 0.F);
    for (uint32_t lane = 0; lane < count; ++lane) {
      if (!is_in_line(group, line + lane, k)) continue;
      const size_t pixel = pixel_of_line(group, line + lane, k);
      stream.constants[place + lane] = shader::line_weight(state_.inverse_mass[pixel], state_.data.cell[pixel]);
      stream.constants[place + lanes_ + lane] = state_.rest[group][pixel] * cloth_.params.stretch_limit;
    }
  }

  [[nodiscard]] size_t pixel_of_line(uint32_t group, uint32_t line, uint32_t k) const {
    return group == 0 ? size_t{line} * width_ + k : size_t{k} * width_ + line;
  }

  /// A spring begins or ends there.
  [[nodiscard]] bool is_in_line(uint32_t group, uint32_t line, uint32_t k) const {
    const std::vector<float>& rest = state_.rest[group];
    return rest[pixel_of_line(group, line, k)] > 0 || (k > 0 && rest[pixel_of_line(group, line, k - 1)] > 0);
  }

  /// Pixels of a row are held by anchors of neighbouring columns, more or less: in that order a vector's lanes choose
  /// from as many anchors as it has lanes.
  void order_anchors() {
    const auto column_first = [&](uint32_t k) {
      const uint32_t pixel = cloth_.pins[k].pixel.x;
      return std::pair(pixel % width_, pixel);
    };
    std::vector<uint32_t> pins(cloth_.pins.size());
    std::iota(pins.begin(), pins.end(), 0U);
    std::sort(pins.begin(), pins.end(), [&](uint32_t a, uint32_t b) { return column_first(a) < column_first(b); });
    plan_->anchor_of_pin_.resize(pins.size());
    for (uint32_t n = 0; n < pins.size(); ++n) plan_->anchor_of_pin_[pins[n]] = n;
  }

  /// Anchors stay where the pins put them during a substep, so they need not be looked up in the image.
  SweepOp limit() {
    order_anchors();
    std::vector<int32_t> anchor_at(state_.pixel_count(), -1);
    for (size_t k = 0; k < cloth_.pins.size(); ++k) {
      const uint32_t pixel = cloth_.pins[k].pixel.x;
      if (state_.inverse_mass[pixel] > 0) continue;  // drawn along softly: nobody's anchor
      anchor_at[pixel] = static_cast<int32_t>(plan_->anchor_of_pin_[k]);
    }
    const auto anchor_of = [&](size_t i) {
      const uint32_t anchor = state_.attachments[i].anchor;
      return anchor == shader::kNoAnchor || state_.inverse_mass[i] == 0 ? -1 : anchor_at[anchor];
    };
    RowStream& stream = new_stream();
    const BlockShape shape = vectors(RowKernel::limit, lanes_, width_);
    std::vector<int32_t> anchors(lanes_, -1);  // of the block that is laid out
    for (uint32_t y = 0; y < height_; ++y) {
      stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
      uint32_t block = 0;
      cover_row(
          shape, y, [&](uint32_t x) { return anchor_of(size_t{y} * width_ + x) >= 0; },
          [&](uint32_t first) {
            add_limits(stream, block, anchors);
            block = first;
          },
          [&](uint32_t lane, uint32_t x) { anchors[lane] = anchor_of(size_t{y} * width_ + x); });
      add_limits(stream, block, anchors);
    }
    stream.row_first.push_back(static_cast<uint32_t>(stream.pixel.size()));
    find_neighbouring_anchors(stream);
    return SweepOp{.kernel = RowKernel::limit, .stream = &stream};
  }

  void find_neighbouring_anchors(RowStream& stream) const {
    for (size_t y = 0; y < height_; ++y) {
      bool beside = true;
      for (size_t n = size_t{stream.row_first[y]} * lanes_; n < size_t{stream.row_first[y + 1]} * lanes_; ++n) {
        const bool held = std::isfinite(stream.constants[n]);
        beside = beside && (!held || stream.anchors[n] == static_cast<int32_t>(n % lanes_));
      }
      stream.beside.push_back(beside ? 1 : 0);
    }
  }

  /// From which on a vector's anchors are chosen: the one that is the first lane's if all lie beside each other, else
  /// the smallest one; below 0: there are none.
  static int32_t first_of_anchors(const std::vector<int32_t>& anchors) {
    int32_t smallest = -1, first = -1;
    bool beside = true;
    for (size_t lane = 0; lane < anchors.size(); ++lane) {
      if (anchors[lane] < 0) continue;
      const int32_t own = anchors[lane] - static_cast<int32_t>(lane);
      if (smallest < 0) first = own;
      smallest = smallest < 0 ? anchors[lane] : std::min(smallest, anchors[lane]);
      beside = beside && own == first;
    }
    return beside && first >= 0 ? first : smallest;
  }

  /// Lays out one block for each range of anchors that its lanes need, and takes them out of the list.
  void add_limits(RowStream& stream, uint32_t pixel, std::vector<int32_t>& anchors) const {
    for (;;) {
      const int32_t first = first_of_anchors(anchors);
      if (first < 0) return;
      stream.pixel.push_back(pixel);
      stream.first_anchor.push_back(static_cast<uint32_t>(first));
      for (uint32_t lane = 0; lane < lanes_; ++lane) {
        const bool taken = anchors[lane] >= 0 && anchors[lane] - first < static_cast<int32_t>(lanes_);
        stream.constants.push_back(taken ? state_.attachments[pixel + lane].reach * cloth_.params.stretch_limit
                                         : std::numeric_limits<float>::infinity());
        stream.anchors.push_back(taken ? anchors[lane] - first : 0);
        if (taken) anchors[lane] = -1;
      }
    }
  }

  const ClothState& state_;
  const ClothFrame& cloth_;
  const std::vector<Run>& runs_;
  uint32_t relaxation_steps_;
  bool in_bands_;
  uint32_t lanes_, width_, height_;
  uint32_t strip_;
  std::unique_ptr<SweepPlan> plan_ = std::make_unique<SweepPlan>();
  std::array<RowStream*, 2> run_streams_{};                        ///< of pixels, of whole vectors
  std::map<std::pair<Pass, uint32_t>, SweepOp> first_relaxation_;  ///< of what comes again, by pass and group
  std::vector<Reach> reaches_;                                     ///< of the sweep that is being made
};

std::unique_ptr<SweepPlan> SweepPlan::make(const ClothState& state, const std::vector<PassStep>& substep,
                                           const ClothFrame& cloth, const std::vector<Run>& runs,
                                           uint32_t relaxation_steps, bool in_bands) {
  for (uint32_t lanes = vector_lanes(); lanes >= 4; lanes /= 2) {
    if (!SweepPlanner::wide_enough(state.data.width, lanes)) continue;
    return SweepPlanner(state, cloth, runs, relaxation_steps, in_bands, lanes).run(substep);
  }
  return nullptr;
}

size_t SweepPlan::memory_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values.front()); };
  size_t sum = 0;
  for (const auto& s : streams_) {
    sum += bytes(s->row_first) + bytes(s->group_first) + bytes(s->pixel) + bytes(s->beside) + bytes(s->constants) +
           bytes(s->multipliers) + bytes(s->anchors) + bytes(s->first_anchor) + bytes(s->runs) + bytes(s->thirds);
  }
  for (const LineStream& s : lines_) sum += bytes(s.blocks) + bytes(s.constants);
  return sum;
}

size_t SweepPlan::bytes_per_substep() const {
  constexpr size_t kPoint = 3 * sizeof(float);
  size_t pixels = 0;
  for (const auto& s : streams_)
    for (const Run& run : s->runs) pixels += run.last - run.first;
  size_t sum = 0;
  for (const Part& part : parts_) {
    if (!std::holds_alternative<Sweep>(part)) continue;
    bool moves_history = false;
    for (const SweepOp& op : std::get<Sweep>(part).ops) {
      moves_history = moves_history || op.kernel == RowKernel::predict || op.kernel == RowKernel::collide ||
                      op.kernel == RowKernel::hold_way;
      sum += sizeof(float) * (op.stream->constants.size() + op.stream->anchors.size()) +
             sizeof(uint32_t) * op.stream->pixel.size();
      if (op.kernel == RowKernel::normals) sum += pixels * (sizeof(uint32_t) + kPoint + sizeof(float));
    }
    sum += pixels * (2 * kPoint + sizeof(float));         // position both ways, inverse mass
    if (moves_history) sum += pixels * (2 * kPoint * 2);  // previous and carry both ways
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
