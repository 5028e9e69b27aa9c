// SPDX-License-Identifier: Apache-2.0
// Bands of rows: each thread sweeps through its own, and has to wait for its neighbours only twice in a sweep, long
// after they have done what it waits for (the borders between the bands go up and down with the passes; Frigo and
// Strumpen 2005, "Cache oblivious stencil computations").
//
//   rows ->           upper band | lower band
//   first pass        body       |head | body
//                     body    :tail|head | body     A pass that leads over a border from the row before it has to wait
//                     body  :tail   |head| body     for the other band, and so has what later passes do to those rows.
//                     body:  tail   |rest|body      Many do not: a group of springs has only every second row.
//   last pass         body: tail |  rest | body

#include "cpu/bands.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>

namespace geocloth::cpu {
namespace {

using Kind = BandTask::Kind;

/// Entries of the list that a pass goes through.
size_t length_of(const PassStep& step, const ClothState& state) {
  if (is_over_seams(step.pass))
    return state.data.seam_color_offset[step.group + 1] - state.data.seam_color_offset[step.group];
  const bool over_rows = step.pass == Pass::stitch || step.pass == Pass::normals_stitch;
  return over_rows ? state.data.split_rows() : state.pixel_count();
}

bool runs_alone(const PassStep& step, const ClothState& state) {
  return step.pass == Pass::check_copies || step.pass == Pass::check_colliders || length_of(step, state) <= kRowGrain;
}

/// A pass at a border. Rows count from 0, and may be outside the image.
struct BorderRows {
  int32_t inner;  ///< the band above goes up to here by itself,
  int32_t edge;   ///< and up to here when the band below has done
  int32_t head;   ///< what it does before this row, from
  int32_t own;    ///< here on; the rows between `edge` and this one follow last
};
/// A border in a sweep.
struct Border {
  std::vector<BorderRows> passes;
  int32_t first = 0, last = 0;  ///< rows that what waits for others touches: first <= y < last
};

/// A sweep's passes, row by row.
class SweepRows {
 public:
  /// @param repeated  the same sweep comes next, and may begin where this one has ended
  SweepRows(const Sweep& sweep, uint32_t height, bool repeated)
      : sweep_(sweep), height_(static_cast<int32_t>(height)), repeated_(repeated) {
    for (const SweepOp& op : sweep.ops) {
      work_.emplace_back(height + 1, 0);
      for (uint32_t y = 0; y < height; ++y) work_.back()[y + 1] = work_.back()[y] + work_in(op, y);
    }
  }

  [[nodiscard]] Border border(uint32_t row) const {
    const auto b = static_cast<int32_t>(row);
    const size_t count = sweep_.ops.size();
    Border border{std::vector<BorderRows>(count), b, b};
    // Up to here others come first: of the band above for the one below, and the other way round.
    int32_t above = b, below = b;
    for (size_t k = 0; k < count; ++k) {
      const SweepOp& op = sweep_.ops[k];
      BorderRows& rows = border.passes[k];
      rows.own = above + up(op);
      rows.inner = below - down(op);
      above = std::max(above, touched_before(op, rows.own));
      below = std::min(below, touched_from(op, rows.inner));
    }
    // What later passes of the band above touch: earlier ones may not leave it to the rest, and it waits for it.
    int32_t edge = b, head = 0;
    for (size_t k = count; k-- > 0;) {
      const SweepOp& op = sweep_.ops[k];
      BorderRows& rows = border.passes[k];
      rows.edge = repeated_ ? std::min(rows.own, edge + up(op)) : rows.own;
      edge = std::max(edge, touched_before(op, rows.edge));
      if (op.spills) head = std::max(head, touched_before(op, rows.edge));
      rows.head = std::max(rows.own, head + up(op));
      head = std::max(head, touched_before(op, rows.edge));
      const int32_t of_head = touched_before(op, rows.head);
      if (of_head > rows.own + down(op)) head = std::max(head, of_head);  // it has some
      border.first = std::min(border.first, touched_from(op, rows.inner));
      border.last = std::max(border.last, touched_before(op, rows.head));
    }
    return border;
  }

  /// What the passes have to do in the rows first <= y < last of each, in springs of a vector.
  template <class First, class Last>
  [[nodiscard]] int64_t work(const Border& border, const First& first, const Last& last) const {
    int64_t sum = 0;
    for (size_t k = 0; k < border.passes.size(); ++k) {
      const int32_t from = clamped(first(border.passes[k])), to = clamped(last(border.passes[k]));
      if (from < to) sum += work_[k][static_cast<size_t>(to)] - work_[k][static_cast<size_t>(from)];
    }
    return sum;
  }
  [[nodiscard]] int64_t work_before(uint32_t row) const {
    int64_t sum = 0;
    for (const std::vector<int64_t>& of_pass : work_) sum += of_pass[row];
    return sum;
  }

