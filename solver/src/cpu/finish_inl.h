// SPDX-License-Identifier: Apache-2.0
// How a frame ends, in vectors; see lib/finish.h. Ties are springs that only pull, in constraints_inl.h.
#if defined(GEOCLOTH_CPU_FINISH_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_FINISH_INL_H
#undef GEOCLOTH_CPU_FINISH_INL_H
#else
#define GEOCLOTH_CPU_FINISH_INL_H
#endif

#include "cpu/collide_inl.h"
#include "lib/finish.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

template <class D>
HWY_NOINLINE void hold_way(D d, ClothState& state, std::span<const Run> runs) {
  const PointRow positions = at(state.position, 0), before = at(state.previous, 0), carried = at(state.carry, 0);
  const float* const inverse_mass = state.inverse_mass.data();
  for_vectors(d, runs, [&](uint32_t i) GEOCLOTH_LANES {
    const PointRow pp = after(before, i), pc = after(carried, i);
    const Points<D> position = load(d, after(positions, i)), previous = load(d, pp), carry = load(d, pc);
    const auto free = free_lanes(d, inverse_mass + i);
    store(d, choose<D>(free, add(sub(position, previous), carry), previous), pp);
    store(d, choose<D>(free, position, carry), pc);
  });
}

/// kept_out() of lib/finish.h.
template <class D>
HWY_INLINE void keep_out(D d, const Meeting& meeting, Mask<D> lanes, const Points<D>& start, Points<D>& moved) {
  const size_t count = meeting.met.shapes.size();
  const auto thickness = hn::Set(d, meeting.params.thickness), slack = hn::Set(d, shader::kContactSlack);
  const Points<D> none = set(d, 0, 0, 0);
  Points<D> position = moved, last = none;
  Mask<D> again = lanes;
  for (uint32_t round = 0; round < shader::kContactRounds && !hn::AllFalse(d, again); ++round) {
    const auto deep = hn::Set(d, shader::worth_a_round(meeting.params, round));
    Mask<D> touched = hn::Gt(hn::Zero(d), hn::Zero(d));
    for (size_t i = 0; i < count; ++i) {
      const auto way = length(d, sub(position, start));
      const auto near_guard = Guards::near(d, meeting.guards.guards[i], position, hn::Add(way, way));
      if (hn::AllFalse(d, hn::And(again, near_guard))) continue;
      const shader::ColliderShape& shape = meeting.met.shapes[i];
      const Posed pose = meeting.ended(i);
      const Points<D> local = to_local(d, pose, position);
      const Nearest<D> near = nearest_of_shape(d, meeting.numbers, shape, local);
      const auto gap = hn::Sub(near.distance, thickness);
      const Contacts<D> contact =
          find_contacts(d, meeting, shape, again, to_local(d, pose, start), local, near, gap, thickness, round == 0);
      const auto touches = hn::And(contact.touches, hn::Gt(contact.depth, slack));
      if (hn::AllFalse(d, touches)) continue;
      const Points<D> n = rotate_to_world(d, pose.pose, contact.normal);
      position = choose<D>(
          touches, add(position, way_out(d, n, contact.depth, thickness, shader::slides_out(round) ? last : none)),
          position);
      last = choose<D>(touches, n, last);
      if (count > 1 || shape.kind == shader::kShapeMesh)
        touched = hn::Or(touched, hn::And(touches, hn::Gt(contact.depth, deep)));
    }
    again = touched;
  }
  moved = choose<D>(again, start, position);
}

/// What stays where it was, of held_back() of lib/finish.h.
template <class D>
HWY_INLINE Mask<D> left_near(D d, const Meeting& meeting, const Points<D>& start, const Points<D>& moved) {
  const size_t count = meeting.met.shapes.size();
  const auto leave = hn::Set(d, meeting.params.leave_near);
  const auto reach = hn::Set(d, meeting.params.thickness + meeting.params.leave_near);
  Mask<D> left = hn::Gt(hn::Zero(d), hn::Zero(d));
  for (size_t i = 0; i < count; ++i) {
    const shader::ColliderShape& shape = meeting.met.shapes[i];
    if (!shader::is_thin(meeting.params, shape)) continue;
    for (const Points<D>* point : {&start, &moved}) {
      if (hn::AllFalse(d, Guards::near(d, meeting.guards.guards[i], *point, leave))) continue;
      const Points<D> local = to_local(d, meeting.ended(i), *point);
      left = hn::Or(left, hn::Lt(distance_to_shape(d, meeting.numbers, shape, local), reach));
    }
  }
  return left;
}

