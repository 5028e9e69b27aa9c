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

/// What the plan laid out for a point and the spring that begins there.
template <class D>
struct LineConstants {
  HWY_INLINE LineConstants(D d, const float* constants)
      : weight(hn::LoadU(d, constants)),
        longest(hn::LoadU(d, constants + hn::Lanes(d))),
        is_free(hn::Gt(hn::LoadU(d, constants + 2 * hn::Lanes(d)), hn::Zero(d))) {}
  Vec<D> weight, longest;
  Mask<D> is_free;
};

/// What the sweeps along a line keep of a point and the spring that begins there.
template <class D>
class LineKept {
 public:
  HWY_INLINE LineKept(D d, float* first) : lanes_(hn::Lanes(d)), first_(first) {}
  /// As it was, and where it goes.
  [[nodiscard]] HWY_INLINE PointRow position() const { return vector(0); }
  [[nodiscard]] HWY_INLINE PointRow way() const { return vector(3); }
  /// Of line_point() in lib/lines.h.
  [[nodiscard]] HWY_INLINE PointRow place() const { return vector(6); }
  [[nodiscard]] HWY_INLINE float* coupling() const { return first_ + 9 * lanes_; }
  [[nodiscard]] HWY_INLINE float* multiplier() const { return first_ + 10 * lanes_; }

 private:
  [[nodiscard]] HWY_INLINE PointRow vector(size_t k) const {
    return {first_ + k * lanes_, first_ + (k + 1) * lanes_, first_ + (k + 2) * lanes_};
  }
  size_t lanes_;
  float* first_;
};

/// The sweeps of cpu/lines.cpp along the lines of a block, whose positions and ways are in `kept`.
template <class D>
class LineSweeps {
 public:
  HWY_INLINE LineSweeps(D d, const LineStream& stream, const LineBlock& block, float* kept)
      : d_(d),
        constants_(stream.constants.data() + block.constants),
        kept_(kept),
        points_(block.points),
        diagonal_(hn::Set(d, stream.diagonal)) {}

  [[nodiscard]] HWY_INLINE LineKept<D> kept(size_t k) const {
    return LineKept<D>(d_, kept_ + kLineKept * hn::Lanes(d_) * k);
  }

  HWY_INLINE void find_springs() const {
    const auto zero = hn::Zero(d_), one = hn::Set(d_, 1.F);
    Points<D> d_before = set(d_, 0, 0, 0), a = load(d_, kept(0).position());
    auto inverse = zero, multiplier = zero, weight = constants(0).weight;
    for (size_t k = 0; k + 1 < points_; ++k) {
      const Points<D> b = load(d_, kept(k + 1).position());
      const auto longest = constants(k).longest, weight_b = constants(k + 1).weight;
      const Points<D> way = only<D>(hn::Gt(longest, zero), sub(b, a));
      const auto l2 = dot(d_, way, way);
      const auto along = dot(d_, d_before, way);
      const auto beside = hn::Neg(hn::Mul(weight, along));
      const auto coupling = hn::Mul(beside, inverse);
      const auto bend = hn::Sub(l2, along);
      const auto bends = hn::And(hn::Gt(inverse, zero), hn::Gt(bend, zero));
      const auto aside = hn::Mul(weight, hn::IfThenElseZero(bends, bend));
      const auto diagonal = hn::Mul(hn::Mul(hn::Add(weight, weight_b), l2), diagonal_);
      const auto pivot = hn::Sub(hn::Add(diagonal, aside), hn::Mul(beside, coupling));
      const auto exists = hn::Gt(pivot, zero);
      inverse = hn::IfThenElseZero(exists, hn::Div(one, hn::IfThenElse(exists, pivot, one)));
      const auto excess = hn::Sub(l2, hn::Mul(longest, longest));
      const auto error = hn::IfThenElseZero(hn::Gt(excess, zero), hn::Mul(hn::Set(d_, 0.5F), excess));
      multiplier = hn::Mul(hn::Sub(error, hn::Mul(beside, multiplier)), inverse);
      hn::StoreU(coupling, d_, kept(k).coupling());
      hn::StoreU(multiplier, d_, kept(k).multiplier());
      d_before = way;
      a = b;
      weight = weight_b;
    }
  }

  HWY_INLINE void find_multipliers() const {
    const auto zero = hn::Zero(d_), one = hn::Set(d_, 1.F), smoothing = hn::Set(d_, shader::kLineSmoothing);
    Points<D> place = set(d_, 0, 0, 0), way = place;
    auto coupling_of_spring = zero, multiplier = zero, coupling = zero;
    for (size_t k = points_; k-- > 0;) {
      const LineKept<D> own = kept(k);
      const LineConstants<D> point = constants(k);
      auto before = zero;
      if (k > 0) {
        before = hn::Sub(hn::LoadU(d_, kept(k - 1).multiplier()), hn::Mul(coupling_of_spring, multiplier));
        coupling_of_spring = hn::LoadU(d_, kept(k - 1).coupling());
      }
      const auto s = hn::Mul(smoothing, point.weight);
      const auto a = hn::Mul(s, hn::IfThenElseZero(hn::Gt(before, zero), before));
      const auto b = hn::Mul(s, hn::IfThenElseZero(hn::Gt(multiplier, zero), multiplier));
      const auto share = hn::Div(one, hn::Add(hn::Add(one, a), hn::Sub(b, hn::Mul(b, coupling))));
      place = scale(d_, add(load(d_, own.position()), scale(d_, place, b)), share);
      way = scale(d_, add(only<D>(point.is_free, load(d_, own.way())), scale(d_, way, b)), share);
      coupling = hn::Mul(a, share);
      store(d_, place, own.place());
      store(d_, way, own.way());
      hn::StoreU(coupling, d_, own.coupling());
      hn::StoreU(multiplier, d_, own.multiplier());
      multiplier = before;
    }
  }

