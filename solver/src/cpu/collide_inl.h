// SPDX-License-Identifier: Apache-2.0
// Collisions in vectors: points that no collider can reach are passed over, simple shapes are done lane by lane, and
// all others pixel by pixel by the shared text; see lib/collide.h.
#if defined(GEOCLOTH_CPU_COLLIDE_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_COLLIDE_INL_H
#undef GEOCLOTH_CPU_COLLIDE_INL_H
#else
#define GEOCLOTH_CPU_COLLIDE_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "cpu/collider_set.h"
#include "cpu/lanes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

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

  const Points<D> position = sub(add(point.position, scale(d, n, depth)), scale(d, sliding, held));
  const Points<D> kept = add(add(carried, scale(d, sliding, hn::Sub(one, held))),
                             scale(d, n, hn::IfThenElse(hn::Lt(along, zero), zero, along)));
  const Points<D> previous = sub(position, kept);
  return {position, previous, sub(kept, sub(position, previous))};
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

/// The colliders of a substep, from which most points are too far.
struct Guards {
  const ColliderGuard* guards;
  size_t count;

  Guards(const SweepFrame& frame, uint32_t substep)
      : guards(frame.guards + substep * frame.contexts[substep].frame.shapes.size()),
        count(frame.contexts[substep].frame.shapes.size()) {}
  /// Points that a collider may touch when they went no farther than that way.
  template <class D>
  HWY_INLINE Mask<D> near(D d, const Points<D>& position, Vec<D> way) const {
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
};

/// From pixel i on, where a collider may be near. By itself, so that passing over the others keeps its registers.
template <class D, class Lanes>
HWY_NOINLINE void collide_near(D d, const SweepFrame& frame, uint32_t substep, const Run& run, uint32_t i, Lanes lanes,
                               Mask<D> near) {
  const PassContext& context = frame.contexts[substep];
  ClothState& state = *frame.state;
  const PointRow p = at(state.position, i), pp = at(state.previous, i), pc = at(state.carry, i);
  PointStates<D> points{load(d, p), load(d, pp), load(d, pc)};
  const auto free = hn::Gt(hn::LoadU(d, &state.inverse_mass[i]), hn::Zero(d));
  if (!frame.simple_colliders || !collide_lanes(d, context, hn::And(free, counted(d, lanes, near)), points)) {
    return collide_pixels(context, state, i, std::min(run.last, i + static_cast<uint32_t>(hn::Lanes(d))));
  }
  store(d, points.position, p);
  store(d, points.previous, pp);
  store(d, points.carry, pc);
}

/// Where no collider can reach, collide.h leaves a point as it is.
template <class D>
HWY_NOINLINE void collide(D d, const SweepFrame& frame, uint32_t substep, const Run& run) {
  ClothState& state = *frame.state;
  if (frame.collide_all) return collide_pixels(frame.contexts[substep], state, run.first, run.last);
  const Guards guards(frame, substep);
  const PointRow position = at(state.position, 0), previous = at(state.previous, 0);
  for_run(d, run, [&](uint32_t i, auto lanes) GEOCLOTH_LANES {
    const Points<D> p = load(d, after(position, i));
    const Points<D> moved = sub(p, load(d, after(previous, i)));
    const auto at_most = hn::Add(hn::Add(hn::Abs(moved.x), hn::Abs(moved.y)), hn::Abs(moved.z));  // needs no root
    const auto near = guards.near(d, p, at_most);
    if (hn::AllFalse(d, counted(d, lanes, near))) return;
    collide_near(d, frame, substep, run, i, lanes, near);
  });
}

template <class D>
HWY_NOINLINE void check_colliders(D d, const SweepFrame& frame, uint32_t substep, const Run& run) {
  const PassContext& context = frame.contexts[substep];
  ClothState& state = *frame.state;
  const Guards guards(frame, substep);
  float depth = frame.penetration[substep];
  for_run(d, run, [&](uint32_t i, auto lanes) GEOCLOTH_LANES {
    const Points<D> position = load(d, at(state.position, i));
    const auto near = guards.near(d, position, hn::Zero(d));
    if (hn::AllFalse(d, counted(d, lanes, near))) return;
    const uint32_t last = std::min(run.last, i + static_cast<uint32_t>(hn::Lanes(d)));
    depth = std::max(depth, penetration_of_pixels(context, state, i, last));
  });
  frame.penetration[substep] = depth;
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
