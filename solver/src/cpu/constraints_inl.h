// SPDX-License-Identifier: Apache-2.0
// Springs and attachments in vectors. Rows are contiguous, so constraints across rows vectorise as they stand.
// Along a row two vectors are taken apart into the ends of the constraints (even and odd columns) by shuffles that stay
// within 128 bits, and put together again.
#if defined(GEOCLOTH_CPU_CONSTRAINTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_CONSTRAINTS_INL_H
#undef GEOCLOTH_CPU_CONSTRAINTS_INL_H
#else
#define GEOCLOTH_CPU_CONSTRAINTS_INL_H
#endif

#include <type_traits>

#include "cpu/lanes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// XPBD's sums of a block's multipliers in several relaxation steps: the first one starts anew, the last one is kept by
/// nobody.
template <bool kSeveral, class D>
struct Multipliers {
  HWY_INLINE Multipliers(const SweepOp& op, size_t block, size_t lanes)
      : sums(op.multipliers + block * lanes), read(op.read_multipliers), write(op.write_multipliers) {}
  HWY_INLINE Vec<D> so_far(D d) const { return read ? hn::LoadU(d, sums) : hn::Zero(d); }
  HWY_INLINE void keep(D d, Vec<D> sum) const {
    if (write) hn::StoreU(sum, d, sums);
  }
  float* sums;
  bool read, write;
};
template <class D>
struct Multipliers<false, D> {
  HWY_INLINE Multipliers(const SweepOp&, size_t, size_t) {}
};

/// Factor of a constraint's direction: the change of its multiplier, 0 where it does not exist, over its length.
/// @param weigh  weigh(error): the share of it to remove
template <bool kSeveral, class D, class Weigh>
HWY_INLINE Vec<D> change_over_length(D d, Vec<D> l, Vec<D> rest, Vec<D> inverse, const float* compliance,
                                     const Multipliers<kSeveral, D>& multipliers, const Weigh& weigh) {
  // Where the inverse is 0 so are rest and compliance, and with them the change.
  const auto exists = hn::Gt(l, hn::Set(d, 1e-12F));
  auto error = hn::Sub(l, rest);
  if constexpr (kSeveral) error = hn::Add(error, hn::Mul(hn::LoadU(d, compliance), multipliers.so_far(d)));
  const auto change = hn::Mul(weigh(error), inverse);
  if constexpr (kSeveral) multipliers.keep(d, hn::Sub(multipliers.so_far(d), hn::IfThenElseZero(exists, change)));
  return hn::IfThenElseZero(exists, hn::Mul(change, hn::Div(hn::Set(d, 1.F), l)));
}

/// Where the points are, as values of their own: behind a reference the compiler would have to read every pointer again
/// after each store.
struct PointBase {
  float *x, *y, *z;
  const float* inverse_mass;
  const float* yield;  ///< lib/yield.h

  HWY_INLINE PointBase(float* px, float* py, float* pz, const float* weights, const float* yields)
      : x(px), y(py), z(pz), inverse_mass(weights), yield(yields) {}
  HWY_INLINE PointBase(Vec3Array& points, ClothState& state, size_t offset)
      : x(points.x.data() + offset),
        y(points.y.data() + offset),
        z(points.z.data() + offset),
        inverse_mass(state.inverse_mass.data() + offset),
        yield(state.yield.data() + offset) {}
  HWY_INLINE PointBase(ClothState& state, size_t offset) : PointBase(state.position, state, offset) {}
  [[nodiscard]] HWY_INLINE PointRow at(size_t i) const { return {x + i, y + i, z + i}; }
};
/// The same on offsets, see lib/fine.h: those move.
struct OffsetBase : PointBase {
  const float *base_x, *base_y, *base_z;

  HWY_INLINE OffsetBase(const PointBase& offsets, const float* px, const float* py, const float* pz)
      : PointBase(offsets), base_x(px), base_y(py), base_z(pz) {}
  HWY_INLINE OffsetBase(ClothState& state, size_t offset)
      : PointBase(state.offset, state, offset),
        base_x(state.previous.x.data() + offset),
        base_y(state.previous.y.data() + offset),
        base_z(state.previous.z.data() + offset) {}
};
template <bool kOnOffsets>
using PointsOf = std::conditional_t<kOnOffsets, OffsetBase, PointBase>;

