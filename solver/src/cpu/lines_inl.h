// SPDX-License-Identifier: Apache-2.0
// Line relaxation in vectors: as many lines side by side as a vector has lanes. Columns lie so in memory. Of rows, four
// columns at a time are turned: 128 bits of each row, by shuffles that stay within them.
#if defined(GEOCLOTH_CPU_LINES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_LINES_INL_H
#undef GEOCLOTH_CPU_LINES_INL_H
#else
#define GEOCLOTH_CPU_LINES_INL_H
#endif

#include <array>

#include "cpu/constraints_inl.h"
#include "lib/lines.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// Where a line's points are: one of each lane, and from there to the next ones.
struct LinePoints {
  PointRow positions, ways;
  size_t next;

  [[nodiscard]] HWY_INLINE PointRow position(size_t k) const { return after(positions, k * next); }
  [[nodiscard]] HWY_INLINE PointRow way(size_t k) const { return after(ways, k * next); }
};

/// A block whose lines are swept along: what the plan laid out for it, and what the sweeps keep of each point and the
/// spring that begins there.
template <class D>
class LineSweep {
 public:
  HWY_INLINE LineSweep(const LineStream& stream, const LineBlock& block, const LinePoints& points, float* kept)
      : points_(points), constants_(stream.constants.data() + block.constants), kept_(kept), count_(block.points) {}

  /// 2 at least.
  [[nodiscard]] HWY_INLINE size_t count() const { return count_; }
  [[nodiscard]] HWY_INLINE PointRow position(size_t k) const { return points_.position(k); }
  [[nodiscard]] HWY_INLINE PointRow way(size_t k) const { return points_.way(k); }

  [[nodiscard]] HWY_INLINE Vec<D> weight(size_t k) const { return hn::LoadU(D(), constants(k)); }
  /// [m^2] 0: no spring begins there.
  [[nodiscard]] HWY_INLINE Vec<D> longest2(size_t k) const { return hn::LoadU(D(), constants(k) + kLanes); }
  [[nodiscard]] HWY_INLINE Mask<D> has_way(size_t k) const {
    return hn::Gt(hn::LoadU(D(), constants(k) + 2 * kLanes), hn::Zero(D()));
  }

  /// Of line_point() in lib/lines.h.
  [[nodiscard]] HWY_INLINE PointRow place(size_t k) const { return vector(k, 0); }
  [[nodiscard]] HWY_INLINE PointRow evened_way(size_t k) const { return vector(k, 3); }
  /// Of the spring, and after the sweep back of the point.
  [[nodiscard]] HWY_INLINE float* coupling(size_t k) const { return kept(k) + 6 * kLanes; }
  [[nodiscard]] HWY_INLINE float* multiplier(size_t k) const { return kept(k) + 7 * kLanes; }

 private:
  static constexpr size_t kLanes = hn::MaxLanes(D());
  [[nodiscard]] HWY_INLINE const float* constants(size_t k) const { return constants_ + kLineFloats * kLanes * k; }
  [[nodiscard]] HWY_INLINE float* kept(size_t k) const { return kept_ + kLineKept * kLanes * k; }
  [[nodiscard]] HWY_INLINE PointRow vector(size_t k, size_t first) const {
    float* const p = kept(k) + first * kLanes;
    return {p, p + kLanes, p + 2 * kLanes};
  }

  LinePoints points_;
  const float* constants_;
  float* kept_;
  size_t count_;
};

/// The springs of a block, one by one: line_spring() of lib/lines.h.
template <class D>
class FindSprings {
 public:
  HWY_INLINE FindSprings(D d, const LineSweep<D>& sweep, Vec<D> diagonal)
      : sweep_(sweep), before_(set(d, 0, 0, 0)), inverse_(hn::Zero(d)), multiplier_(hn::Zero(d)), diagonal_(diagonal) {}

  [[nodiscard]] HWY_INLINE size_t turns() const { return sweep_.count() - 1; }
  HWY_INLINE void turn(D d, size_t k) {
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.F);
    const auto longest2 = sweep_.longest2(k), weight = sweep_.weight(k), weight_b = sweep_.weight(k + 1);
    const Points<D> way =
        only<D>(hn::Gt(longest2, zero), sub(load(d, sweep_.position(k + 1)), load(d, sweep_.position(k))));
    const auto l2 = dot(d, way, way);
    const auto along = dot(d, before_, way);
    const auto beside = hn::Neg(hn::Mul(weight, along));
    const auto coupling = hn::Mul(beside, inverse_);
    const auto bend = hn::Sub(l2, along);
    const auto bends = hn::And(hn::Gt(inverse_, zero), hn::Gt(bend, zero));
    const auto aside = hn::Mul(weight, hn::IfThenElseZero(bends, bend));
    const auto diagonal = hn::Mul(hn::Mul(hn::Add(weight, weight_b), l2), diagonal_);
    const auto pivot = hn::Sub(hn::Add(diagonal, aside), hn::Mul(beside, coupling));
    inverse_ = hn::IfThenElseZero(hn::Gt(pivot, zero), hn::Div(one, pivot));
    const auto excess = hn::Sub(l2, longest2);
    const auto error = hn::IfThenElseZero(hn::Gt(excess, zero), hn::Mul(hn::Set(d, 0.5F), excess));
    multiplier_ = hn::Mul(hn::Sub(error, hn::Mul(beside, multiplier_)), inverse_);
    hn::StoreU(coupling, d, sweep_.coupling(k));
    hn::StoreU(multiplier_, d, sweep_.multiplier(k));
    assign(before_, way);
  }

 private:
  const LineSweep<D> sweep_;
  Points<D> before_;
  Vec<D> inverse_, multiplier_, diagonal_;
};