/// What friction holds, of held_back() of lib/finish.h.
template <class D>
HWY_INLINE Vec<D> held_by_friction(D d, const Meeting& meeting, const Points<D>& start, const Points<D>& way) {
  const size_t count = meeting.met.shapes.size();
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.F);
  const auto reach = hn::Set(d, meeting.params.thickness + shader::kGripped * meeting.params.spacing);
  const auto per_gap = hn::Set(d, 1.F / (shader::kGripped * meeting.params.spacing));
  const auto per_slide = hn::Set(d, 1.F / (shader::kSlides * meeting.params.spacing));
  auto friction = zero;
  for (size_t i = 0; i < count; ++i) {
    const shader::ColliderShape& shape = meeting.met.shapes[i];
    const auto own = hn::Set(d, std::sqrt(meeting.params.friction * shape.friction));
    const auto more = hn::Gt(own, friction);
    if (hn::AllFalse(d, hn::And(more, Guards::near(d, meeting.guards.guards[i], start, zero)))) continue;
    const Posed after = meeting.ended(i);
    const Points<D> local = to_local(d, after, start);
    const auto lies = hn::Mul(per_gap, hn::Sub(reach, distance_to_shape(d, meeting.numbers, shape, local)));
    const auto touches = hn::And(more, hn::Gt(lies, zero));
    if (hn::AllFalse(d, touches)) continue;
    const Points<D> carried = carried_by(d, meeting.begun(i), after, local);
    const auto rests = hn::Sub(one, hn::Mul(per_slide, length(d, sub(way, carried))));
    const auto holds = hn::Mul(own, hn::Mul(max_of(d, rests, zero), hn::Min(lies, one)));
    friction = hn::IfThenElse(touches, max_of(d, friction, holds), friction);
  }
  return friction;
}

/// How deep in colliders that have friction points are that it holds, of held_back() of lib/finish.h.
template <class D>
HWY_INLINE Vec<D> depth_of(D d, const Meeting& meeting, Mask<D> held, const Points<D>& moved) {
  const size_t count = meeting.met.shapes.size();
  const auto thickness = hn::Set(d, meeting.params.thickness), zero = hn::Zero(d);
  const auto grip = hn::Set(d, meeting.params.grip);
  auto depth = zero;
  for (size_t i = 0; i < count; ++i) {
    const shader::ColliderShape& shape = meeting.met.shapes[i];
    if (!(std::sqrt(meeting.params.friction * shape.friction) > 0)) continue;
    if (hn::AllFalse(d, hn::And(held, Guards::near(d, meeting.guards.guards[i], moved, zero)))) continue;
    const Points<D> local = to_local(d, meeting.ended(i), moved);
    const auto into = hn::Sub(thickness, distance_to_shape(d, meeting.numbers, shape, local));
    depth = max_of(d, depth, hn::Min(into, grip));
  }
  return depth;
}

/// braked() of lib/finish.h.
template <class D>
HWY_INLINE Points<D> braked(D d, const Meeting& meeting, const Points<D>& start, const Points<D>& moved,
                            Vec<D> friction) {
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.F), two = hn::Set(d, 2.F);
  const auto held = hn::Gt(friction, zero);
  if (hn::AllFalse(d, held)) return moved;
  const auto brake = hn::Mul(friction, hn::Set(d, shader::kFrictionHolds * meeting.params.spacing));
  const auto depth = depth_of(d, meeting, held, moved);
  const Points<D> way = sub(moved, start);
  const auto went = length(d, way);
  const auto along = hn::Sqrt(max_of(d, hn::Sub(hn::Mul(went, went), hn::Mul(depth, depth)), zero));
  const auto pressed = hn::Mul(friction, depth);
  const auto of_rest = hn::Sub(two, hn::Mul(two, hn::Mul(brake, hn::Div(one, went))));
  const auto of_slide = hn::Sub(one, hn::Mul(pressed, hn::Div(one, along)));
  const auto kept = hn::Mul(hn::Min(of_rest, one), of_slide);
  const auto goes = hn::And(hn::Gt(went, brake), hn::Gt(along, pressed));
  return choose<D>(held, choose<D>(goes, add(start, scale(d, way, kept)), start), moved);
}

