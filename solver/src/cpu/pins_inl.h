// SPDX-License-Identifier: Apache-2.0
// Pins in vectors; see lib/pin.h.
#if defined(GEOCLOTH_CPU_PINS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_PINS_INL_H
#undef GEOCLOTH_CPU_PINS_INL_H
#else
#define GEOCLOTH_CPU_PINS_INL_H
#endif

#include "cpu/lanes_inl.h"
#include "cpu/pin_rows.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// lib/vector.h: mix3().
template <class D>
HWY_INLINE Points<D> mix(D d, const Points<D>& a, const Points<D>& b, float t) {
  return add(scale(d, a, hn::Set(d, 1.F - t)), scale(d, b, hn::Set(d, t)));
}
/// lib/limit.h: attach() of the lanes that have a longest length.
template <class D>
HWY_INLINE Points<D> attach(D d, const Points<D>& position, const Points<D>& anchor, Vec<D> longest) {
  const Points<D> way = sub(position, anchor);
  const auto l = length(d, way), one = hn::Set(d, 1.F);
  const auto far = hn::And(hn::Gt(longest, hn::Zero(d)), hn::Gt(l, longest));
  const auto share = hn::Mul(longest, hn::Div(one, hn::IfThenElse(far, l, one)));
  return choose<D>(far, shifted(d, anchor, way, share), position);
}
/// lib/limit.h: out_of_ball() of the lanes that have a radius.
template <class D>
HWY_INLINE Points<D> out_of_ball(D d, const Points<D>& position, const Points<D>& middle, Vec<D> radius) {
  const UnitAndLength<D> away = unit_and_length(d, sub(position, middle));
  const auto zero = hn::Zero(d);
  const auto inside = hn::And(hn::Gt(radius, zero), hn::Lt(away.length, radius));
  const Points<D> out = choose<D>(hn::Gt(away.length, zero), away.unit, set(d, 0, 1, 0));
  return choose<D>(inside, shifted(d, middle, out, radius), position);
}

/// lib/pin.h: bow_at().
template <class D>
HWY_INLINE Points<D> bow_at(D d, const Points<D>& bow, const Points<D>& lean, float t) {
  const float height = 4.F * t * (1.F - t), side = 2.F * t - 1.F;
  return scale(d, shifted(d, bow, lean, hn::Set(d, side)), hn::Set(d, height));
}

/// pinned_position() of lib/pin.h.
/// @param floats  of the block, see pin_rows.h
/// @param seen    seen(p) of a target: from where positions are
template <class D, class Seen>
HWY_INLINE Points<D> pinned(D d, const shader::Substep& step, const float* floats, const Points<D>& position,
                            const Points<D>& previous, const Seen& seen) {
  const size_t lanes = hn::Lanes(d);
  const auto one_of = [&](PinFloat n) GEOCLOTH_LANES { return hn::LoadU(d, floats + n * lanes); };
  const auto point_of = [&](PinFloat n) GEOCLOTH_LANES {
    return Points<D>{hn::LoadU(d, floats + n * lanes), hn::LoadU(d, floats + (n + 1) * lanes),
                     hn::LoadU(d, floats + (n + 2) * lanes)};
  };
  const auto zero = hn::Zero(d), soft = one_of(kPinSoft), limit = one_of(kPinLimit);
  const Points<D> target = seen(point_of(kPinTarget));
  Points<D> held = mix(d, position, target, step.pin_fraction);
  const auto is_held = hn::And(hn::Eq(soft, zero), hn::Eq(limit, zero));
  const auto bows = hn::Ne(one_of(kPinBows), zero);
  const bool any_bows = !hn::AllFalse(d, bows);
  Points<D> bow = set(d, 0, 0, 0), bow_before = bow;
  if (any_bows) {
    bow = bow_at(d, point_of(kPinBow), point_of(kPinLean), step.frame_fraction);
    bow_before = bow_at(d, point_of(kPinBow), point_of(kPinLean), step.frame_fraction - step.substep_share);
    held = choose<D>(bows, add(mix(d, sub(position, bow_before), target, step.pin_fraction), bow), held);
  }
  if (hn::AllTrue(d, is_held)) return held;
  const Points<D> start = seen(point_of(kPinStart));
  Points<D> goal = mix(d, start, target, step.frame_fraction);
  Points<D> along = shifted(d, previous, sub(target, start), hn::Set(d, step.substep_share));
  if (any_bows) {
    goal = choose<D>(bows, add(goal, bow), goal);
    along = choose<D>(bows, add(along, sub(bow, bow_before)), along);
  }
  Points<D> drawn = shifted(d, position, sub(goal, position), soft);
  drawn = shifted(d, drawn, sub(along, position), one_of(kPinBraked));
  if (!hn::AllTrue(d, hn::Eq(limit, zero))) drawn = attach(d, drawn, goal, limit);
  const auto radius = one_of(kPinRadius);
  if (!hn::AllTrue(d, hn::Eq(radius, zero))) {
    const Points<D> behind = mix(d, point_of(kPinBehindStart), point_of(kPinBehind), step.frame_fraction);
    drawn = out_of_ball(d, drawn, add(goal, behind), radius);
  }
  return choose<D>(is_held, held, drawn);
}

/// The blocks first .. last - 1.
/// @param kOnOffsets  offsets are moved, which see their targets from their bases: pin_from() of lib/fine.h
template <bool kOnOffsets, class D>
HWY_NOINLINE void pins(D d, const SweepFrame& frame, uint32_t substep, std::span<const Run> blocks, uint32_t first,
                       uint32_t last) {
  const PassContext& context = frame.contexts[substep];
  const shader::Substep& step = context.frame.substeps[substep];
  ClothState& state = *frame.state;
  const PointRow moving = at(kOnOffsets ? state.offset : state.position, 0);
  const PointRow before = at(kOnOffsets ? state.carry : state.previous, 0), bases = at(state.previous, 0);
  for (uint32_t k = first; k < last; ++k) {
    const float* const floats = frame.pins + k * size_t{kPinFloats} * hn::Lanes(d);
    for_run(d, blocks[k], [&](uint32_t i, auto lanes) GEOCLOTH_LANES {
      const PointRow p = after(moving, i);
      const auto seen = [&](const Points<D>& target) GEOCLOTH_LANES {
        if constexpr (!kOnOffsets) return target;
        return sub(target, load(d, lanes, after(bases, i)));
      };
      store(d, pinned(d, step, floats, load(d, lanes, p), load(d, lanes, after(before, i)), seen), lanes, p);
    });
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