/// From one point to another by what moves, and where that is offsets by their bases, too.
template <class D>
HWY_INLINE Points<D> with_bases(D, const PointBase&, size_t, const PointBase&, size_t, const Points<D>& way) {
  return way;
}
template <class D>
HWY_INLINE Points<D> with_bases(D d, const OffsetBase& from, size_t i, const OffsetBase& to, size_t j,
                                const Points<D>& way) {
  const auto between = [&](const float* p, const float* q)
                           GEOCLOTH_LANES { return hn::Sub(hn::LoadU(d, q + j), hn::LoadU(d, p + i)); };
  return {hn::Add(between(from.base_x, to.base_x), way.x), hn::Add(between(from.base_y, to.base_y), way.y),
          hn::Add(between(from.base_z, to.base_z), way.z)};
}
template <class Base, class D>
HWY_INLINE Points<D> way_between(D d, const Base& from, size_t i, const Base& to, size_t j) {
  return with_bases(d, from, i, to, j, sub(load(d, to.at(j)), load(d, from.at(i))));
}

/// Floats of a block's constants.
constexpr size_t spring_floats(size_t lanes, bool several) {
  return (several ? 3 : 2) * lanes;
}

/// What springs do besides lib/spring.h.
template <bool kSomeSteps, bool kAll, bool kOnlyPull, bool kSmallSteps = false>
struct SpringKind {
  static constexpr bool kSeveral = kSomeSteps;   ///< relaxation steps
  static constexpr bool kWhole = kAll;           ///< all of a spring's error is removed
  static constexpr bool kPullsOnly = kOnlyPull;  ///< ties and spans, lib/span.h
  using Base = PointsOf<kSmallSteps>;            ///< of its points
};

/// Whether nothing of a vector is pulled: most of what only pulls is slack, and no root is needed to see that. Where a
/// square is not above the rounded one of the longest length, its rounded root is not above that length: rounding adds
/// less than 2^-24 to the square, so less than 2^-25 to the root, which is less than half of a step between floats.
template <class D>
HWY_INLINE bool all_slack(D d, Vec<D> squared_length, Vec<D> longest) {
  return hn::AllFalse(d, hn::Gt(squared_length, hn::Mul(longest, longest)));
}

/// Length, or what pulls only looks at first: its square.
template <class Kind, class D>
HWY_INLINE Vec<D> first_length(D d, const Points<D>& way) {
  const auto squared = dot(d, way, way);
  return Kind::kPullsOnly ? squared : hn::Sqrt(squared);
}

/// lib/spring.h with inverse = 1 / (wa + wb + compliance), 0 where there is no spring; lib/span.h with the longest
/// length, endless where there is none, and share / (wa + wb).
/// @param block   its number
/// @param length  see first_length()
template <class Kind, class D>
HWY_INLINE Vec<D> spring_factor(D d, const SweepOp& op, const float* all_constants, size_t block, Vec<D> length,
                                Vec<D> share) {
  const size_t lanes = hn::Lanes(d);
  const float* const constants = all_constants + block * spring_floats(lanes, Kind::kSeveral);
  const auto rest = hn::LoadU(d, constants), inverse = hn::LoadU(d, constants + lanes);
  if constexpr (Kind::kPullsOnly) {
    if (all_slack(d, length, rest)) return hn::Zero(d);
    const auto l = hn::Sqrt(length), change = hn::Mul(hn::Sub(l, rest), inverse);
    return hn::IfThenElseZero(hn::Gt(l, rest), hn::Mul(change, hn::Div(hn::Set(d, 1.F), l)));
  } else {
    return change_over_length(d, length, rest, inverse, constants + 2 * lanes,
                              Multipliers<Kind::kSeveral, D>(op, block, lanes), [&](Vec<D> error) GEOCLOTH_LANES {
                                if constexpr (Kind::kWhole) return error;
                                return hn::Mul(share, error);
                              });
  }
}
/// Whether a vector's points stay where they are.
template <class Kind, class D>
HWY_INLINE bool nothing_moves(D d, Vec<D> factor) {
  return Kind::kPullsOnly && hn::AllFalse(d, hn::Gt(factor, hn::Zero(d)));
}
template <class D>
HWY_INLINE void apply_spring(D d, const Points<D>& way, Vec<D> factor, Points<D>& a, Vec<D> wa, Points<D>& b,
                             Vec<D> wb) {
  const Points<D> step = scale(d, way, factor);
  a = add(a, scale(d, step, wa));
  b = sub(b, scale(d, step, wb));
}

