// SPDX-License-Identifier: Apache-2.0
// The passes of shaders/lib in vectors, for every instruction set that Highway knows; the best one is chosen when the
// program runs. Each operation is the one that the shared text names, in its order, so that the bits are the same.
//
// Rows are contiguous, so constraints across rows vectorise as they stand. Along a row two vectors are taken apart into
// the ends of the constraints (even and odd columns) by shuffles that stay within 128 bits, and put together again.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <thread>

#include "cpu/collider_set.h"
#include "cpu/sweep.h"
#include "lib/normal.h"

// Vectors whose length is not known when compiling cannot be members of a struct.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/sweep_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR  // no vectors: nothing is planned for one lane, the plain path runs

void run_sweep_here(uint32_t, const SweepFrame&, uint32_t, const std::atomic<uint32_t>*, std::atomic<uint32_t>*) {}
void run_normals_here(uint32_t, ClothState& state, std::span<const Run> runs) {
  for (const Run& run : runs) normal_pixels(state, run.first, run.last);
}
uint32_t lanes_here() {
  return 1;
}

#else

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using Vec = hn::VFromD<D>;
template <class D>
using Mask = hn::Mask<D>;

/// Three components of as many points as a vector has lanes.
template <class D>
struct Points {
  Vec<D> x, y, z;
};

/// Coordinates in memory.
struct PointRow {
  float* x;
  float* y;
  float* z;
};
HWY_INLINE PointRow at(Vec3Array& a, size_t i) {
  return {a.x.data() + i, a.y.data() + i, a.z.data() + i};
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
HWY_INLINE Vec<D> dot(D, const Points<D>& a, const Points<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class D>
HWY_INLINE Vec<D> length(D d, const Points<D>& a) {
  return hn::Sqrt(dot(d, a, a));
}

// Constraints ---------------------------------------------------------------------------------------------------------

/// lib/spring.h for the first relaxation step, with inverse = 1 / (wa + wb + compliance), 0 where there is no spring.
template <class D>
HWY_INLINE void project_spring(D d, Points<D>& a, Vec<D> wa, Points<D>& b, Vec<D> wb, const float* constants,
                               Vec<D> share) {
  const auto rest = hn::LoadU(d, constants), inverse = hn::LoadU(d, constants + hn::Lanes(d));
  const Points<D> way = sub(b, a);
  const auto l = length(d, way);
  const auto exists = hn::And(hn::Gt(inverse, hn::Zero(d)), hn::Gt(l, hn::Set(d, 1e-12F)));
  const auto change = hn::Mul(hn::Mul(share, hn::Sub(l, rest)), inverse);
  const auto factor = hn::IfThenElseZero(exists, hn::Mul(change, hn::Div(hn::Set(d, 1.F), l)));
  const Points<D> step = scale(d, way, factor);
  a = add(a, scale(d, step, wa));
  b = sub(b, scale(d, step, wb));
}

/// lib/bend.h for the first relaxation step, with inverse = 1 / (w + compliance), 0 where there is no bend.
template <class D>
HWY_INLINE void project_bend(D d, Points<D>& a, Vec<D> wa, Points<D>& middle, Vec<D> wm, Points<D>& b, Vec<D> wb,
                             const float* constants) {
  const size_t lanes = hn::Lanes(d);
  const auto rest = hn::LoadU(d, constants), inverse = hn::LoadU(d, constants + lanes);
  const auto chord = hn::LoadU(d, constants + 2 * lanes), back = hn::Sub(hn::Set(d, 1.F), chord);
  const Points<D> e = add(scale(d, sub(a, middle), back), scale(d, sub(b, middle), chord));
  const auto l = length(d, e);
  const auto exists = hn::And(hn::Gt(inverse, hn::Zero(d)), hn::Gt(l, hn::Set(d, 1e-12F)));
  const auto change = hn::Mul(hn::Sub(l, rest), inverse);
  const auto factor = hn::IfThenElseZero(exists, hn::Mul(change, hn::Div(hn::Set(d, 1.F), l)));
  const Points<D> step = scale(d, e, factor);
  a = sub(a, scale(d, step, hn::Mul(wa, back)));
  middle = add(middle, scale(d, step, wm));
  b = sub(b, scale(d, step, hn::Mul(wb, chord)));
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

template <class D>
HWY_NOINLINE void springs_across(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const auto share = hn::Set(d, op.share);
  const size_t size = 2 * hn::Lanes(d);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k], j = i + op.offset;
    const PointRow pa = at(state.position, i), pb = at(state.position, j);
    Points<D> a = load(d, pa), b = load(d, pb);
    project_spring(d, a, hn::LoadU(d, &state.inverse_mass[i]), b, hn::LoadU(d, &state.inverse_mass[j]),
                   &op.stream->constants[k * size], share);
    store(d, a, pa);
    store(d, b, pb);
  }
}

template <size_t kColumns, class D>
HWY_NOINLINE void springs_along(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const auto share = hn::Set(d, op.share);
  const size_t size = 2 * hn::Lanes(d);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k];
    const PointRow p = at(state.position, i);
    const Ends<D> x = take_apart<kColumns>(d, p.x), y = take_apart<kColumns>(d, p.y), z = take_apart<kColumns>(d, p.z);
    const Ends<D> w = take_apart<kColumns>(d, &state.inverse_mass[i]);
    Points<D> a{x.a, y.a, z.a}, b{x.b, y.b, z.b};
    project_spring(d, a, w.a, b, w.b, &op.stream->constants[k * size], share);
    put_together<kColumns>(d, a.x, b.x, p.x);
    put_together<kColumns>(d, a.y, b.y, p.y);
    put_together<kColumns>(d, a.z, b.z, p.z);
  }
}

