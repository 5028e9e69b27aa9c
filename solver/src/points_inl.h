// SPDX-License-Identifier: Apache-2.0
// Points in vectors, lane by lane: the algebra of lib/vector.h, operation by operation.
#if defined(GEOCLOTH_POINTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_POINTS_INL_H
#undef GEOCLOTH_POINTS_INL_H
#else
#define GEOCLOTH_POINTS_INL_H
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geocloth::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using Vec = hn::VFromD<D>;

/// Three components of as many points as a vector has lanes.
template <class D>
struct Points {
  Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Points<D> set(D d, float x, float y, float z) {
  return {hn::Set(d, x), hn::Set(d, y), hn::Set(d, z)};
}
template <class D>
HWY_INLINE Points<D> add(const Points<D>& a, const Points<D>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class D>
HWY_INLINE Points<D> sub(const Points<D>& a, const Points<D>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class D>
HWY_INLINE Points<D> scale(D, const Points<D>& a, Vec<D> s) {
  return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}
template <class D>
HWY_INLINE Points<D> shifted(D d, const Points<D>& p, const Points<D>& step, Vec<D> s) {
  return add(p, scale(d, step, s));
}
template <class D>
HWY_INLINE Vec<D> dot(D, const Points<D>& a, const Points<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class D>
HWY_INLINE Vec<D> length(D d, const Points<D>& a) {
  return hn::Sqrt(dot(d, a, a));
}

}  // namespace geocloth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