/// yielding() of lib/yield.h: changes the weights.
template <class D>
HWY_INLINE void let_yield(D d, Vec<D>& wa, Vec<D> yield_a, Vec<D>& wb, Vec<D> yield_b) {
  const auto one = hn::Set(d, 1.F);
  const auto both = hn::And(hn::Eq(yield_a, one), hn::Eq(yield_b, one));
  if (hn::AllTrue(d, both)) return;
  const auto a = hn::Mul(wa, yield_a), b = hn::Mul(wb, yield_b);
  const auto whole = hn::Mul(hn::Add(wa, wb), hn::Div(one, hn::Max(hn::Add(a, b), hn::Set(d, 1e-30F))));
  wa = hn::IfThenElse(both, wa, hn::Mul(a, whole));
  wb = hn::IfThenElse(both, wb, hn::Mul(b, whole));
}

/// length(block, pixel), factor(block, length) and apply(block, pixel, factor) for the blocks first .. last - 1, one or
/// two blocks ahead of the next: what has to wait for a root or a division would fill the processor's queues. Blocks
/// may share pixels, but no constraint's: what length() has read is not changed until apply() reads it again.
template <class D, class Length, class Factor, class Apply>
HWY_INLINE void in_turn(D d, const RowStream& stream, uint32_t first, uint32_t last, const Length& length,
                        const Factor& factor, const Apply& apply) {
  const uint32_t* const pixels = stream.pixel.data();
  size_t k = first;
  const size_t end = last;
  Vec<D> now = factor(k, length(k, pixels[k])), next = hn::Zero(d), after_next = hn::Zero(d);
  if (k + 1 < end) next = length(k + 1, pixels[k + 1]);
  if (k + 2 < end) after_next = length(k + 2, pixels[k + 2]);
  // As below, three blocks at a time: nothing is handed on. Vectors of 16 wait for memory and gain nothing by it.
  for (; hn::MaxLanes(D()) <= 8 && k + 5 < end; k += 3) {
    const Vec<D> third = length(k + 3, pixels[k + 3]);
    const Vec<D> soon = factor(k + 1, next);
    apply(k, pixels[k], now);
    const Vec<D> fourth = length(k + 4, pixels[k + 4]);
    const Vec<D> later = factor(k + 2, after_next);
    apply(k + 1, pixels[k + 1], soon);
    after_next = length(k + 5, pixels[k + 5]);
    now = factor(k + 3, third);
    apply(k + 2, pixels[k + 2], later);
    next = fourth;
  }
  for (; k + 3 < end; ++k) {
    const Vec<D> newest = length(k + 3, pixels[k + 3]);
    const Vec<D> soon = factor(k + 1, next);
    apply(k, pixels[k], now);
    next = after_next;
    after_next = newest;
    now = soon;
  }
  for (;;) {
    apply(k, pixels[k], now);
    if (++k >= end) return;
    now = factor(k, next);
    next = after_next;
  }
}

/// Even and odd columns of two vectors: within 128 bits those of the first one, then those of the second one.
template <class D>
HWY_INLINE Vec<D> even_columns(D d, Vec<D> low, Vec<D> high) {
#if HWY_ARCH_X86 && HWY_MAX_BYTES >= 32
  if constexpr (hn::MaxLanes(D()) == 8) return Vec<D>{_mm256_shuffle_ps(low.raw, high.raw, 0x88)};
#if HWY_MAX_BYTES >= 64
  if constexpr (hn::MaxLanes(D()) == 16) return Vec<D>{_mm512_shuffle_ps(low.raw, high.raw, 0x88)};
#endif
#endif
  if constexpr (hn::MaxLanes(D()) == 4) return hn::ConcatEven(d, high, low);
}
template <class D>
HWY_INLINE Vec<D> odd_columns(D d, Vec<D> low, Vec<D> high) {
#if HWY_ARCH_X86 && HWY_MAX_BYTES >= 32
  if constexpr (hn::MaxLanes(D()) == 8) return Vec<D>{_mm256_shuffle_ps(low.raw, high.raw, 0xDD)};
#if HWY_MAX_BYTES >= 64
  if constexpr (hn::MaxLanes(D()) == 16) return Vec<D>{_mm512_shuffle_ps(low.raw, high.raw, 0xDD)};
#endif
#endif
  if constexpr (hn::MaxLanes(D()) == 4) return hn::ConcatOdd(d, high, low);
}