/// Multipliers from the last one on, and the points of line_point() in lib/lines.h. What is read again of the point
/// after is left to memory: two blocks have more of it than there are registers.
template <class D>
class FindMultipliers {
 public:
  HWY_INLINE FindMultipliers(D d, const LineSweep<D>& sweep)
      : sweep_(sweep), multiplier_(hn::Zero(d)), pull_(hn::Zero(d)), coupling_(hn::Zero(d)) {
    const size_t last = sweep.count() - 1;
    const Points<D> none = set(d, 0, 0, 0);
    point(d, last, hn::LoadU(d, sweep_.multiplier(last - 1)), none, none);
  }

  [[nodiscard]] HWY_INLINE size_t turns() const { return sweep_.count() - 2; }
  HWY_INLINE void turn(D d, size_t n) {
    const size_t k = sweep_.count() - 2 - n;
    const auto before =
        hn::Sub(hn::LoadU(d, sweep_.multiplier(k - 1)), hn::Mul(hn::LoadU(d, sweep_.coupling(k)), multiplier_));
    point(d, k, before, load(d, sweep_.place(k + 1)), load(d, sweep_.evened_way(k + 1)));
  }
  HWY_INLINE void last(D d) { point(d, 0, hn::Zero(d), load(d, sweep_.place(1)), load(d, sweep_.evened_way(1))); }

 private:
  HWY_INLINE void point(D d, size_t k, Vec<D> before, const Points<D>& place_of_next, const Points<D>& way_of_next) {
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.F);
    const auto s = hn::Mul(hn::Set(d, shader::kLineSmoothing), sweep_.weight(k));
    const auto pull_before = hn::IfThenElseZero(hn::Gt(before, zero), before);
    const auto a = hn::Mul(s, pull_before), b = hn::Mul(s, pull_);
    const auto share = hn::Div(one, hn::Add(hn::Add(one, a), hn::Sub(b, hn::Mul(b, coupling_))));
    coupling_ = hn::Mul(a, share);
    hn::StoreU(coupling_, d, sweep_.coupling(k));
    hn::StoreU(multiplier_, d, sweep_.multiplier(k));
    multiplier_ = before;
    pull_ = pull_before;
    const Points<D> place = scale(d, add(load(d, sweep_.position(k)), scale(d, place_of_next, b)), share);
    store(d, place, sweep_.place(k));
    const Points<D> own_way = only<D>(sweep_.has_way(k), load(d, sweep_.way(k)));
    store(d, scale(d, add(own_way, scale(d, way_of_next, b)), share), sweep_.evened_way(k));
  }

  const LineSweep<D> sweep_;
  Vec<D> multiplier_, pull_, coupling_;
};

/// What all points come to: line_step() and line_moved() of lib/lines.h.
template <class D>
class MovePoints {
 public:
  HWY_INLINE MovePoints(D d, const LineSweep<D>& sweep)
      : sweep_(sweep),
        step_before_(set(d, 0, 0, 0)),
        place_(load(d, sweep.place(0))),
        way_(load(d, sweep.evened_way(0))) {}

  [[nodiscard]] HWY_INLINE size_t turns() const { return sweep_.count() - 1; }
  HWY_INLINE void turn(D d, size_t k) {
    const auto zero = hn::Zero(d), tiny = hn::Set(d, 1e-20F);
    const auto coupling = hn::LoadU(d, sweep_.coupling(k + 1));
    const Points<D> place = add(load(d, sweep_.place(k + 1)), scale(d, place_, coupling));
    const Points<D> way_to_next = sub(load(d, sweep_.position(k + 1)), load(d, sweep_.position(k)));
    const Points<D> after_step = sub(place, place_);
    const Points<D> turned = add(way_to_next, scale(d, sub(after_step, way_to_next), hn::Set(d, shader::kLineTurn)));
    const auto l2 = dot(d, turned, turned), along = dot(d, way_to_next, turned);
    const auto share = hn::IfThenElseZero(hn::Gt(l2, tiny), hn::Div(along, l2));
    const auto factor = hn::Mul(hn::LoadU(d, sweep_.multiplier(k)), share);
    const Points<D> step = only<D>(hn::Gt(sweep_.longest2(k), zero), scale(d, turned, factor));
    move(d, k, step);
    assign(way_, add(load(d, sweep_.evened_way(k + 1)), scale(d, way_, coupling)));
    assign(place_, place);
    assign(step_before_, step);
  }
  HWY_INLINE void last(D d) { move(d, turns(), set(d, 0, 0, 0)); }