  HWY_INLINE void move_points() const {
    const auto zero = hn::Zero(d_), tiny = hn::Set(d_, 1e-20F), one = hn::Set(d_, 1.F);
    Points<D> step_before = set(d_, 0, 0, 0), place = load(d_, kept(0).place()), way = load(d_, kept(0).way()),
              from = load(d_, kept(0).position());
    for (size_t k = 0; k < points_; ++k) {
      const LineKept<D> own = kept(k);
      const LineConstants<D> point = constants(k);
      store(d_, way, own.way());
      Points<D> step = set(d_, 0, 0, 0), next = step;
      if (k + 1 < points_) {
        const LineKept<D> other = kept(k + 1);
        const auto coupling = hn::LoadU(d_, other.coupling());
        const Points<D> place_of_next = add(load(d_, other.place()), scale(d_, place, coupling));
        way = add(load(d_, other.way()), scale(d_, way, coupling));
        next = load(d_, other.position());
        const Points<D> way_to_next = sub(next, from);
        const Points<D> after_step = sub(place_of_next, place);
        const Points<D> turned =
            add(way_to_next, scale(d_, sub(after_step, way_to_next), hn::Set(d_, shader::kLineTurn)));
        const auto l2 = dot(d_, turned, turned), along = dot(d_, way_to_next, turned);
        const auto is_long = hn::Gt(l2, tiny);
        const auto share = hn::IfThenElseZero(is_long, hn::Div(along, hn::IfThenElse(is_long, l2, one)));
        step = only<D>(hn::Gt(point.longest, zero), scale(d_, turned, hn::Mul(hn::LoadU(d_, own.multiplier()), share)));
        place = place_of_next;
      }
      store(d_, add(from, scale(d_, sub(step, step_before), point.weight)), own.position());
      from = next;
      step_before = step;
    }
  }

  HWY_INLINE void run() const {
    find_springs();
    find_multipliers();
    move_points();
  }

  /// Lanes of a point that move.
  [[nodiscard]] HWY_INLINE Mask<D> moves(size_t k) const { return hn::Gt(constants(k).weight, hn::Zero(d_)); }

 private:
  [[nodiscard]] HWY_INLINE LineConstants<D> constants(size_t k) const {
    return LineConstants<D>(d_, constants_ + kLineFloats * hn::Lanes(d_) * k);
  }

  D d_;
  const float* constants_;
  float* kept_;
  size_t points_;
  Vec<D> diagonal_;
};

template <class D>
HWY_NOINLINE void columns_of(D d, const LineStream& stream, ClothState& state, float* kept, const LineBlock& block) {
  const size_t width = state.data.width;
  const PointRow positions = at(state.position, block.first), ways = at(state.previous, block.first);
  const LineSweeps<D> sweeps(d, stream, block, kept);
  for (size_t k = 0; k < block.points; ++k) {
    store(d, load(d, after(positions, k * width)), sweeps.kept(k).position());
    store(d, load(d, after(ways, k * width)), sweeps.kept(k).way());
  }
  sweeps.run();
  for (size_t k = 0; k < block.points; ++k) {
    const PointRow to = after(positions, k * width), way_to = after(ways, k * width);
    const auto moves = sweeps.moves(k);
    store(d, choose<D>(moves, load(d, sweeps.kept(k).position()), load(d, to)), to);
    store(d, choose<D>(moves, load(d, sweeps.kept(k).way()), load(d, way_to)), way_to);
  }
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
  const PointRow positions = at(state.position, block.first), ways = at(state.previous, block.first);
  const LineSweeps<D> sweeps(d, stream, block, kept);
  FourColumns<D> four;
  for (size_t k = 0; k < block.points; k += kTurned) {
    four.read(d, rows, after(positions, k));
    for (size_t i = 0; i < kTurned; ++i) store(d, four.at(d, i), sweeps.kept(k + i).position());
    four.read(d, rows, after(ways, k));
    for (size_t i = 0; i < kTurned; ++i) store(d, four.at(d, i), sweeps.kept(k + i).way());
  }
  sweeps.run();
  FourColumns<D> moved;
  for (size_t k = 0; k < block.points; k += kTurned) {
    four.read(d, rows, after(positions, k));
    for (size_t i = 0; i < kTurned; ++i)
      moved.set(d, i, choose<D>(sweeps.moves(k + i), load(d, sweeps.kept(k + i).position()), four.at(d, i)));
    moved.write(d, rows, after(positions, k));
    four.read(d, rows, after(ways, k));
    for (size_t i = 0; i < kTurned; ++i)
      moved.set(d, i, choose<D>(sweeps.moves(k + i), load(d, sweeps.kept(k + i).way()), four.at(d, i)));
    moved.write(d, rows, after(ways, k));
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