/// Two vectors of columns, from p and q on, taken apart: 1 even and odd columns, 2 the first and the last two of four.
template <class D>
struct Ends {
  Vec<D> a, b;
};
template <size_t kColumns, class D>
HWY_INLINE Ends<D> take_apart(D d, const float* p, const float* q) {
  const auto low = hn::LoadU(d, p), high = hn::LoadU(d, q);
  if constexpr (kColumns == 1) {
    return {even_columns(d, low, high), odd_columns(d, low, high)};
  } else {
    const hn::Repartition<uint64_t, D> pairs;
    const auto low2 = hn::BitCast(pairs, low), high2 = hn::BitCast(pairs, high);
    return {hn::BitCast(d, hn::InterleaveLower(pairs, low2, high2)),
            hn::BitCast(d, hn::InterleaveUpper(pairs, low2, high2))};
  }
}
template <size_t kColumns, class D>
HWY_INLINE void put_together(D d, Vec<D> a, Vec<D> b, float* p, float* q) {
  if constexpr (kColumns == 1) {
    hn::StoreU(hn::InterleaveLower(d, a, b), d, p);
    hn::StoreU(hn::InterleaveUpper(d, a, b), d, q);
  } else {
    const hn::Repartition<uint64_t, D> pairs;
    const auto a2 = hn::BitCast(pairs, a), b2 = hn::BitCast(pairs, b);
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, a2, b2)), d, p);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, a2, b2)), d, q);
  }
}

/// with_bases() of springs along rows, whose ends are taken apart.
template <size_t kColumns, class D>
HWY_INLINE Points<D> with_bases_along(D, const PointBase&, size_t, size_t, const Points<D>& way) {
  return way;
}
template <size_t kColumns, class D>
HWY_INLINE Points<D> with_bases_along(D d, const OffsetBase& points, size_t i, size_t j, const Points<D>& way) {
  const auto between = [&](const float* base) GEOCLOTH_LANES {
    const Ends<D> ends = take_apart<kColumns>(d, base + i, base + j);
    return hn::Sub(ends.b, ends.a);
  };
  return {hn::Add(between(points.base_x), way.x), hn::Add(between(points.base_y), way.y),
          hn::Add(between(points.base_z), way.z)};
}

/// @param kYields  whether the points have yields that may be below 1
template <class Kind, bool kYields, class D>
HWY_NOINLINE void springs_across(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const typename Kind::Base points(state, 0);
  const float* const constants = op.stream->constants.data();
  const size_t offset = op.offset;
  const auto share = hn::Set(d, op.share);
  in_turn(
      d, *op.stream, first, last,
      [&](size_t, size_t i)
          GEOCLOTH_LANES { return first_length<Kind>(d, way_between(d, points, i, points, i + offset)); },
      [&](size_t block, Vec<D> l) GEOCLOTH_LANES { return spring_factor<Kind>(d, op, constants, block, l, share); },
      [&](size_t, size_t i, Vec<D> factor) GEOCLOTH_LANES {
        if (nothing_moves<Kind>(d, factor)) return;
        const size_t j = i + offset;
        Points<D> a = load(d, points.at(i)), b = load(d, points.at(j));
        auto wa = hn::LoadU(d, points.inverse_mass + i), wb = hn::LoadU(d, points.inverse_mass + j);
        if constexpr (kYields) let_yield(d, wa, hn::LoadU(d, points.yield + i), wb, hn::LoadU(d, points.yield + j));
        apply_spring(d, with_bases(d, points, i, points, j, sub(b, a)), factor, a, wa, b, wb);
        store(d, a, points.at(anew(i)));
        store(d, b, points.at(anew(j)));
      });
}

