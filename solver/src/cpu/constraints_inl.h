// SPDX-License-Identifier: Apache-2.0
// Springs, bends and attachments in vectors. Rows are contiguous, so constraints across rows vectorise as they stand.
// Along a row two vectors are taken apart into the ends of the constraints (even and odd columns) by shuffles that stay
// within 128 bits, and put together again.
#if defined(GEOCLOTH_CPU_CONSTRAINTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_CONSTRAINTS_INL_H
#undef GEOCLOTH_CPU_CONSTRAINTS_INL_H
#else
#define GEOCLOTH_CPU_CONSTRAINTS_INL_H
#endif

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
/// @param weight  of the error
template <bool kSeveral, class D>
HWY_INLINE Vec<D> change_over_length(D d, Vec<D> l, Vec<D> rest, Vec<D> inverse, const float* compliance,
                                     const Multipliers<kSeveral, D>& multipliers, Vec<D> weight, bool weighted) {
  const auto exists = hn::And(hn::Gt(inverse, hn::Zero(d)), hn::Gt(l, hn::Set(d, 1e-12F)));
  auto error = hn::Sub(l, rest);
  if constexpr (kSeveral) error = hn::Add(error, hn::Mul(hn::LoadU(d, compliance), multipliers.so_far(d)));
  const auto change = hn::Mul(weighted ? hn::Mul(weight, error) : error, inverse);
  if constexpr (kSeveral) multipliers.keep(d, hn::Sub(multipliers.so_far(d), hn::IfThenElseZero(exists, change)));
  return hn::IfThenElseZero(exists, hn::Mul(change, hn::Div(hn::Set(d, 1.F), l)));
}

/// lib/spring.h with inverse = 1 / (wa + wb + compliance), 0 where there is no spring.
template <bool kSeveral, class D>
HWY_INLINE void project_spring(D d, Points<D>& a, Vec<D> wa, Points<D>& b, Vec<D> wb, const float* constants,
                               const Multipliers<kSeveral, D>& multipliers, Vec<D> share) {
  const size_t lanes = hn::Lanes(d);
  const auto rest = hn::LoadU(d, constants), inverse = hn::LoadU(d, constants + lanes);
  const Points<D> way = sub(b, a);
  const auto factor =
      change_over_length(d, length(d, way), rest, inverse, constants + 2 * lanes, multipliers, share, true);
  const Points<D> step = scale(d, way, factor);
  a = add(a, scale(d, step, wa));
  b = sub(b, scale(d, step, wb));
}

/// lib/bend.h with inverse = 1 / (w + compliance), 0 where there is no bend.
template <bool kSeveral, class D>
HWY_INLINE void project_bend(D d, Points<D>& a, Vec<D> wa, Points<D>& middle, Vec<D> wm, Points<D>& b, Vec<D> wb,
                             const float* constants, const Multipliers<kSeveral, D>& multipliers) {
  const size_t lanes = hn::Lanes(d);
  const auto rest = hn::LoadU(d, constants), inverse = hn::LoadU(d, constants + lanes);
  const auto chord = hn::LoadU(d, constants + 2 * lanes), back = hn::Sub(hn::Set(d, 1.F), chord);
  const Points<D> e = add(scale(d, sub(a, middle), back), scale(d, sub(b, middle), chord));
  const auto factor =
      change_over_length(d, length(d, e), rest, inverse, constants + 3 * lanes, multipliers, rest, false);
  const Points<D> step = scale(d, e, factor);
  a = sub(a, scale(d, step, hn::Mul(wa, back)));
  middle = add(middle, scale(d, step, wm));
  b = sub(b, scale(d, step, hn::Mul(wb, chord)));
}

/// Floats of a block's constants.
constexpr size_t spring_floats(size_t lanes, bool several) {
  return (several ? 3 : 2) * lanes;
}
constexpr size_t bend_floats(size_t lanes, bool several) {
  return (several ? 4 : 3) * lanes;
}

/// Two vectors of neighbouring columns taken apart: 1 even and odd columns, 2 the first and the last two of four.
template <class D>
struct Ends {
  Vec<D> a, b;
};
template <size_t kColumns, class D>
HWY_INLINE Ends<D> take_apart(D d, const float* p) {
  const auto low = hn::LoadU(d, p), high = hn::LoadU(d, p + hn::Lanes(d));
  if constexpr (kColumns == 1) {
    return {hn::OddEven(hn::DupEven(high), low), hn::OddEven(high, hn::DupOdd(low))};
  } else {
    const hn::Repartition<uint64_t, D> pairs;
    const auto low2 = hn::BitCast(pairs, low), high2 = hn::BitCast(pairs, high);
    return {hn::BitCast(d, hn::InterleaveLower(pairs, low2, high2)),
            hn::BitCast(d, hn::InterleaveUpper(pairs, low2, high2))};
  }
}
template <size_t kColumns, class D>
HWY_INLINE void put_together(D d, Vec<D> a, Vec<D> b, float* p) {
  if constexpr (kColumns == 1) {
    hn::StoreU(hn::OddEven(hn::DupEven(b), a), d, p);
    hn::StoreU(hn::OddEven(b, hn::DupOdd(a)), d, p + hn::Lanes(d));
  } else {
    const hn::Repartition<uint64_t, D> pairs;
    const auto a2 = hn::BitCast(pairs, a), b2 = hn::BitCast(pairs, b);
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, a2, b2)), d, p);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, a2, b2)), d, p + hn::Lanes(d));
  }
}