  /// Rows of a task of a band between two borders, or none at the image's ends.
  [[nodiscard]] SweepBand rows_of(Kind kind, const Border* upper, const Border* lower) const {
    SweepBand band{{}, std::numeric_limits<uint32_t>::max(), 0, {}};
    for (size_t k = 0; k < sweep_.ops.size(); ++k) {
      const BorderRows nothing_above{0, 0, 0, 0}, nothing_below{height_, height_, height_, height_};
      const BorderRows& above = upper != nullptr ? upper->passes[k] : nothing_above;
      const BorderRows& below = lower != nullptr ? lower->passes[k] : nothing_below;
      const RowRange rows = kind == Kind::head   ? range(above.own, above.head)
                            : kind == Kind::body ? range(above.head, below.inner)
                            : kind == Kind::tail ? range(below.inner, below.edge)
                                                 : range(above.edge, above.own);
      band.rows.push_back(rows);
      if (rows.first >= rows.last) continue;
      band.first_time = std::min(band.first_time, rows.first + sweep_.ops[k].lag);
      band.end_time = std::max(band.end_time, rows.last + sweep_.ops[k].lag);
    }
    return band;
  }

 private:
  static int32_t up(const SweepOp& op) { return static_cast<int32_t>(op.up); }
  static int32_t down(const SweepOp& op) { return static_cast<int32_t>(op.down); }
  [[nodiscard]] int32_t clamped(int32_t row) const { return std::clamp(row, 0, height_); }
  [[nodiscard]] RowRange range(int32_t first, int32_t last) const {
    return {static_cast<uint32_t>(clamped(first)), static_cast<uint32_t>(clamped(last))};
  }
  static bool works_in(const SweepOp& op, int32_t row) {
    const std::vector<uint32_t>& first = op.stream->row_first;
    return first[static_cast<size_t>(row)] < first[static_cast<size_t>(row) + 1];
  }
  /// End of what a pass touches in the rows before one.
  [[nodiscard]] int32_t touched_before(const SweepOp& op, int32_t row) const {
    int32_t y = clamped(row);
    while (y > 0 && !works_in(op, y - 1)) --y;
    return y > 0 ? y + down(op) : 0;
  }
  /// First row that a pass touches from one on.
  [[nodiscard]] int32_t touched_from(const SweepOp& op, int32_t row) const {
    int32_t y = clamped(row);
    while (y < height_ && !works_in(op, y)) ++y;
    return y < height_ ? y - up(op) : height_;
  }
  [[nodiscard]] int64_t work_in(const SweepOp& op, uint32_t y) const {
    constexpr int64_t kSpring = 2;  // others take half of a spring's time, predict all of it
    const RowStream& stream = *op.stream;
    const uint32_t first = stream.row_first[y], last = stream.row_first[y + 1];
    if (stream.runs.empty()) {
      const bool half = op.kernel == RowKernel::limit || op.kernel == RowKernel::spans_along ||
                        op.kernel == RowKernel::short_spans_along;
      return int64_t{last - first} * (half ? 1 : kSpring);
    }
    int64_t pixels = 0;
    for (uint32_t k = first; k < last; ++k) pixels += stream.runs[k].last - stream.runs[k].first;
    const bool whole = op.kernel == RowKernel::predict || op.kernel == RowKernel::normals;
    return (whole ? kSpring : 1) * pixels / kPixels;
  }
  static constexpr int64_t kPixels = 16;  ///< that take as long as a block

  const Sweep& sweep_;
  int32_t height_;
  bool repeated_;
  std::vector<std::vector<int64_t>> work_;  ///< of each pass, in the rows before
};

/// Where bands end that have as much to do as others, and wait little for each other.
class BorderSearch {
 public:
  BorderSearch(const SweepPlan& plan, uint32_t height) : height_(height) {
    for (const SweepPlan::Part& part : plan.parts()) {
      const auto* sweep = std::get_if<Sweep>(&part);
      if (sweep != nullptr) sweeps_.emplace_back(*sweep, height, plan.parts().size() == 1);
    }
  }
  [[nodiscard]] const std::vector<SweepRows>& sweeps() const { return sweeps_; }

  /// About as many bands as there is room for, or more: each holds what waits at a border.
  [[nodiscard]] uint32_t most() const {
    int32_t longest = 1;
    for (const SweepRows& sweep : sweeps_) {
      const Border border = sweep.border(height_ / 2);
      longest = std::max(longest, border.last - border.first);
    }
    return height_ / static_cast<uint32_t>(longest) + 2;
  }

  /// @return rows, or nothing when there is no room for so many bands
  [[nodiscard]] std::vector<uint32_t> rows(uint32_t count) const {
    std::vector<uint32_t> rows{0};
    for (uint32_t k = 1; k < count; ++k) {
      const uint32_t row = best(k, count);
      if (row <= rows.back() || !has_room(rows.back(), row)) return {};
      rows.push_back(row);
    }
    rows.push_back(height_);
    return rows;
  }

