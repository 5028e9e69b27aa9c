// SPDX-License-Identifier: Apache-2.0
// Prediction and the forces of the air in vectors; see lib/predict.h.
#if defined(GEOCLOTH_CPU_PREDICT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_PREDICT_INL_H
#undef GEOCLOTH_CPU_PREDICT_INL_H
#else
#define GEOCLOTH_CPU_PREDICT_INL_H
#endif

#include "cpu/lanes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

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
  const Points<D> v = sub(scale(d, air, hn::Set(d, params.wind.w)), velocity);
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
  return scale(d, force, hn::Div(one, hn::Max(one, hn::Mul(hn::Add(drag, lift), hn::Set(d, params.dt)))));
}

/// lib/frame.h: displacement of points in a substep.
template <class D>
struct Field {
  Points<D> row0, row1, row2, shift;

  HWY_INLINE Field(D d, const shader::FrameField& field, float substep)
      : row0(set(d, field.row0.x, field.row0.y, field.row0.z)),
        row1(set(d, field.row1.x, field.row1.y, field.row1.z)),
        row2(set(d, field.row2.x, field.row2.y, field.row2.z)),
        shift(set(d, field.row0.w + field.drift.x * substep, field.row1.w + field.drift.y * substep,
                  field.row2.w + field.drift.z * substep)) {}
  HWY_INLINE Points<D> turn(D d, const Points<D>& v) const {
    return {dot(d, row0, v), dot(d, row1, v), dot(d, row2, v)};
  }
  HWY_INLINE Points<D> at(D d, const Points<D>& p) const { return add(turn(d, p), shift); }
};

/// lib/frame.h: take_along().
template <class D>
struct FramedSteps {
  Points<D> start, way;
};
template <class D>
HWY_INLINE FramedSteps<D> take_along(D d, const shader::ClothParams& params, float substep, const Points<D>& position,
                                     const Points<D>& way) {
  const Field<D> whole(d, params.whole, substep), along(d, params.taken, substep);
  const Points<D> taken = along.at(d, position);
  const Points<D> left = sub(whole.at(d, position), taken);
  const Points<D> turned = add(way, along.turn(d, way));
  const Points<D> start = add(position, taken);
  const Points<D> lost = sub(taken, sub(start, position));
  return {start, add(add(left, scale(d, sub(turned, left), hn::Set(d, params.keep))), lost)};
}

/// lib/predict.h: stray_at(), in each direction.
template <class D>
HWY_INLINE Points<D> stray_at(D d, const shader::ClothParams& params, const Points<D>& position) {
  const shader::vec4 &wave = params.stray_wave, &step = params.stray_step;
  const auto turns = hn::Add(dot(d, set(d, wave.x, wave.y, wave.z), position), hn::Set(d, wave.w));
  const auto off = hn::Sub(turns, hn::Floor(hn::Add(turns, hn::Set(d, 0.5F))));
  return scale(d, set(d, step.x, step.y, step.z), hn::Sub(hn::Abs(off), hn::Set(d, 0.25F)));
}

/// lib/predict.h where nothing is pinned and only gravity acts: each coordinate by itself, so that few addresses and
/// vectors are in use at a time.
/// @param gravity  none of it -0: then what the shared text adds for the air, 0, changes nothing
template <class D>
HWY_INLINE void fall(D d, float* positions, float* previous, float* carry, size_t i, Vec<D> keep, Vec<D> gravity) {
  const auto start = hn::LoadU(d, positions + i);
  const auto way = hn::Add(hn::Sub(start, hn::LoadU(d, previous + i)), hn::LoadU(d, carry + i));
  const auto increment = hn::Add(hn::Mul(way, keep), gravity);
  const auto next = hn::Add(start, increment);
  const size_t k = anew(i);
  hn::StoreU(start, d, previous + k);
  hn::StoreU(next, d, positions + k);
  hn::StoreU(hn::Sub(increment, hn::Sub(next, start)), d, carry + k);
}

