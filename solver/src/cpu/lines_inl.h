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

/// What the plan laid out for a point and the spring that begins there, and what the sweep forth leaves.
template <class D>
struct LinePoint {
  HWY_INLINE LinePoint(D d, const LineStream& stream, float* all_kept, const LineBlock& block, size_t k) {
    const size_t lanes = hn::Lanes(d), first = block.constants + kLineFloats * lanes * k;
    const float* const constants = stream.constants.data() + first;
    weight = hn::LoadU(d, constants);
    longest = hn::LoadU(d, constants + lanes);
    kept = all_kept + first;
  }
  Vec<D> weight, longest;
  float* kept;  ///< coupling, multiplier
};

/// line_spring() of lib/lines.h for one point after another.
template <class D>
class SweepForth {
 public:
  HWY_INLINE SweepForth(D d, float diagonal)
      : d_before_(set(d, 0, 0, 0)), inverse_(hn::Zero(d)), multiplier_(hn::Zero(d)), diagonal_(hn::Set(d, diagonal)) {}
  /// @param a, b  the ends of a spring
  HWY_INLINE void next(D d, const Points<D>& a, const Points<D>& b, const LinePoint<D>& own, Vec<D> weight_b) {
    const auto zero = hn::Zero(d);
    const Points<D> way = only<D>(hn::Gt(own.longest, zero), sub(b, a));
    const auto l2 = dot(d, way, way);
    const auto along = dot(d, d_before_, way);
    const auto beside = hn::Neg(hn::Mul(own.weight, along));
    const auto coupling = hn::Mul(beside, inverse_);
    const auto bend = hn::Sub(l2, along);
    const auto bends = hn::And(hn::Gt(inverse_, zero), hn::Gt(bend, zero));
    const auto aside = hn::Mul(own.weight, hn::IfThenElseZero(bends, bend));
    const auto diagonal = hn::Mul(hn::Mul(hn::Add(own.weight, weight_b), l2), diagonal_);
    const auto pivot = hn::Sub(hn::Add(diagonal, aside), hn::Mul(beside, coupling));
    const auto exists = hn::Gt(pivot, zero);
    const auto one = hn::Set(d, 1.F);
    inverse_ = hn::IfThenElseZero(exists, hn::Div(one, hn::IfThenElse(exists, pivot, one)));
    const auto excess = hn::Sub(l2, hn::Mul(own.longest, own.longest));
    const auto error = hn::IfThenElseZero(hn::Gt(excess, zero), hn::Mul(hn::Set(d, 0.5F), excess));
    multiplier_ = hn::Mul(hn::Sub(error, hn::Mul(beside, multiplier_)), inverse_);
    d_before_ = way;
    hn::StoreU(coupling, d, own.kept);
    hn::StoreU(multiplier_, d, own.kept + hn::Lanes(d));
  }

 private:
  Points<D> d_before_;
  Vec<D> inverse_, multiplier_, diagonal_;
};

/// line_multiplier() and line_point(), from a line's end to its start.
template <class D>
class SweepBack {
 public:
  HWY_INLINE explicit SweepBack(D d)
      : step_of_next_(set(d, 0, 0, 0)), coupling_of_next_(hn::Zero(d)), multiplier_(hn::Zero(d)) {}
  /// @param a, b  the ends of a spring
  /// @return where its end goes
  HWY_INLINE Points<D> next(D d, const Points<D>& a, const Points<D>& b, const LinePoint<D>& own, Vec<D> weight_b) {
    multiplier_ = hn::Sub(hn::LoadU(d, own.kept + hn::Lanes(d)), hn::Mul(coupling_of_next_, multiplier_));
    coupling_of_next_ = hn::LoadU(d, own.kept);
    const Points<D> step = only<D>(hn::Gt(own.longest, hn::Zero(d)), scale(d, sub(b, a), multiplier_));
    const Points<D> moved = to(d, b, step, weight_b);
    step_of_next_ = step;
    return moved;
  }
  /// @return where the first point goes
  HWY_INLINE Points<D> last(D d, const Points<D>& a, Vec<D> weight) const { return to(d, a, set(d, 0, 0, 0), weight); }

 private:
  HWY_INLINE Points<D> to(D d, const Points<D>& p, const Points<D>& step_before, Vec<D> weight) const {
    return choose<D>(hn::Gt(weight, hn::Zero(d)), add(p, scale(d, sub(step_of_next_, step_before), weight)), p);
  }
  Points<D> step_of_next_;
  Vec<D> coupling_of_next_, multiplier_;
};

template <class D>
HWY_NOINLINE void columns_of(D d, const LineStream& stream, ClothState& state, float* kept, const LineBlock& block) {
  const size_t width = state.data.width, last = block.points - 1;
  const PointRow all = at(state.position, block.first);
  const auto row = [&](size_t k) GEOCLOTH_LANES { return after(all, k * width); };
  const auto point = [&](size_t k) GEOCLOTH_LANES { return LinePoint<D>(d, stream, kept, block, k); };
  SweepForth<D> forth(d, stream.diagonal);
  Points<D> a = load(d, all);
  for (size_t k = 0; k < last; ++k) {
    const Points<D> b = load(d, row(k + 1));
    forth.next(d, a, b, point(k), point(k + 1).weight);
    a = b;
  }
  SweepBack<D> back(d);
  Points<D> b = a;
  for (size_t k = last; k-- > 0;) {
    a = load(d, row(k));
    store(d, back.next(d, a, b, point(k), point(k + 1).weight), row(k + 1));
    b = a;
  }
  store(d, back.last(d, b, point(0).weight), all);
}