/// way_given() of lib/finish.h from pixel i on, where a collider may touch a point.
template <class D>
HWY_NOINLINE void give_way_near(D d, const Meeting& meeting, ClothState& state, uint32_t i) {
  const PointRow p = at(state.position, i), pp = at(state.previous, i), pc = at(state.carry, i);
  const Points<D> moved = load(d, p), way = load(d, pp), start = load(d, pc);
  const auto free = free_lanes(d, &state.inverse_mass[i]);
  Points<D> position = braked(d, meeting, start, moved, held_by_friction(d, meeting, start, way));
  auto near = hn::And(free, meeting.guards.near(d, position, at_most(d, sub(position, start))));
  if (meeting.params.leave_near > 0) {
    const auto left = left_near(d, meeting, start, position);
    position = choose<D>(left, start, position);
    near = hn::AndNot(left, near);
  }
  if (!hn::AllFalse(d, near)) keep_out(d, meeting, near, start, position);
  const Points<D> previous = sub(position, way);
  store(d, choose<D>(free, position, moved), p);
  store(d, choose<D>(free, previous, way), pp);
  store(d, choose<D>(free, sub(way, sub(position, previous)), start), pc);
}

/// One coordinate of points that move freely.
template <class D>
HWY_INLINE void arrive(D d, const float* positions, float* ways, float* starts, size_t i) {
  const auto position = hn::LoadU(d, positions + i), way = hn::LoadU(d, ways + i);
  const auto previous = hn::Sub(position, way);
  hn::StoreU(previous, d, ways + i);
  hn::StoreU(hn::Sub(way, hn::Sub(position, previous)), d, starts + i);
}

template <class D>
HWY_NOINLINE void give_way(D d, const SweepFrame& frame, uint32_t substep, std::span<const Run> runs) {
  ClothState& state = *frame.state;
  const Meeting meeting(frame, substep);
  const auto lanes = static_cast<uint32_t>(hn::Lanes(d));
  const PointRow positions = at(state.position, 0), ways = at(state.previous, 0), starts = at(state.carry, 0);
  const float* const inverse_mass = state.inverse_mass.data();
  const bool leaves = meeting.params.leave_near > 0;
  for (const Run& run : runs) {
    for (uint32_t first = run.first; first < run.last; first += kWordVectors * lanes) {
      const uint32_t count = std::min(kWordVectors, (run.last - first) / lanes);
      const uint64_t near =
          leaves ? ~uint64_t{0} : near_vectors(d, meeting.guards, after(positions, first), after(starts, first), count);
      for (uint32_t k = 0; k < count; ++k) {
        const size_t i = anew(first + k * lanes);
        if ((near >> k & 1) != 0) {
          give_way_near(d, meeting, state, static_cast<uint32_t>(i));
          continue;
        }
        const auto free = free_lanes(d, inverse_mass + i);
        if (hn::AllTrue(d, free)) {
          arrive(d, positions.x, ways.x, starts.x, i);
          arrive(d, positions.y, ways.y, starts.y, i);
          arrive(d, positions.z, ways.z, starts.z, i);
          continue;
        }
        const PointRow pp = after(ways, i), pc = after(starts, i);
        const Points<D> position = load(d, after(positions, i)), way = load(d, pp), start = load(d, pc);
        const Points<D> previous = sub(position, way);
        store(d, choose<D>(free, previous, way), pp);
        store(d, choose<D>(free, sub(way, sub(position, previous)), start), pc);
      }
    }
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