template <size_t kColumns, class Kind, bool kYields, class D>
HWY_NOINLINE void springs_along(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const typename Kind::Base points(state, 0);
  const float* const constants = op.stream->constants.data();
  const uint32_t* const second = op.stream->second.data();
  const auto share = hn::Set(d, op.share);
  in_turn(
      d, *op.stream, first, last,
      [&](size_t block, size_t i) GEOCLOTH_LANES {
        const PointRow p = points.at(i), q = points.at(second[block]);
        const Ends<D> x = take_apart<kColumns>(d, p.x, q.x), y = take_apart<kColumns>(d, p.y, q.y);
        const Ends<D> z = take_apart<kColumns>(d, p.z, q.z);
        const Points<D> way{hn::Sub(x.b, x.a), hn::Sub(y.b, y.a), hn::Sub(z.b, z.a)};
        return first_length<Kind>(d, with_bases_along<kColumns>(d, points, i, second[block], way));
      },
      [&](size_t block, Vec<D> l) GEOCLOTH_LANES { return spring_factor<Kind>(d, op, constants, block, l, share); },
      [&](size_t block, size_t i, Vec<D> factor) GEOCLOTH_LANES {
        if (nothing_moves<Kind>(d, factor)) return;
        const size_t j = second[block];
        const PointRow p = points.at(i), q = points.at(j);
        const Ends<D> x = take_apart<kColumns>(d, p.x, q.x), y = take_apart<kColumns>(d, p.y, q.y);
        const Ends<D> z = take_apart<kColumns>(d, p.z, q.z);
        Ends<D> w = take_apart<kColumns>(d, points.inverse_mass + i, points.inverse_mass + j);
        if constexpr (kYields) {
          const Ends<D> parts = take_apart<kColumns>(d, points.yield + i, points.yield + j);
          let_yield(d, w.a, parts.a, w.b, parts.b);
        }
        Points<D> a{x.a, y.a, z.a}, b{x.b, y.b, z.b};
        apply_spring(d, with_bases_along<kColumns>(d, points, i, j, sub(b, a)), factor, a, w.a, b, w.b);
        const PointRow to = points.at(anew(i)), to_second = points.at(j);
        // The second half after the first one, whose lanes over the end of its row may lie on it.
        put_together<kColumns>(d, a.x, b.x, to.x, to_second.x);
        put_together<kColumns>(d, a.y, b.y, to.y, to_second.y);
        put_together<kColumns>(d, a.z, b.z, to.z, to_second.z);
      });
}

/// The anchors of a substep as limit() wants them, lane by lane. Any: each lane chooses among as many as a vector has.
struct ChosenAnchors {
  template <class D>
  static HWY_INLINE Vec<D> from(D d, const RowStream& stream, size_t block, const float* anchors) {
    const int32_t* const own = stream.anchors.data() + block * hn::Lanes(d);
    return hn::TableLookupLanes(hn::LoadU(d, anchors), hn::IndicesFromVec(d, hn::LoadU(hn::RebindToSigned<D>(), own)));
  }
};
/// Of a sheet below its pins: neighbours have neighbouring anchors.
struct AnchorsBeside {
  template <class D>
  static HWY_INLINE Vec<D> from(D d, const RowStream&, size_t, const float* anchors) {
    return hn::LoadU(d, anchors);
  }
};

/// lib/limit.h.
template <class Anchors, class D>
HWY_NOINLINE void limit(D d, const SweepOp& op, ClothState& state, const float* all_anchors, uint32_t line,
                        uint32_t first, uint32_t last) {
  const RowStream& stream = *op.stream;
  const PointBase points(state, 0);
  const uint32_t* const first_anchor = stream.first_anchor.data();
  const float* const longest_of = stream.constants.data();
  const auto one = hn::Set(d, 1.F), within = hn::Set(d, -1.F);
  const auto anchor_of = [&](size_t block) GEOCLOTH_LANES {
    const float* const x = all_anchors + first_anchor[block];
    return Points<D>{Anchors::from(d, stream, block, x), Anchors::from(d, stream, block, x + line),
                     Anchors::from(d, stream, block, x + size_t{2} * line)};
  };
  in_turn(
      d, stream, first, last,
      [&](size_t block, size_t i) GEOCLOTH_LANES {
        const Points<D> way = sub(load(d, points.at(i)), anchor_of(block));
        return dot(d, way, way);
      },
      [&](size_t block, Vec<D> squared) GEOCLOTH_LANES {
        const auto longest = hn::LoadU(d, longest_of + block * hn::Lanes(d));
        if (all_slack(d, squared, longest)) return within;
        const auto l = hn::Sqrt(squared);
        const auto far = hn::Gt(l, longest);
        return hn::IfThenElse(far, hn::Mul(longest, hn::Div(one, l)), within);
      },
      [&](size_t block, size_t i, Vec<D> factor) GEOCLOTH_LANES {
        const auto far = hn::Ge(factor, hn::Zero(d));
        if (hn::AllFalse(d, far)) return;
        const PointRow p = points.at(i);
        const Points<D> position = load(d, p), anchor = anchor_of(block);
        const Points<D> pulled = add(anchor, scale(d, sub(position, anchor), factor));
        store(d, choose<D>(far, pulled, position), points.at(anew(i)));
      });
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