 private:
  HWY_INLINE void move(D d, size_t k, const Points<D>& step) {
    const auto weight = sweep_.weight(k);
    const auto moves = hn::Gt(weight, hn::Zero(d));
    const PointRow position = sweep_.position(k), way = sweep_.way(k);
    const Points<D> from = load(d, position);
    store(d, choose<D>(moves, add(from, scale(d, sub(step, step_before_), weight)), from), position);
    store(d, choose<D>(moves, way_, load(d, way)), way);
  }

  const LineSweep<D> sweep_;
  Points<D> step_before_, place_, way_;
};

/// All turns of two blocks, one of each at a time: what comes next along a line waits for a division of what was
/// before, and the other block has work meanwhile.
template <class D, class Sweep>
HWY_INLINE void take_turns(D d, Sweep& one, Sweep& other) {
  const size_t both = std::min(one.turns(), other.turns());
  for (size_t k = 0; k < both; ++k) {
    one.turn(d, k);
    other.turn(d, k);
  }
  for (size_t k = both; k < one.turns(); ++k) one.turn(d, k);
  for (size_t k = both; k < other.turns(); ++k) other.turn(d, k);
}
template <class D, class Sweep>
HWY_INLINE void take_turns(D d, Sweep& only) {
  for (size_t k = 0; k < only.turns(); ++k) only.turn(d, k);
}

/// Springs and multipliers of a block, or of two.
template <class D, class... Lines>
HWY_NOINLINE void find_pulls(D d, float diagonal, const Lines&... lines) {
  [&](auto... springs) GEOCLOTH_LANES { take_turns(d, springs...); }(FindSprings<D>(d, lines, hn::Set(d, diagonal))...);
  [&](auto... multipliers) GEOCLOTH_LANES {
    take_turns(d, multipliers...);
    (multipliers.last(d), ...);
  }(FindMultipliers<D>(d, lines)...);
}
template <class D>
HWY_NOINLINE void move_points(D d, const LineSweep<D>& lines) {
  MovePoints<D> points(d, lines);
  take_turns(d, points);
  points.last(d);
}

/// Blocks of columns.
template <class D>
class ColumnBlock {
 public:
  HWY_INLINE ColumnBlock(D /*d*/, const LineStream& stream, ClothState& state, float* kept, const LineBlock& block)
      : lines_(stream, block, {at(state.position, block.first), at(state.previous, block.first), state.data.width},
               kept) {}
  [[nodiscard]] HWY_INLINE const LineSweep<D>& lines() const { return lines_; }
  HWY_INLINE void fetch(D /*d*/) const {}
  HWY_INLINE void put_back(D /*d*/) const {}

 private:
  LineSweep<D> lines_;
};

/// From rows to columns, or back, in each 128 bits: the i-th vector holds of every four rows the i-th.
template <class D>
HWY_INLINE void turn(D d, Vec<D>& v0, Vec<D>& v1, Vec<D>& v2, Vec<D>& v3) {
  const hn::Repartition<uint64_t, D> pairs;
  const auto low01 = hn::BitCast(pairs, hn::InterleaveLower(d, v0, v1));
  const auto low23 = hn::BitCast(pairs, hn::InterleaveLower(d, v2, v3));
  const auto high01 = hn::BitCast(pairs, hn::InterleaveUpper(d, v0, v1));
  const auto high23 = hn::BitCast(pairs, hn::InterleaveUpper(d, v2, v3));
  v0 = hn::BitCast(d, hn::InterleaveLower(pairs, low01, low23));
  v1 = hn::BitCast(d, hn::InterleaveUpper(pairs, low01, low23));
  v2 = hn::BitCast(d, hn::InterleaveLower(pairs, high01, high23));
  v3 = hn::BitCast(d, hn::InterleaveUpper(pairs, high01, high23));
}