/// lib/predict.h. What is pinned stays.
/// @param kForces     air acts, or the cloth's parent moves
/// @param kOnOffsets  the way goes into the offset and nothing into the position, see lib/fine.h
template <bool kForces, bool kOnOffsets, class D>
HWY_NOINLINE void predict(D d, const PassContext& context, ClothState& state, std::span<const Run> runs) {
  const shader::ClothParams& params = context.cloth.params;
  const Points<D> gravity =
      add(set(d, params.gravity_step.x, params.gravity_step.y, params.gravity_step.z), set(d, 0, 0, 0));
  const bool strays = params.stray_step.w != 0;
  const auto keep = hn::Set(d, params.keep), dt2 = hn::Set(d, params.dt * params.dt);
  const PointRow positions = at(state.position, 0), before = at(state.previous, 0), carried = at(state.carry, 0);
  const float* const inverse_mass = state.inverse_mass.data();
  for_vectors(d, runs, [&](uint32_t i) GEOCLOTH_LANES {
    const auto free = free_lanes(d, inverse_mass + i);
    if (!kForces && !kOnOffsets && hn::AllTrue(d, free)) {
      Points<D> falls = gravity;
      if (strays) falls = add(gravity, stray_at(d, params, load(d, after(positions, i))));
      fall(d, positions.x, before.x, carried.x, i, keep, falls.x);
      fall(d, positions.y, before.y, carried.y, i, keep, falls.y);
      return fall(d, positions.z, before.z, carried.z, i, keep, falls.z);
    }
    const size_t k = anew(i);
    const PointRow p = after(positions, k), pp = after(before, k), pc = after(carried, k);
    const Points<D> position = load(d, p), previous = load(d, pp), carry = load(d, pc);
    const Points<D> way = add(sub(position, previous), carry);
    const auto zero = hn::Zero(d);
    Points<D> acceleration{zero, zero, zero};
    FramedSteps<D> step{position, scale(d, way, keep)};
    if constexpr (kForces) {
      if (params.air != 0) {
        acceleration = air_acceleration(d, params, context.frame.substeps[context.substep], position,
                                        scale(d, way, hn::Set(d, params.inverse_dt)), load(d, at(state.normal, i)));
        if (params.pressure.x != 0) {
          const auto w = hn::LoadU(d, state.normal_length.data() + i);
          const auto area_of_mass =
              hn::IfThenElse(hn::Lt(w, hn::Zero(d)), hn::Neg(w), hn::Mul(w, hn::LoadU(d, inverse_mass + i)));
          const auto push =
              hn::Mul(hn::Set(d, params.pressure.x), hn::Min(area_of_mass, hn::Set(d, params.pressure.y)));
          acceleration = add(acceleration, scale(d, load(d, at(state.normal, i)), push));
        }
      }
      if (params.moving != 0) step = take_along(d, params, static_cast<float>(context.substep), position, way);
    }
    Points<D> falls = gravity;
    if (strays) falls = add(gravity, stray_at(d, params, position));
    const Points<D> increment = add(add(step.way, falls), scale(d, acceleration, dt2));
    const Points<D> next = add(step.start, increment);
    const Points<D> lost = sub(increment, sub(next, step.start));
    store(d, choose<D>(free, step.start, position), pp);
    if constexpr (kOnOffsets) {
      const PointRow po = at(state.offset, k);
      const Points<D> low = load(d, po);
      const Points<D> ahead = add(low, add(sub(next, step.start), lost));
      store(d, choose<D>(free, ahead, low), po);
      return store(d, low, pc);
    }
    store(d, choose<D>(free, next, position), p);
    store(d, choose<D>(free, lost, carry), pc);
  });
}

/// lib/fine.h: settle().
template <class D>
HWY_NOINLINE void settle(D d, ClothState& state, std::span<const Run> runs) {
  const PointRow positions = at(state.position, 0), before = at(state.previous, 0), carried = at(state.carry, 0);
  const PointRow offsets = at(state.offset, 0);
  for_vectors(d, runs, [&](uint32_t i) GEOCLOTH_LANES {
    const size_t k = anew(i);
    const PointRow po = after(offsets, k), pp = after(before, k), pc = after(carried, k);
    const Points<D> base = load(d, pp), offset = load(d, po), low = load(d, pc);
    const Points<D> position = add(base, offset), way = sub(offset, low);
    const Points<D> previous = sub(position, way);
    store(d, position, after(positions, k));
    store(d, previous, pp);
    store(d, sub(way, sub(position, previous)), pc);
    store(d, sub(offset, sub(position, base)), po);
  });
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
