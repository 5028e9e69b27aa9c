// SPDX-License-Identifier: Apache-2.0
// Points of a cloth in vectors, lane by lane: loads, stores and choices beside the algebra of points_inl.h.
#if defined(GEOCLOTH_CPU_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_LANES_INL_H
#undef GEOCLOTH_CPU_LANES_INL_H
#else
#define GEOCLOTH_CPU_LANES_INL_H
#endif

#include <algorithm>
#include <array>

#include <hwy/highway.h>

#include "cpu/sweep.h"
#include "points_inl.h"

/// Of a lambda with vectors: for the instruction set at hand, and part of whoever calls it. A call would take every
/// vector through memory.
#ifndef GEOCLOTH_LANES
#define GEOCLOTH_LANES HWY_ATTR __attribute__((always_inline))
#endif

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

using geocloth::HWY_NAMESPACE::add;
using geocloth::HWY_NAMESPACE::dot;
using geocloth::HWY_NAMESPACE::length;
using geocloth::HWY_NAMESPACE::Points;
using geocloth::HWY_NAMESPACE::scale;
using geocloth::HWY_NAMESPACE::set;
using geocloth::HWY_NAMESPACE::shifted;
using geocloth::HWY_NAMESPACE::sub;
using geocloth::HWY_NAMESPACE::Vec;

template <class D>
using Mask = hn::Mask<D>;

/// The same index, but the compiler does not know that: it addresses what it writes by it, as it did what it read. Else
/// it keeps six addresses between the two, in registers that it has not got.
HWY_INLINE size_t anew(size_t i) {
#ifdef __GNUC__
  asm("" : "+r"(i));
#endif
  return i;
}

/// Coordinates in memory.
struct PointRow {
  float* x;
  float* y;
  float* z;
};
HWY_INLINE PointRow at(Vec3Array& a, size_t i) {
  return {a.x.data() + i, a.y.data() + i, a.z.data() + i};
}

/// So many pixels further on.
HWY_INLINE PointRow after(const PointRow& p, size_t i) {
  return {p.x + i, p.y + i, p.z + i};
}

template <class D>
HWY_INLINE Points<D> load(D d, const PointRow& p) {
  return {hn::LoadU(d, p.x), hn::LoadU(d, p.y), hn::LoadU(d, p.z)};
}
template <class D>
HWY_INLINE void store(D d, const Points<D>& v, const PointRow& p) {
  hn::StoreU(v.x, d, p.x);
  hn::StoreU(v.y, d, p.y);
  hn::StoreU(v.z, d, p.z);
}

/// lib/vector.h: unit_and_length().
template <class D>
struct UnitAndLength {
  Points<D> unit;
  Vec<D> length;
};
template <class D>
HWY_INLINE UnitAndLength<D> unit_and_length(D d, const Points<D>& a) {
  const auto l = length(d, a);
  const auto has_direction = hn::Gt(l, hn::Set(d, 1e-30F));
  return {scale(d, a, hn::IfThenElseZero(has_direction, hn::Div(hn::Set(d, 1.F), l))),
          hn::IfThenElseZero(has_direction, l)};
}

