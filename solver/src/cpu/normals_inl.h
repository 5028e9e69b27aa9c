// SPDX-License-Identifier: Apache-2.0
// Normals in vectors; see lib/normal.h.
#if defined(GEOCLOTH_CPU_NORMALS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_NORMALS_INL_H
#undef GEOCLOTH_CPU_NORMALS_INL_H
#else
#define GEOCLOTH_CPU_NORMALS_INL_H
#endif

#include "cpu/lanes_inl.h"
#include "lib/normal.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

template <class D>
HWY_INLINE Points<D> cross(const Points<D>& a, const Points<D>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
/// lib/normal.h: what the cells from pixel i on give to their corner, for as many cells as a vector has lanes.
template <size_t kCorner, class D, class Lanes>
HWY_INLINE Points<D> corner_normal(D d, Lanes mask, ClothState& state, size_t i) {
  const hn::RebindToUnsigned<D> du;
  const auto bits = load(du, mask, &state.data.cell[i]);
  const auto has = [&](uint32_t bit) GEOCLOTH_LANES {
    return hn::RebindMask(d, hn::Ne(hn::And(bits, hn::Set(du, bit)), hn::Zero(du)));
  };
  const size_t width = state.data.width;
  const Points<D> p0 = load(d, mask, at(state.position, i)), p1 = load(d, mask, at(state.position, i + 1));
  const Points<D> p2 = load(d, mask, at(state.position, i + width));
  const Points<D> p3 = load(d, mask, at(state.position, i + width + 1));
  const auto left = has(shader::kCellDiagonalLeftBit);
  const auto first = has(shader::kCellFirstBit), second = has(shader::kCellSecondBit);
  const Points<D> n1 = cross<D>(sub(p2, p0), sub(choose<D>(left, p1, p3), p0));
  const Points<D> a = choose<D>(left, p1, p0);
  const Points<D> n2 = cross<D>(sub(choose<D>(left, p2, p3), a), sub(choose<D>(left, p3, p1), a));
  const Points<D> zero{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  if constexpr (kCorner == 0) return add(add(zero, only<D>(first, n1)), only<D>(hn::AndNot(left, second), n2));
  if constexpr (kCorner == 1) return add(add(zero, only<D>(hn::And(first, left), n1)), only<D>(second, n2));
  if constexpr (kCorner == 2) return add(add(zero, only<D>(first, n1)), only<D>(hn::And(second, left), n2));
  return add(add(zero, only<D>(hn::AndNot(left, first), n1)), only<D>(second, n2));
}

/// Pixels with all four cells inside the image; the outermost ones are taken one by one.
template <class D>
HWY_INLINE void normals_of_run(D d, ClothState& state, const Run& run) {
  const uint32_t width = state.data.width, y = run.first / width;
  if (y == 0 || y + 1 == state.data.height) return normal_pixels(state, run.first, run.last);
  if (run.first % width == 0) normal_pixels(state, run.first, run.first + 1);
  if (run.last % width == 0) normal_pixels(state, run.last - 1, run.last);
  const Run inner{run.first + (run.first % width == 0 ? 1 : 0), run.last - (run.last % width == 0 ? 1 : 0)};
  for_run(d, inner, [&](uint32_t i, auto mask) GEOCLOTH_LANES {
    const Points<D> sum =
        add(add(add(corner_normal<3>(d, mask, state, i - 1 - width), corner_normal<2>(d, mask, state, i - width)),
                corner_normal<1>(d, mask, state, i - 1)),
            corner_normal<0>(d, mask, state, i));
    const auto l = length(d, sum);
    const auto long_enough = hn::Gt(l, hn::Set(d, 1e-30F));
    const auto inverse = hn::IfThenElseZero(long_enough, hn::Div(hn::Set(d, 1.F), l));
    store(d, scale(d, sum, inverse), mask, at(state.normal, i));
    store(d, hn::IfThenElseZero(long_enough, l), mask, &state.normal_length[i]);
  });
}
template <class D>
HWY_NOINLINE void normals(D d, ClothState& state, std::span<const Run> runs) {
  for (const Run& run : runs) normals_of_run(d, state, run);
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