template <bool kSeveral, class D>
HWY_NOINLINE void springs_across(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const auto share = hn::Set(d, op.share);
  const size_t lanes = hn::Lanes(d), size = spring_floats(lanes, kSeveral);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k], j = i + op.offset;
    const PointRow pa = at(state.position, i), pb = at(state.position, j);
    Points<D> a = load(d, pa), b = load(d, pb);
    project_spring(d, a, hn::LoadU(d, &state.inverse_mass[i]), b, hn::LoadU(d, &state.inverse_mass[j]),
                   &op.stream->constants[k * size], Multipliers<kSeveral, D>(op, k, lanes), share);
    store(d, a, pa);
    store(d, b, pb);
  }
}

template <size_t kColumns, bool kSeveral, class D>
HWY_NOINLINE void springs_along(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const auto share = hn::Set(d, op.share);
  const size_t lanes = hn::Lanes(d), size = spring_floats(lanes, kSeveral);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k];
    const PointRow p = at(state.position, i);
    const Ends<D> x = take_apart<kColumns>(d, p.x), y = take_apart<kColumns>(d, p.y), z = take_apart<kColumns>(d, p.z);
    const Ends<D> w = take_apart<kColumns>(d, &state.inverse_mass[i]);
    Points<D> a{x.a, y.a, z.a}, b{x.b, y.b, z.b};
    project_spring(d, a, w.a, b, w.b, &op.stream->constants[k * size], Multipliers<kSeveral, D>(op, k, lanes), share);
    put_together<kColumns>(d, a.x, b.x, p.x);
    put_together<kColumns>(d, a.y, b.y, p.y);
    put_together<kColumns>(d, a.z, b.z, p.z);
  }
}

template <bool kSeveral, class D>
HWY_NOINLINE void bends_across(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const size_t lanes = hn::Lanes(d), size = bend_floats(lanes, kSeveral);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k], m = i + op.offset, j = m + op.offset;
    const PointRow pa = at(state.position, i), pm = at(state.position, m), pb = at(state.position, j);
    Points<D> a = load(d, pa), middle = load(d, pm), b = load(d, pb);
    project_bend(d, a, hn::LoadU(d, &state.inverse_mass[i]), middle, hn::LoadU(d, &state.inverse_mass[m]), b,
                 hn::LoadU(d, &state.inverse_mass[j]), &op.stream->constants[k * size],
                 Multipliers<kSeveral, D>(op, k, lanes));
    store(d, a, pa);
    store(d, middle, pm);
    store(d, b, pb);
  }
}

template <bool kSeveral, class D>
HWY_NOINLINE void bends_along(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const size_t lanes = hn::Lanes(d), size = bend_floats(lanes, kSeveral);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k];
    const PointRow p = at(state.position, i);
    Points<D> a, middle, b;
    Vec<D> wa, wm, wb;
    hn::LoadInterleaved3(d, p.x, a.x, middle.x, b.x);
    hn::LoadInterleaved3(d, p.y, a.y, middle.y, b.y);
    hn::LoadInterleaved3(d, p.z, a.z, middle.z, b.z);
    hn::LoadInterleaved3(d, &state.inverse_mass[i], wa, wm, wb);
    project_bend(d, a, wa, middle, wm, b, wb, &op.stream->constants[k * size], Multipliers<kSeveral, D>(op, k, lanes));
    hn::StoreInterleaved3(a.x, middle.x, b.x, d, p.x);
    hn::StoreInterleaved3(a.y, middle.y, b.y, d, p.y);
    hn::StoreInterleaved3(a.z, middle.z, b.z, d, p.z);
  }
}

/// lib/limit.h. Points well within their reach need no root.
template <class D>
HWY_NOINLINE void limit(D d, const SweepOp& op, ClothState& state, const float* anchors, uint32_t count, uint32_t first,
                        uint32_t last) {
  const hn::RebindToSigned<D> di;
  const size_t lanes = hn::Lanes(d);
  const auto one = hn::Set(d, 1.F);
  for (uint32_t k = first; k < last; ++k) {
    const PointRow p = at(state.position, op.stream->pixel[k]);
    const Points<D> position = load(d, p);
    Points<D> anchor;
    if (const int32_t start = op.stream->first_anchor[k]; start >= 0) {
      anchor = {hn::LoadU(d, anchors + start), hn::LoadU(d, anchors + count + start),
                hn::LoadU(d, anchors + 2 * size_t{count} + start)};
    } else {
      const auto index = hn::LoadU(di, &op.stream->anchors[k * lanes]);
      anchor = {hn::GatherIndex(d, anchors, index), hn::GatherIndex(d, anchors + count, index),
                hn::GatherIndex(d, anchors + 2 * size_t{count}, index)};
    }
    const auto longest = hn::LoadU(d, &op.stream->constants[k * lanes]);
    const Points<D> way = sub(position, anchor);
    const auto l2 = dot(d, way, way);
    if (hn::AllFalse(d, hn::Gt(l2, hn::Mul(hn::Mul(longest, longest), hn::Set(d, 0.9999F))))) continue;
    const auto l = hn::Sqrt(l2);
    const auto far = hn::Gt(l, longest);
    const auto factor = hn::Mul(longest, hn::Div(one, hn::IfThenElse(far, l, one)));
    const Points<D> pulled = add(anchor, scale(d, way, factor));
    store(d,
          Points<D>{hn::IfThenElse(far, pulled.x, position.x), hn::IfThenElse(far, pulled.y, position.y),
                    hn::IfThenElse(far, pulled.z, position.z)},
          p);
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