template <class D>
using Four = std::array<Vec<D>, kTurned>;

/// From rows to columns, or back, in each 128 bits: vector i holds of every four rows the i-th.
template <class D>
HWY_INLINE void turn(D d, Four<D>& v) {
  const hn::Repartition<uint64_t, D> pairs;
  const auto low01 = hn::BitCast(pairs, hn::InterleaveLower(d, v[0], v[1]));
  const auto low23 = hn::BitCast(pairs, hn::InterleaveLower(d, v[2], v[3]));
  const auto high01 = hn::BitCast(pairs, hn::InterleaveUpper(d, v[0], v[1]));
  const auto high23 = hn::BitCast(pairs, hn::InterleaveUpper(d, v[2], v[3]));
  v[0] = hn::BitCast(d, hn::InterleaveLower(pairs, low01, low23));
  v[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, low01, low23));
  v[2] = hn::BitCast(d, hn::InterleaveLower(pairs, high01, high23));
  v[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, high01, high23));
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

/// One coordinate of them, in memory: arrays of vectors are copied in pieces of 16 bytes, and to read them as a whole
/// vector then waits until they are written.
template <class D>
class FourColumnsOfOne {
 public:
  [[nodiscard]] HWY_INLINE Vec<D> at(D d, size_t i) const { return hn::Load(d, columns_.data() + i * kLanes); }
  HWY_INLINE void set(D d, size_t i, Vec<D> v) { hn::Store(v, d, columns_.data() + i * kLanes); }
  HWY_INLINE void read(D d, const LineRows& rows, const float* from) {
    Four<D> v{every_fourth(d, rows, 0, from), every_fourth(d, rows, 1, from), every_fourth(d, rows, 2, from),
              every_fourth(d, rows, 3, from)};
    turn(d, v);
    for (size_t i = 0; i < kTurned; ++i) set(d, i, v[i]);
  }
  HWY_INLINE void write(D d, const LineRows& rows, float* to) const {
    Four<D> v{at(d, 0), at(d, 1), at(d, 2), at(d, 3)};
    turn(d, v);
    for (size_t i = 0; i < kTurned; ++i) put_every_fourth(d, v[i], rows, i, to);
  }

 private:
  static constexpr size_t kLanes = hn::MaxLanes(D());
  HWY_ALIGN std::array<float, kTurned * kLanes> columns_;
};
template <class D>
struct FourColumns {
  FourColumnsOfOne<D> x, y, z;

  [[nodiscard]] HWY_INLINE Points<D> at(D d, size_t i) const { return {x.at(d, i), y.at(d, i), z.at(d, i)}; }
  HWY_INLINE void set(D d, size_t i, const Points<D>& p) {
    x.set(d, i, p.x);
    y.set(d, i, p.y);
    z.set(d, i, p.z);
  }
  HWY_INLINE void read(D d, const LineRows& rows, const PointRow& from) {
    x.read(d, rows, from.x);
    y.read(d, rows, from.y);
    z.read(d, rows, from.z);
  }
  HWY_INLINE void write(D d, const LineRows& rows, const PointRow& to) const {
    x.write(d, rows, to.x);
    y.write(d, rows, to.y);
    z.write(d, rows, to.z);
  }
};

template <class D>
HWY_NOINLINE void rows_of(D d, const LineStream& stream, ClothState& state, float* kept, const LineBlock& block) {
  const LineRows rows{state.data.width, block.lines};
  const PointRow all = at(state.position, block.first);
  const auto point = [&](size_t k) GEOCLOTH_LANES { return LinePoint<D>(d, stream, kept, block, k); };
  FourColumns<D> four;
  SweepForth<D> forth(d, stream.diagonal);
  four.read(d, rows, all);
  for (size_t k = 0;; k += kTurned) {
    for (size_t i = 0; i + 1 < kTurned; ++i)
      forth.next(d, four.at(d, i), four.at(d, i + 1), point(k + i), point(k + i + 1).weight);
    if (k + kTurned == block.points) break;
    const Points<D> a = four.at(d, kTurned - 1);
    four.read(d, rows, after(all, k + kTurned));
    forth.next(d, a, four.at(d, 0), point(k + kTurned - 1), point(k + kTurned).weight);
  }
  SweepBack<D> back(d);
  FourColumns<D> moved;
  for (size_t k = block.points - kTurned;; k -= kTurned) {  // `four` are the columns from k on
    for (size_t i = kTurned - 1; i-- > 0;)
      moved.set(d, i + 1, back.next(d, four.at(d, i), four.at(d, i + 1), point(k + i), point(k + i + 1).weight));
    const Points<D> b = four.at(d, 0);
    if (k == 0) {
      moved.set(d, 0, back.last(d, b, point(0).weight));
      return moved.write(d, rows, all);
    }
    four.read(d, rows, after(all, k - kTurned));
    moved.set(d, 0, back.next(d, four.at(d, kTurned - 1), b, point(k - 1), point(k).weight));
    moved.write(d, rows, after(all, k));
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