/// Which lanes count: all of a vector, or the first ones at the end of a run.
struct AllLanes {};
struct FirstLanes {
  size_t count;
};
template <class D, class T>
HWY_INLINE hn::Vec<D> load(D d, AllLanes, const T* p) {
  return hn::LoadU(d, p);
}
template <class D>
HWY_INLINE void store(D d, Vec<D> v, AllLanes, hn::TFromD<D>* p) {
  hn::StoreU(v, d, p);
}
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
template <class D, class T>
HWY_INLINE hn::Vec<D> load(D d, FirstLanes lanes, const T* p) {
  return hn::MaskedLoad(hn::FirstN(d, lanes.count), d, p);
}
template <class D>
HWY_INLINE void store(D d, Vec<D> v, FirstLanes lanes, hn::TFromD<D>* p) {
  hn::BlendedStore(v, hn::FirstN(d, lanes.count), d, p);
}
#else  // there masked access touches all of a vector, and wants it aligned
template <class D, class T>
HWY_INLINE hn::Vec<D> load(D d, FirstLanes lanes, const T* p) {
  HWY_ALIGN std::array<T, hn::MaxLanes(D())> buffer{};
  std::copy_n(p, lanes.count, buffer.begin());
  return hn::Load(d, buffer.data());
}
template <class D>
HWY_INLINE void store(D d, Vec<D> v, FirstLanes lanes, hn::TFromD<D>* p) {
  HWY_ALIGN std::array<hn::TFromD<D>, hn::MaxLanes(D())> buffer;
  hn::Store(v, d, buffer.data());
  std::copy_n(buffer.begin(), lanes.count, p);
}
#endif
template <class D, class Lanes>
HWY_INLINE Points<D> load(D d, Lanes lanes, const PointRow& p) {
  return {load(d, lanes, p.x), load(d, lanes, p.y), load(d, lanes, p.z)};
}
template <class D, class Lanes>
HWY_INLINE void store(D d, const Points<D>& v, Lanes lanes, const PointRow& p) {
  store(d, v.x, lanes, p.x);
  store(d, v.y, lanes, p.y);
  store(d, v.z, lanes, p.z);
}
template <class D>
HWY_INLINE Points<D> choose(Mask<D> mask, const Points<D>& yes, const Points<D>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z)};
}
/// Instead of points those of some lanes, coordinate by coordinate: GCC copies a struct in pieces of 16 bytes, and to
/// read them as a whole vector then waits until they are written.
template <class D>
HWY_INLINE void replace(Mask<D> mask, const Points<D>& by, Points<D>& points) {
  points.x = hn::IfThenElse(mask, by.x, points.x);
  points.y = hn::IfThenElse(mask, by.y, points.y);
  points.z = hn::IfThenElse(mask, by.z, points.z);
}
/// Coordinate by coordinate, too.
template <class D>
HWY_INLINE void assign(Points<D>& to, const Points<D>& from) {
  to.x = from.x;
  to.y = from.y;
  to.z = from.z;
}
template <class D>
HWY_INLINE Points<D> only(Mask<D> mask, const Points<D>& a) {
  return {hn::IfThenElseZero(mask, a.x), hn::IfThenElseZero(mask, a.y), hn::IfThenElseZero(mask, a.z)};
}

/// Calls body(first pixel, lanes that count) for a run.
template <class D, class Body>
HWY_INLINE void for_run(D d, const Run& run, const Body& body) {
  const auto lanes = static_cast<uint32_t>(hn::Lanes(d));
  uint32_t i = run.first;
  for (; i + lanes <= run.last; i += lanes) body(i, AllLanes());
  if (i < run.last) body(i, FirstLanes{run.last - i});
}
/// Calls body(first pixel) for runs of whole vectors.
template <class D, class Body>
HWY_INLINE void for_vectors(D d, std::span<const Run> runs, const Body& body) {
  for (const Run& run : runs)
    for (uint32_t i = run.first; i < run.last; i += static_cast<uint32_t>(hn::Lanes(d))) body(i);
}
/// Calls body(lane) for each of some lanes.
template <class D, class Body>
HWY_INLINE void for_lanes(D d, Mask<D> lanes, const Body& body) {
  std::array<uint8_t, 8> bits{};
  hn::StoreMaskBits(d, lanes, bits.data());
  for (uint32_t k = 0; k < hn::Lanes(d); ++k)
    if ((bits[k / 8] >> k % 8 & 1) != 0) body(k);
}
/// Lanes whose point moves. What is pinned has no mass here, and no cloth has none either.
template <class D>
HWY_INLINE Mask<D> free_lanes(D d, const float* inverse_mass) {
  return hn::Gt(hn::LoadU(d, inverse_mass), hn::Zero(d));
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