 private:
  /// Rows up to which others than the most even one are looked at: spans begin every 16 rows.
  static constexpr uint32_t kAround = 16;

  [[nodiscard]] uint32_t best(uint32_t k, uint32_t count) const {
    uint32_t even = 0;
    const auto before = [&](uint32_t row) {
      int64_t sum = 0;
      for (const SweepRows& sweep : sweeps_) sum += sweep.work_before(row);
      return sum;
    };
    while (even < height_ && before(even) * count < before(height_) * k) ++even;
    uint32_t row = 0;
    int64_t least = std::numeric_limits<int64_t>::max();
    for (uint32_t r = even > kAround ? even - kAround : 1; r < std::min(height_, even + kAround); ++r) {
      const int64_t own = cost(r, k, count);
      if (own < least) row = r;
      least = std::min(least, own);
    }
    return row;
  }

  /// What the sweeps take with two bands here.
  [[nodiscard]] int64_t cost(uint32_t row, uint32_t k, uint32_t count) const {
    using Rows = BorderRows;
    int64_t sum = 0;
    for (const SweepRows& sweep : sweeps_) {
      const Border border = sweep.border(row);
      const auto zero = [](const Rows&) { return 0; };
      const auto edge = [](const Rows& r) { return r.edge; };
      const auto own = [](const Rows& r) { return r.own; };
      const int64_t all = sweep.work_before(height_), before = sweep.work(border, zero, edge);
      const int64_t head = sweep.work(border, own, [](const Rows& r) { return r.head; });
      const int64_t tail = sweep.work(
          border, [](const Rows& r) { return r.inner; }, edge);
      const int64_t rest = sweep.work(border, edge, own);
      // One follows the other, and what is another thread's has to be fetched.
      const int64_t longest = std::max(all / count + std::abs(before - all * k / count), head + tail + rest);
      sum += longest + (tail + rest) / 4;
    }
    return sum;
  }

  /// For what waits at two borders.
  [[nodiscard]] bool has_room(uint32_t upper, uint32_t lower) const {
    return upper == 0 || std::all_of(sweeps_.begin(), sweeps_.end(), [&](const SweepRows& sweep) {
             return sweep.border(upper).last <= sweep.border(lower).first;
           });
  }

  uint32_t height_;
  std::vector<SweepRows> sweeps_;
};

std::vector<SweepBand> bands_of(const SweepPlan& plan, const BorderSearch& search, const BandPlan& bands) {
  constexpr std::array kKinds{Kind::head, Kind::body, Kind::tail, Kind::rest};
  std::vector<SweepBand> all;
  auto rows = search.sweeps().begin();
  for (const SweepPlan::Part& part : plan.parts()) {
    if (!std::holds_alternative<Sweep>(part)) {
      all.resize(all.size() + size_t{bands.count()} * kKinds.size());
      continue;
    }
    std::vector<Border> borders;
    for (const uint32_t row : bands.rows) borders.push_back(rows->border(row));
    for (uint32_t band = 0; band < bands.count(); ++band) {
      const Border* const upper = band > 0 ? &borders[band] : nullptr;
      const Border* const lower = band + 1 < bands.count() ? &borders[band + 1] : nullptr;
      for (const Kind kind : kKinds) {
        all.push_back(rows->rows_of(kind, upper, lower));
        lay_turns(std::get<Sweep>(part), all.back());
      }
    }
    ++rows;
  }
  return all;
}

}  // namespace

BandPlan plan_bands(const SweepPlan& plan, const ClothState& state, uint32_t threads) {
  const BorderSearch search(plan, state.data.height);
  BandPlan bands;
  for (uint32_t count = std::min(threads, search.most()); bands.rows.empty(); --count) bands.rows = search.rows(count);
  for (uint32_t k = 0; k < plan.parts().size(); ++k) {
    const auto* step = std::get_if<PassStep>(&plan.parts()[k]);
    if (step == nullptr) {
      bands.tasks.push_back({Kind::head, plan.parts().size() > 1, k, k + 1});
      for (const Kind kind : {Kind::body, Kind::tail, Kind::rest}) bands.tasks.push_back({kind, false, k, k + 1});
    } else if (!runs_alone(*step, state)) {
      bands.tasks.push_back({Kind::share, true, k, k + 1});
    } else if (!bands.tasks.empty() && bands.tasks.back().kind == Kind::alone) {
      ++bands.tasks.back().last_part;
    } else {
      bands.tasks.push_back({Kind::alone, true, k, k + 1});
    }
  }
  bands.sweeps = bands_of(plan, search, bands);
  return bands;
}

}  // namespace geocloth::cpu
