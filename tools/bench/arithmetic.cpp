// SPDX-License-Identifier: GPL-3.0-or-later
// Compiled once for every instruction set; the best one that the processor has is chosen when the program runs.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/arithmetic.cpp"
#include "bench/arithmetic.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geocloth::HWY_NAMESPACE {

ArithmeticRun run(uint32_t rounds) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::ScalableTag<float> d;
  constexpr double kChains = 12;
  const auto scale = hn::Set(d, 0.9999F), shift = hn::Set(d, 1e-4F);
  auto a = hn::Iota(d, 0.F), b = hn::Iota(d, 1.F), c = hn::Iota(d, 2.F), e = hn::Iota(d, 3.F);
  auto f = hn::Iota(d, 4.F), g = hn::Iota(d, 5.F), h = hn::Iota(d, 6.F), i = hn::Iota(d, 7.F);
  auto j = hn::Iota(d, 8.F), k = hn::Iota(d, 9.F), l = hn::Iota(d, 10.F), m = hn::Iota(d, 11.F);
  for (uint32_t r = 0; r < rounds; ++r) {
    a = hn::MulAdd(a, scale, shift);
    b = hn::MulAdd(b, scale, shift);
    c = hn::MulAdd(c, scale, shift);
    e = hn::MulAdd(e, scale, shift);
    f = hn::MulAdd(f, scale, shift);
    g = hn::MulAdd(g, scale, shift);
    h = hn::MulAdd(h, scale, shift);
    i = hn::MulAdd(i, scale, shift);
    j = hn::MulAdd(j, scale, shift);
    k = hn::MulAdd(k, scale, shift);
    l = hn::MulAdd(l, scale, shift);
    m = hn::MulAdd(m, scale, shift);
  }
  const auto sum = hn::Add(hn::Add(hn::Add(hn::Add(a, b), hn::Add(c, e)), hn::Add(hn::Add(f, g), hn::Add(h, i))),
                           hn::Add(hn::Add(j, k), hn::Add(l, m)));
  return {hn::GetLane(hn::SumOfLanes(d, sum)), 2 * kChains * rounds * static_cast<double>(hn::Lanes(d))};
}

}  // namespace geocloth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth {

HWY_EXPORT(run);
ArithmeticRun run_arithmetic(uint32_t rounds) {
  return HWY_DYNAMIC_DISPATCH(run)(rounds);
}

}  // namespace geocloth
#endif
