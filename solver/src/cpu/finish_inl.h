// SPDX-License-Identifier: Apache-2.0
// How a frame ends, in vectors; see lib/finish.h. Ties are springs that only pull, in constraints_inl.h.
#if defined(GEOCLOTH_CPU_FINISH_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_FINISH_INL_H
#undef GEOCLOTH_CPU_FINISH_INL_H
#else
#define GEOCLOTH_CPU_FINISH_INL_H
#endif

#include "cpu/collide_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

template <class D>
HWY_NOINLINE void hold_way(D d, ClothState& state, const Run& run) {
  const PointRow positions = at(state.position, 0), before = at(state.previous, 0), carried = at(state.carry, 0);
  const float* const inverse_mass = state.inverse_mass.data();
  // The last vector of a run gives back what follows the run as it was, as in predict().
  for_run(d, run, [&](uint32_t i, auto lanes) GEOCLOTH_LANES {
    const PointRow pp = after(before, i), pc = after(carried, i);
    const Points<D> position = load(d, after(positions, i)), previous = load(d, pp), carry = load(d, pc);
    const auto free = counted(d, lanes, hn::Gt(hn::LoadU(d, inverse_mass + i), hn::Zero(d)));
    store(d, choose<D>(free, add(sub(position, previous), carry), previous), pp);
    store(d, choose<D>(free, position, carry), pc);
  });
}

/// kept_out() of lib/finish.h for simple shapes.
/// @return false, with nothing done, when a point has moved so far that it has to be swept
template <class D>
HWY_INLINE bool keep_out(D d, const PassContext& context, Mask<D> lanes, const Points<D>& start, Points<D>& moved) {
  const FrameInput& frame = context.frame;
  const size_t count = frame.shapes.size();
  const shader::ColliderPose* poses = frame.poses.data() + (context.substep + 1) * count;
  const auto thickness = hn::Set(d, context.cloth.params.thickness), slack = hn::Set(d, shader::kContactSlack);
  Points<D> position = moved;
  Mask<D> again = lanes;
  for (uint32_t round = 0; round < shader::kContactRounds && !hn::AllFalse(d, again); ++round) {
    Mask<D> touched = hn::Gt(hn::Zero(d), hn::Zero(d));
    for (size_t i = 0; i < count; ++i) {
      const shader::ColliderShape& shape = frame.shapes[i];
      const Points<D> local = to_local(d, poses[i], position);
      const Nearest<D> near = nearest_of_shape(d, shape, local);
      const auto gap = hn::Sub(near.distance, thickness), depth = hn::Neg(gap);
      const auto way = length(d, sub(local, to_local(d, poses[i], start)));
      const auto met = hn::AndNot(hn::Gt(gap, way), again);
      if (round == 0 && !hn::AllFalse(d, hn::And(met, hn::Gt(way, hn::Set(d, 0.5F * shape.core))))) return false;
      const auto touches = hn::And(met, hn::Gt(depth, slack));
      if (hn::AllFalse(d, touches)) continue;
      const Points<D> out = add(position, scale(d, rotate_to_world(d, poses[i], near.normal), depth));
      position = choose<D>(touches, out, position);
      if (count > 1) touched = hn::Or(touched, touches);
    }
    again = touched;
  }
  moved = position;
  return true;
}

template <class D>
HWY_NOINLINE void give_way(D d, const SweepFrame& frame, uint32_t substep, const Run& run) {
  ClothState& state = *frame.state;
  const PassContext& context = frame.contexts[substep];
  const Guards guards(frame, substep);
  const float* const inverse_mass = state.inverse_mass.data();
  for_run(d, run, [&](uint32_t i, auto lanes) GEOCLOTH_LANES {
    const PointRow p = at(state.position, i), pp = at(state.previous, i), pc = at(state.carry, i);
    const Points<D> moved = load(d, p), way = load(d, pp), start = load(d, pc);
    const auto free = counted(d, lanes, hn::Gt(hn::LoadU(d, inverse_mass + i), hn::Zero(d)));
    const Points<D> tied = sub(moved, start);
    const auto at_most = hn::Add(hn::Add(hn::Abs(tied.x), hn::Abs(tied.y)), hn::Abs(tied.z));
    const auto near = hn::And(free, guards.near(d, moved, at_most));
    Points<D> position = moved;
    if (!hn::AllFalse(d, near) && (!frame.simple_colliders || !keep_out(d, context, near, start, position))) {
      return give_way_pixels(context, state, i, std::min(run.last, i + static_cast<uint32_t>(hn::Lanes(d))));
    }
    const Points<D> previous = sub(position, way);
    store(d, choose<D>(free, position, moved), p);
    store(d, choose<D>(free, previous, way), pp);
    store(d, choose<D>(free, sub(way, sub(position, previous)), start), pc);
  });
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
