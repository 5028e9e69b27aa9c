// SPDX-License-Identifier: Apache-2.0
// Spans in vectors; see lib/span.h.
#if defined(GEOCLOTH_CPU_SPANS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_SPANS_INL_H
#undef GEOCLOTH_CPU_SPANS_INL_H
#else
#define GEOCLOTH_CPU_SPANS_INL_H
#endif

#include "cpu/lanes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// lib/span.h. Points well within their reach need no root.
template <class D>
HWY_NOINLINE void spans(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const size_t lanes = hn::Lanes(d);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k], j = i + op.offset;
    const float* constants = &op.stream->constants[2 * lanes * k];
    const PointRow pa = at(state.position, i), pb = at(state.position, j);
    const Points<D> a = load(d, pa), b = load(d, pb), way = sub(b, a);
    const auto longest = hn::LoadU(d, constants), l2 = dot(d, way, way);
    if (hn::AllFalse(d, hn::Gt(l2, hn::Mul(hn::Mul(longest, longest), hn::Set(d, 0.9999F))))) continue;
    const auto l = hn::Sqrt(l2);
    const auto pulls = hn::Gt(l, longest);
    const auto change = hn::Mul(hn::Sub(l, longest), hn::LoadU(d, constants + lanes));
    const Points<D> step = scale(d, way, hn::Mul(change, hn::Div(hn::Set(d, 1.F), l)));
    const Points<D> a2 = add(a, scale(d, step, hn::LoadU(d, &state.inverse_mass[i])));
    const Points<D> b2 = sub(b, scale(d, step, hn::LoadU(d, &state.inverse_mass[j])));
    const auto choose = [&](const Points<D>& moved, const Points<D>& before) GEOCLOTH_LANES {
      return Points<D>{hn::IfThenElse(pulls, moved.x, before.x), hn::IfThenElse(pulls, moved.y, before.y),
                       hn::IfThenElse(pulls, moved.z, before.z)};
    };
    store(d, choose(a2, a), pa);
    store(d, choose(b2, b), pb);
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