template <class D>
HWY_NOINLINE void bends_across(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const size_t size = 3 * hn::Lanes(d);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k], m = i + op.offset, j = m + op.offset;
    const PointRow pa = at(state.position, i), pm = at(state.position, m), pb = at(state.position, j);
    Points<D> a = load(d, pa), middle = load(d, pm), b = load(d, pb);
    project_bend(d, a, hn::LoadU(d, &state.inverse_mass[i]), middle, hn::LoadU(d, &state.inverse_mass[m]), b,
                 hn::LoadU(d, &state.inverse_mass[j]), &op.stream->constants[k * size]);
    store(d, a, pa);
    store(d, middle, pm);
    store(d, b, pb);
  }
}

template <class D>
HWY_NOINLINE void bends_along(D d, const SweepOp& op, ClothState& state, uint32_t first, uint32_t last) {
  const size_t size = 3 * hn::Lanes(d);
  for (uint32_t k = first; k < last; ++k) {
    const size_t i = op.stream->pixel[k];
    const PointRow p = at(state.position, i);
    Points<D> a, middle, b;
    Vec<D> wa, wm, wb;
    hn::LoadInterleaved3(d, p.x, a.x, middle.x, b.x);
    hn::LoadInterleaved3(d, p.y, a.y, middle.y, b.y);
    hn::LoadInterleaved3(d, p.z, a.z, middle.z, b.z);
    hn::LoadInterleaved3(d, &state.inverse_mass[i], wa, wm, wb);
    project_bend(d, a, wa, middle, wm, b, wb, &op.stream->constants[k * size]);
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

// Points --------------------------------------------------------------------------------------------------------------

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
HWY_INLINE void store(D d, Vec<D> v, AllLanes, float* p) {
  hn::StoreU(v, d, p);
}
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
template <class D, class T>
HWY_INLINE hn::Vec<D> load(D d, FirstLanes lanes, const T* p) {
  return hn::MaskedLoad(hn::FirstN(d, lanes.count), d, p);
}
template <class D>
HWY_INLINE void store(D d, Vec<D> v, FirstLanes lanes, float* p) {
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
HWY_INLINE void store(D d, Vec<D> v, FirstLanes lanes, float* p) {
  HWY_ALIGN std::array<float, hn::MaxLanes(D())> buffer;
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

/// lib/vector.h: sin(2 pi t).
template <class D>
HWY_INLINE Vec<D> sine_of_turns(D d, Vec<D> t) {
  const auto half = hn::Set(d, 0.5F), quarter = hn::Set(d, 0.25F);
  auto r = hn::Sub(t, hn::Floor(hn::Add(t, half)));
  r = hn::IfThenElse(hn::Gt(r, quarter), hn::Sub(half, r), r);
  r = hn::IfThenElse(hn::Lt(r, hn::Neg(quarter)), hn::Sub(hn::Neg(half), r), r);
  const auto x = hn::Mul(r, hn::Set(d, 6.28318531F));
  const auto x2 = hn::Mul(x, x);
  auto s = hn::Add(hn::Set(d, -1.98412698e-4F), hn::Mul(x2, hn::Set(d, 2.75573192e-6F)));
  s = hn::Add(hn::Set(d, 8.33333333e-3F), hn::Mul(x2, s));
  s = hn::Add(hn::Set(d, -1.66666667e-1F), hn::Mul(x2, s));
  s = hn::Add(hn::Set(d, 1.F), hn::Mul(x2, s));
  return hn::Mul(x, s);
}

/// lib/predict.h: acceleration by the air.
template <class D>
HWY_INLINE Points<D> air_acceleration(D d, const shader::ClothParams& params, const shader::Substep& substep,
                                      const Points<D>& position, const Points<D>& velocity, const Points<D>& normal) {
  Points<D> air = set(d, params.wind.x, params.wind.y, params.wind.z);
  for (const shader::Wave& wave : substep.waves) {
    const Points<D> direction = set(d, wave.wave.x, wave.wave.y, wave.wave.z);
    const auto turns = hn::Add(dot(d, direction, position), hn::Set(d, wave.wave.w));
    air = add(air, scale(d, set(d, wave.gust.x, wave.gust.y, wave.gust.z), sine_of_turns(d, turns)));
  }
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.F);
  const Points<D> v = sub(air, velocity);
  const auto speed = length(d, v);
  const auto toward = dot(d, v, normal);
  const auto c = hn::Abs(toward);
  const auto drag = hn::Mul(hn::Set(d, params.air_factor * params.drag), c);
  const auto lift = hn::Mul(hn::Set(d, params.air_factor * params.lift), c);
  const auto inverse_speed = hn::IfThenElseZero(hn::Gt(speed, hn::Set(d, 1e-9F)), hn::Div(one, speed));
  const auto backwards = hn::Lt(toward, zero);
  const Points<D> lee{hn::IfThenElse(backwards, hn::Neg(normal.x), normal.x),
                      hn::IfThenElse(backwards, hn::Neg(normal.y), normal.y),
                      hn::IfThenElse(backwards, hn::Neg(normal.z), normal.z)};
  const Points<D> sideways = sub(scale(d, lee, speed), scale(d, v, hn::Mul(c, inverse_speed)));
  const Points<D> force = add(scale(d, v, drag), scale(d, sideways, lift));
  return scale(d, force, hn::Div(one, hn::Add(one, hn::Mul(hn::Add(drag, lift), hn::Set(d, params.dt)))));
}

/// lib/predict.h. What is pinned stays.
template <class D>
HWY_NOINLINE void predict(D d, const PassContext& context, ClothState& state, const Run& run) {
  const shader::ClothParams& params = context.cloth.params;
  const Points<D> gravity = set(d, params.gravity_step.x, params.gravity_step.y, params.gravity_step.z);
  const auto keep = hn::Set(d, params.keep), dt2 = hn::Set(d, params.dt * params.dt);
  for_run(d, run, [&](uint32_t i, auto mask) HWY_ATTR {
    const PointRow p = at(state.position, i), pp = at(state.previous, i), pc = at(state.carry, i);
    const Points<D> position = load(d, mask, p), carry = load(d, mask, pc);
    const Points<D> way = add(sub(position, load(d, mask, pp)), carry);
    Points<D> acceleration{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    if (params.air != 0) {
      acceleration = air_acceleration(d, params, context.frame.substeps[context.substep], position,
                                      scale(d, way, hn::Set(d, params.inverse_dt)), load(d, mask, at(state.normal, i)));
    }
    const Points<D> increment = add(add(scale(d, way, keep), gravity), scale(d, acceleration, dt2));
    const Points<D> next = add(position, increment);
    const Points<D> lost = sub(increment, sub(next, position));
    const auto free = hn::Gt(load(d, mask, &state.inverse_mass[i]), hn::Zero(d));
    store(d, position, mask, pp);
    store(d, choose<D>(free, next, position), mask, p);
    store(d, choose<D>(free, lost, carry), mask, pc);
  });
}

// Collisions ----------------------------------------------------------------------------------------------------------

/// The points of collide.h, lane by lane.
template <class D>
struct PointStates {
  Points<D> position, previous, carry;
};

/// lib/collide.h: between the world and a collider's frame.
template <class D>
HWY_INLINE Points<D> to_local(D d, const shader::ColliderPose& pose, const Points<D>& p) {
  const Points<D> from = sub(p, set(d, pose.row0.w, pose.row1.w, pose.row2.w));
  return add(add(scale(d, set(d, pose.row0.x, pose.row0.y, pose.row0.z), from.x),
                 scale(d, set(d, pose.row1.x, pose.row1.y, pose.row1.z), from.y)),
             scale(d, set(d, pose.row2.x, pose.row2.y, pose.row2.z), from.z));
}
template <class D>
HWY_INLINE Points<D> rotate_to_world(D d, const shader::ColliderPose& pose, const Points<D>& v) {
  return {dot(d, set(d, pose.row0.x, pose.row0.y, pose.row0.z), v),
          dot(d, set(d, pose.row1.x, pose.row1.y, pose.row1.z), v),
          dot(d, set(d, pose.row2.x, pose.row2.y, pose.row2.z), v)};
}
template <class D>
HWY_INLINE Points<D> to_world(D d, const shader::ColliderPose& pose, const Points<D>& p) {
  return add(rotate_to_world(d, pose, p), set(d, pose.row0.w, pose.row1.w, pose.row2.w));
}

/// lib/shapes.h: signed distance and outward normal.
template <class D>
struct Nearest {
  Vec<D> distance;
  Points<D> normal;
};
template <class D>
HWY_INLINE Nearest<D> nearest_ball(D d, const Points<D>& from_center, Vec<D> radius) {
  const auto l = length(d, from_center);
  const auto has_direction = hn::Gt(l, hn::Set(d, 1e-30F));
  const auto inverse = hn::IfThenElseZero(has_direction, hn::Div(hn::Set(d, 1.F), l));
  return {hn::Sub(hn::IfThenElseZero(has_direction, l), radius),
          choose<D>(has_direction, scale(d, from_center, inverse), set(d, 0, 1, 0))};
}
template <class D>
HWY_INLINE Nearest<D> nearest_of_shape(D d, const shader::ColliderShape& shape, const Points<D>& p) {
  if (shape.kind == shader::kShapePlane) return {p.y, set(d, 0, 1, 0)};
  if (shape.kind == shader::kShapeSphere) return nearest_ball(d, p, hn::Set(d, shape.a.x));
  const auto end = hn::Set(d, shape.a.x), start = hn::Neg(end);
  const auto rho = hn::Sqrt(hn::Add(hn::Mul(p.y, p.y), hn::Mul(p.z, p.z)));
  auto along = hn::Sub(p.x, hn::Mul(rho, hn::Set(d, shape.b.y)));
  along = hn::IfThenElse(hn::Lt(along, start), start, along);
  along = hn::IfThenElse(hn::Lt(end, along), end, along);
  const auto radius = hn::Sub(hn::Set(d, 0.5F * (shape.a.y + shape.a.z)), hn::Mul(hn::Set(d, shape.b.x), along));
  return nearest_ball(d, sub(p, Points<D>{along, hn::Zero(d), hn::Zero(d)}), radius);
}

/// respond() of lib/collide.h.
template <class D>
HWY_INLINE PointStates<D> respond(D d, const PointStates<D>& point, const shader::ColliderPose& before,
                                  const shader::ColliderPose& after, const Points<D>& local, const Points<D>& normal,
                                  Vec<D> depth, Vec<D> friction) {
  const auto one = hn::Set(d, 1.F), zero = hn::Zero(d);
  const Points<D> n = rotate_to_world(d, after, normal);
  const Points<D> on_surface = add(local, scale(d, normal, depth));
  const Points<D> carried = sub(to_world(d, after, on_surface), to_world(d, before, on_surface));
  const Points<D> displacement = add(sub(point.position, point.previous), point.carry);
  const Points<D> relative = sub(displacement, carried);
  const auto along = dot(d, relative, n);
  const Points<D> sliding = sub(relative, scale(d, n, along));
  const auto slid = length(d, sliding);
  const auto brake = hn::Mul(friction, depth);
  const auto held = hn::IfThenElse(hn::Gt(slid, brake), hn::Mul(brake, hn::Div(one, slid)), one);

  PointStates<D> r;
  r.position = sub(add(point.position, scale(d, n, depth)), scale(d, sliding, held));
  const Points<D> kept = add(add(carried, scale(d, sliding, hn::Sub(one, held))),
                             scale(d, n, hn::IfThenElse(hn::Lt(along, zero), zero, along)));
  r.previous = sub(r.position, kept);
  r.carry = sub(kept, sub(r.position, r.previous));
  return r;
}

/// collide() of lib/collide.h for simple shapes.
/// @return false, with nothing done, when a point moves so far that it has to be swept
template <class D>
HWY_INLINE bool collide_lanes(D d, const PassContext& context, Mask<D> lanes, PointStates<D>& points) {
  const FrameInput& frame = context.frame;
  const shader::ClothParams& params = context.cloth.params;
  const size_t count = frame.shapes.size();
  const shader::ColliderPose* poses = frame.poses.data() + context.substep * count;
  const auto thickness = hn::Set(d, params.thickness);
  const Points<D> start = points.previous;
  PointStates<D> state = points;
  Mask<D> again = lanes;
  for (uint32_t round = 0; round < shader::kContactRounds && !hn::AllFalse(d, again); ++round) {
    Mask<D> touched = hn::Gt(hn::Zero(d), hn::Zero(d));
    auto way = length(d, sub(state.position, start));
    for (size_t i = 0; i < count; ++i) {
      const shader::ColliderShape& shape = frame.shapes[i];
      const shader::ColliderPose &before = poses[i], &after = poses[count + i];
      const Points<D> local = to_local(d, after, state.position);
      const Nearest<D> near = nearest_of_shape(d, shape, local);
      const auto gap = hn::Sub(near.distance, thickness);
      const auto reach = hn::Mul(hn::Set(d, 2.F), hn::Add(way, hn::Set(d, shape.way)));
      const auto local_way = length(d, sub(local, to_local(d, before, start)));
      const auto met = hn::AndNot(hn::Or(hn::Gt(gap, reach), hn::Gt(gap, local_way)), again);
      if (hn::AllFalse(d, met)) continue;
      if (round == 0 && !hn::AllFalse(d, hn::And(met, hn::Gt(local_way, hn::Set(d, 0.5F * shape.core))))) return false;
      const auto depth = hn::Neg(gap);
      auto touches = hn::And(met, hn::Lt(gap, hn::Zero(d)));
      if (round > 0) touches = hn::And(touches, hn::Gt(depth, hn::Set(d, shader::kContactSlack)));
      if (hn::AllFalse(d, touches)) continue;
      const float friction = round == 0 ? std::sqrt(params.friction * shape.friction) : 0.F;
      const PointStates<D> moved = respond(d, state, before, after, local, near.normal, depth, hn::Set(d, friction));
      state = {choose<D>(touches, moved.position, state.position), choose<D>(touches, moved.previous, state.previous),
               choose<D>(touches, moved.carry, state.carry)};
      way = length(d, sub(state.position, start));
      if (count > 1) touched = hn::Or(touched, touches);
    }
    again = touched;
  }
  points = state;
  return true;
}

/// Points that a collider may touch when they went that way.
template <class D>
HWY_INLINE Mask<D> near_colliders(D d, const SweepFrame& frame, uint32_t substep, const Points<D>& position,
                                  Vec<D> way) {
  const size_t count = frame.contexts[substep].frame.shapes.size();
  const ColliderGuard* guards = frame.guards + substep * count;
  const auto twice = hn::Add(way, way);
  Mask<D> near = hn::Gt(hn::Zero(d), hn::Zero(d));
  for (size_t c = 0; c < count; ++c) {
    const ColliderGuard& guard = guards[c];
    const Points<D> place = set(d, guard.x, guard.y, guard.z);
    const auto reach = hn::Add(hn::Set(d, guard.reach), twice);
    if (guard.plane) {
      near = hn::Or(near, hn::Lt(dot(d, position, place), reach));
    } else {
      const Points<D> from = sub(position, place);
      near = hn::Or(near, hn::Lt(dot(d, from, from), hn::Mul(reach, reach)));
    }
  }
  return near;
}

/// Where no collider can reach, collide.h leaves a point as it is.
template <class D>
HWY_NOINLINE void collide(D d, const SweepFrame& frame, uint32_t substep, const Run& run) {
  const PassContext& context = frame.contexts[substep];
  ClothState& state = *frame.state;
  if (frame.collide_all) return collide_pixels(context, state, run.first, run.last);
  for_run(d, run, [&](uint32_t i, auto lanes) HWY_ATTR {
    const PointRow p = at(state.position, i), pp = at(state.previous, i), pc = at(state.carry, i);
    PointStates<D> points;
    points.position = load(d, lanes, p);
    points.previous = load(d, lanes, pp);
    const auto way = length(d, sub(points.position, points.previous));
    const auto near = near_colliders(d, frame, substep, points.position, way);
    if (hn::AllFalse(d, near)) return;
    points.carry = load(d, lanes, pc);
    const auto free = hn::Gt(load(d, lanes, &state.inverse_mass[i]), hn::Zero(d));
    if (!frame.simple_colliders || !collide_lanes(d, context, hn::And(free, near), points)) {
      return collide_pixels(context, state, i, std::min(run.last, i + static_cast<uint32_t>(hn::Lanes(d))));
    }
    store(d, points.position, lanes, p);
    store(d, points.previous, lanes, pp);
    store(d, points.carry, lanes, pc);
  });
}

template <class D>
HWY_NOINLINE void check_colliders(D d, const SweepFrame& frame, uint32_t substep, const Run& run) {
  const PassContext& context = frame.contexts[substep];
  ClothState& state = *frame.state;
  float depth = frame.penetration[substep];
  for_run(d, run, [&](uint32_t i, auto lanes) HWY_ATTR {
    const Points<D> position = load(d, lanes, at(state.position, i));
    if (hn::AllFalse(d, near_colliders(d, frame, substep, position, hn::Zero(d)))) return;
    const uint32_t last = std::min(run.last, i + static_cast<uint32_t>(hn::Lanes(d)));
    depth = std::max(depth, penetration_of_pixels(context, state, i, last));
  });
  frame.penetration[substep] = depth;
}

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
  const auto has = [&](uint32_t bit)
                       HWY_ATTR { return hn::RebindMask(d, hn::Ne(hn::And(bits, hn::Set(du, bit)), hn::Zero(du))); };
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
HWY_NOINLINE void normals(D d, ClothState& state, const Run& run) {
  const uint32_t width = state.data.width, y = run.first / width;
  if (y == 0 || y + 1 == state.data.height) return normal_pixels(state, run.first, run.last);
  if (run.first % width == 0) normal_pixels(state, run.first, run.first + 1);
  if (run.last % width == 0) normal_pixels(state, run.last - 1, run.last);
  const Run inner{run.first + (run.first % width == 0 ? 1 : 0), run.last - (run.last % width == 0 ? 1 : 0)};
  for_run(d, inner, [&](uint32_t i, auto mask) HWY_ATTR {
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

// Sweep ---------------------------------------------------------------------------------------------------------------

template <class D>
HWY_INLINE void run_row(D d, const SweepFrame& frame, const SweepOp& op, uint32_t substep, uint32_t y) {
  ClothState& state = *frame.state;
  const RowStream& stream = *op.stream;
  const uint32_t first = stream.row_first[y], last = stream.row_first[y + 1];
  switch (op.kernel) {
    case RowKernel::normals:
      for (uint32_t k = first; k < last; ++k) normals(d, state, stream.runs[k]);
      break;
    case RowKernel::predict:
      for (uint32_t k = first; k < last; ++k) predict(d, frame.contexts[substep], state, stream.runs[k]);
      break;
    case RowKernel::pins:
      if (first < last) move_pins(frame.contexts[substep], state, first, last);
      break;
    case RowKernel::springs_across:
      springs_across(d, op, state, first, last);
      break;
    case RowKernel::springs_along:
      springs_along<1>(d, op, state, first, last);
      break;
    case RowKernel::springs_along_two:
      springs_along<2>(d, op, state, first, last);
      break;
    case RowKernel::bends_across:
      bends_across(d, op, state, first, last);
      break;
    case RowKernel::bends_along:
      bends_along(d, op, state, first, last);
      break;
    case RowKernel::limit:
      limit(d, op, state, frame.anchors + size_t{3} * frame.anchor_count * substep, frame.anchor_count, first, last);
      break;
    case RowKernel::collide:
      for (uint32_t k = first; k < last; ++k) collide(d, frame, substep, stream.runs[k]);
      break;
    case RowKernel::check_colliders:
      for (uint32_t k = first; k < last; ++k) check_colliders(d, frame, substep, stream.runs[k]);
      break;
  }
}

/// Spins a little, then lets others run: the thread ahead may be waiting for this core.
inline void wait_until(const std::atomic<uint32_t>& progress, uint32_t time) {
  constexpr int kSpins = 200;
  for (int spin = 0; progress.load(std::memory_order_acquire) < time; ++spin) {
    if (spin < kSpins) {
#if HWY_ARCH_X86
      __builtin_ia32_pause();
#endif
    } else {
      std::this_thread::yield();
    }
  }
}

/// One row in so many is timed: odd and no multiple of 3, so that all groups of rows are met.
constexpr uint32_t kSampledRows = 13;
constexpr uint32_t kFewRows = 100;  ///< that all are timed

template <class D>
HWY_NOINLINE void time_rows(D d, const SweepFrame& frame, uint32_t substep, uint32_t time) {
  using Clock = std::chrono::steady_clock;
  const std::vector<SweepOp>& ops = frame.sweep->ops;
  double* seconds = frame.seconds + substep * ops.size();
  auto start = Clock::now();
  for (size_t k = 0; k < ops.size() && ops[k].lag <= time; ++k) {
    if (time - ops[k].lag >= frame.state->data.height) continue;
    run_row(d, frame, ops[k], substep, time - ops[k].lag);
    const auto end = Clock::now();
    seconds[k] += std::chrono::duration<double>(end - start).count();
    start = end;
  }
}

template <class D>
void sweep_rows(D d, const SweepFrame& frame, uint32_t substep, const std::atomic<uint32_t>* ahead,
                std::atomic<uint32_t>* own) {
  const Sweep& sweep = *frame.sweep;
  const uint32_t height = frame.state->data.height, end = height + sweep.last_lag;
  for (uint32_t time = 0; time < end; ++time) {
    if (ahead != nullptr) wait_until(*ahead, std::min(end, time + sweep.distance));
    if (frame.seconds != nullptr && (end < kFewRows || time % kSampledRows == 0)) {
      time_rows(d, frame, substep, time);
    } else {
      for (const SweepOp& op : sweep.ops) {
        if (op.lag > time) break;  // lags ascend
        if (time - op.lag < height) run_row(d, frame, op, substep, time - op.lag);
      }
    }
    if (own != nullptr) own->store(time + 1, std::memory_order_release);
  }
}

/// Calls body(tag) with the tag of vectors of that many lanes.
template <class Body>
HWY_INLINE void with_lanes(uint32_t lanes, const Body& body) {
  const hn::ScalableTag<float> full;
  if (lanes == hn::Lanes(full)) return body(full);
  if (lanes == 8) return body(hn::CappedTag<float, 8>());
  body(hn::CappedTag<float, 4>());
}

void run_sweep_here(uint32_t lanes, const SweepFrame& frame, uint32_t substep, const std::atomic<uint32_t>* ahead,
                    std::atomic<uint32_t>* own) {
  with_lanes(lanes, [&](auto d) HWY_ATTR { sweep_rows(d, frame, substep, ahead, own); });
}

void run_normals_here(uint32_t lanes, ClothState& state, std::span<const Run> runs) {
  with_lanes(lanes, [&](auto d) HWY_ATTR {
    for (const Run& run : runs) normals(d, state, run);
  });
}

uint32_t lanes_here() {
  return static_cast<uint32_t>(hn::Lanes(hn::ScalableTag<float>()));
}
#endif

const char* target_here() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth::cpu {

HWY_EXPORT(run_sweep_here);
HWY_EXPORT(run_normals_here);
HWY_EXPORT(lanes_here);
HWY_EXPORT(target_here);

void run_sweep(uint32_t lanes, const SweepFrame& frame, uint32_t substep, const std::atomic<uint32_t>* ahead,
               std::atomic<uint32_t>* own) {
  HWY_DYNAMIC_DISPATCH(run_sweep_here)(lanes, frame, substep, ahead, own);
}
void run_normals(uint32_t lanes, ClothState& state, std::span<const Run> runs) {
  HWY_DYNAMIC_DISPATCH(run_normals_here)(lanes, state, runs);
}
uint32_t vector_lanes() {
  return HWY_DYNAMIC_DISPATCH(lanes_here)();
}
const char* vector_target() {
  return HWY_DYNAMIC_DISPATCH(target_here)();
}

}  // namespace geocloth::cpu
#endif