/// Rows of a block: those that a vector has no more lines for are read from the last one and not written.
struct LineRows {
  size_t width, count;
};
/// Four columns of the rows first, first + 4, ..
template <class D>
HWY_INLINE Vec<D> every_fourth(D d, const LineRows& rows, size_t first, const float* p) {
  if constexpr (hn::MaxLanes(D()) == kTurned) {
    return hn::LoadU(d, p + std::min(first, rows.count - 1) * rows.width);
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, every_fourth(half, rows, first + hn::MaxLanes(D()) / 2, p),
                       every_fourth(half, rows, first, p));
  }
}
template <class D>
HWY_INLINE void put_every_fourth(D d, Vec<D> v, const LineRows& rows, size_t first, float* p) {
  if constexpr (hn::MaxLanes(D()) == kTurned) {
    if (first < rows.count) hn::StoreU(v, d, p + first * rows.width);
  } else {
    const hn::Half<D> half;
    put_every_fourth(half, hn::LowerHalf(half, v), rows, first, p);
    put_every_fourth(half, hn::UpperHalf(half, v), rows, first + hn::MaxLanes(D()) / 2, p);
  }
}

/// Blocks of rows, whose points are kept as columns while they are swept along.
template <class D>
class RowBlock {
 public:
  HWY_INLINE RowBlock(D /*d*/, const LineStream& stream, ClothState& state, float* kept, const LineBlock& block)
      : rows_{state.data.width, block.lines},
        positions_(at(state.position, block.first)),
        ways_(at(state.previous, block.first)),
        lines_(stream, block, {vector(kept, 0), vector(kept, 3), kNext}, kept + kNext * block.points) {}
  [[nodiscard]] HWY_INLINE const LineSweep<D>& lines() const { return lines_; }

  HWY_INLINE void fetch(D d) const {
    for (size_t k = 0; k < lines_.count(); k += kTurned) {
      fetch(d, after(positions_, k), lines_.position(k));
      fetch(d, after(ways_, k), lines_.way(k));
    }
  }
  HWY_INLINE void put_back(D d) const {
    for (size_t k = 0; k < lines_.count(); k += kTurned) {
      put_back(d, lines_.position(k), after(positions_, k));
      put_back(d, lines_.way(k), after(ways_, k));
    }
  }

 private:
  static constexpr size_t kLanes = hn::MaxLanes(D());
  static constexpr size_t kNext = kLineTurned * kLanes;
  static HWY_INLINE PointRow vector(float* kept, size_t first) {
    return {kept + first * kLanes, kept + (first + 1) * kLanes, kept + (first + 2) * kLanes};
  }

  HWY_INLINE void fetch(D d, const float* from, float* to) const {
    auto v0 = every_fourth(d, rows_, 0, from), v1 = every_fourth(d, rows_, 1, from);
    auto v2 = every_fourth(d, rows_, 2, from), v3 = every_fourth(d, rows_, 3, from);
    turn(d, v0, v1, v2, v3);
    hn::StoreU(v0, d, to);
    hn::StoreU(v1, d, to + kNext);
    hn::StoreU(v2, d, to + 2 * kNext);
    hn::StoreU(v3, d, to + 3 * kNext);
  }
  HWY_INLINE void fetch(D d, const PointRow& from, const PointRow& to) const {
    fetch(d, from.x, to.x);
    fetch(d, from.y, to.y);
    fetch(d, from.z, to.z);
  }
  HWY_INLINE void put_back(D d, const float* from, float* to) const {
    auto v0 = hn::LoadU(d, from), v1 = hn::LoadU(d, from + kNext);
    auto v2 = hn::LoadU(d, from + 2 * kNext), v3 = hn::LoadU(d, from + 3 * kNext);
    turn(d, v0, v1, v2, v3);
    put_every_fourth(d, v0, rows_, 0, to);
    put_every_fourth(d, v1, rows_, 1, to);
    put_every_fourth(d, v2, rows_, 2, to);
    put_every_fourth(d, v3, rows_, 3, to);
  }
  HWY_INLINE void put_back(D d, const PointRow& from, const PointRow& to) const {
    put_back(d, from.x, to.x);
    put_back(d, from.y, to.y);
    put_back(d, from.z, to.z);
  }

  LineRows rows_;
  PointRow positions_, ways_;
  LineSweep<D> lines_;
};

/// Two blocks at a time.
template <template <class> class Block, class D>
HWY_NOINLINE void lines_of(D d, const LineStream& stream, ClothState& state, float* kept,
                           std::span<const LineBlock> blocks) {
  const size_t kept_of_one = line_kept(stream, static_cast<uint32_t>(hn::Lanes(d)));
  for (size_t k = 0; k < blocks.size(); k += 2) {
    const Block<D> one(d, stream, state, kept, blocks[k]);
    one.fetch(d);
    if (k + 1 < blocks.size()) {
      const Block<D> other(d, stream, state, kept + kept_of_one, blocks[k + 1]);
      other.fetch(d);
      find_pulls(d, stream.diagonal, one.lines(), other.lines());
      move_points(d, other.lines());
      other.put_back(d);
    } else {
      find_pulls(d, stream.diagonal, one.lines());
    }
    move_points(d, one.lines());
    one.put_back(d);
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
