// SPDX-License-Identifier: Apache-2.0
// Collisions in vectors, lane by lane the operations of lib/collide.h. Points that no collider can reach are passed
// over, and so is every collider that can reach none of a vector's points.
#if defined(GEOCLOTH_CPU_COLLIDE_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_COLLIDE_INL_H
#undef GEOCLOTH_CPU_COLLIDE_INL_H
#else
#define GEOCLOTH_CPU_COLLIDE_INL_H
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <type_traits>

#include "cpu/collider_set.h"
#include "cpu/lanes_inl.h"
#include "cpu/shapes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// The points of collide.h, lane by lane.
template <class D>
struct PointStates {
  Points<D> position, previous, carry;
};
template <class D>
HWY_INLINE PointStates<D> choose(Mask<D> mask, const PointStates<D>& yes, const PointStates<D>& no) {
  return {choose<D>(mask, yes.position, no.position), choose<D>(mask, yes.previous, no.previous),
          choose<D>(mask, yes.carry, no.carry)};
}

/// A contact for each lane; see find_contact().
template <class D>
struct Contacts {
  Mask<D> touches;
  Points<D> normal;
  Vec<D> depth;
};

/// A collider in one of its poses.
/// @tparam kMayDeform  else it is known not to
template <bool kMayDeform>
struct PosedAs {
  const float* numbers;
  const shader::ColliderShape& shape;
  const shader::ColliderPose& pose;

  [[nodiscard]] bool deforms() const { return kMayDeform && pose.deform.x > 0; }
};
using Posed = PosedAs<true>;

/// lib/collide.h: between the world and a collider's frame.
template <class D>
HWY_NOINLINE Points<D> deformed(D d, const Posed& at, const Points<D>& q) {
  const auto left = hn::Set(d, at.pose.deform.x);
  Points<D> x = q;
  for (uint32_t i = 0; i < shader::kDeformSteps; ++i) {
    x = shifted(d, q, deforming_way(d, at.numbers, at.shape, x), left);
  }
  return x;
}
template <class D, bool kMayDeform>
HWY_INLINE Points<D> to_local(D d, const PosedAs<kMayDeform>& at, const Points<D>& p) {
  const shader::ColliderPose& pose = at.pose;
  const Points<D> from = sub(p, set(d, pose.row0.w, pose.row1.w, pose.row2.w));
  const Points<D> local = add(add(scale(d, set(d, pose.row0.x, pose.row0.y, pose.row0.z), from.x),
                                  scale(d, set(d, pose.row1.x, pose.row1.y, pose.row1.z), from.y)),
                              scale(d, set(d, pose.row2.x, pose.row2.y, pose.row2.z), from.z));
  if constexpr (kMayDeform) {
    if (at.deforms()) return deformed(d, at, local);
  }
  return local;
}
template <class D>
HWY_INLINE Points<D> rotate_to_world(D d, const shader::ColliderPose& pose, const Points<D>& v) {
  return {dot(d, set(d, pose.row0.x, pose.row0.y, pose.row0.z), v),
          dot(d, set(d, pose.row1.x, pose.row1.y, pose.row1.z), v),
          dot(d, set(d, pose.row2.x, pose.row2.y, pose.row2.z), v)};
}
template <class D>
HWY_INLINE Points<D> rigid_to_world(D d, const shader::ColliderPose& pose, const Points<D>& p) {
  return add(rotate_to_world(d, pose, p), set(d, pose.row0.w, pose.row1.w, pose.row2.w));
}
template <class D>
HWY_NOINLINE Points<D> carried_by_deforming(D d, const Posed& before, const Posed& after, const Points<D>& p) {
  const Points<D> way = deforming_way(d, before.numbers, before.shape, p);
  const auto place = [&](const shader::ColliderPose& pose) GEOCLOTH_LANES {
    return rigid_to_world(d, pose, shifted(d, p, way, hn::Set(d, -pose.deform.x)));
  };
  return sub(place(after.pose), place(before.pose));
}
/// lib/collide.h: carried_by().
template <class D, bool kMayDeform>
HWY_INLINE Points<D> carried_by(D d, const PosedAs<kMayDeform>& before, const PosedAs<kMayDeform>& after,
                                const Points<D>& p) {
  if constexpr (kMayDeform) {
    if (before.deforms()) return carried_by_deforming(d, before, after, p);
  }
  return sub(rigid_to_world(d, after.pose, p), rigid_to_world(d, before.pose, p));
}

/// way_out() of lib/collide.h.
template <class D>
HWY_INLINE Points<D> way_out(D d, const Points<D>& normal, Vec<D> depth, Vec<D> thickness, const Points<D>& last) {
  const auto one = hn::Set(d, 1.F);
  const auto c = hn::Min(dot(d, normal, last), hn::Zero(d));
  const auto open = hn::Sub(one, hn::Mul(c, c));
  const Points<D> slid = scale(d, sub(normal, scale(d, last, c)), hn::Mul(depth, hn::Div(one, open)));
  return choose<D>(hn::Or(hn::Lt(open, hn::Set(d, shader::kNarrowest)), hn::Lt(depth, thickness)),
                   scale(d, normal, depth), slid);
}

/// What contact sums want of a vector's points, in memory: of the first one and those beside it.
struct PointMasses {
  const float* inverse_mass;  ///< [1/kg]
  const float* yield;
};

/// Where contacts with a collider are summed.
struct ContactSums {
  ContactSum* sum;  ///< null: they are not
  const shader::ClothParams& params;
  const PointMasses& of;
};

/// add_contact() of collider_set.h for some points.
/// @param way  by which the contact has changed what they go
/// @param n    its normals
template <class D>
HWY_NOINLINE void add_contacts(D d, const ContactSums& to, Mask<D> lanes, const Points<D>& way, const Points<D>& n,
                               const Points<D>& position) {
  std::array<std::array<float, hn::MaxLanes(D())>, 9> v;
  store(d, way, PointRow{v[0].data(), v[1].data(), v[2].data()});
  store(d, n, PointRow{v[3].data(), v[4].data(), v[5].data()});
  store(d, position, PointRow{v[6].data(), v[7].data(), v[8].data()});
  const shader::vec3 gravity_step = shader::xyz(to.params.gravity_step);
  ContactSum added{};
  for_lanes(d, lanes, [&](size_t k) {
    if (to.of.inverse_mass[k] <= 0) return;
    const shader::vec3 borne =
        shader::borne_way({v[0][k], v[1][k], v[2][k]}, {v[3][k], v[4][k], v[5][k]}, gravity_step, to.of.yield[k]);
    shader::add_share(added, shader::contact_share(to.of.inverse_mass[k], borne, {v[6][k], v[7][k], v[8][k]},
                                                   to.params.contact_scale));
  });
  shader::add_sum(*to.sum, added);
}

/// braked_way() of lib/collide.h.
template <class D>
HWY_INLINE Points<D> braked_way(D d, const Points<D>& way, const Points<D>& n, Vec<D> brake) {
  const auto one = hn::Set(d, 1.F);
  const Points<D> sliding = sub(way, scale(d, n, dot(d, way, n)));
  const auto slid = length(d, sliding);
  return scale(d, sliding, hn::IfThenElse(hn::Gt(slid, brake), hn::Mul(brake, hn::Div(one, slid)), one));
}

/// respond() of lib/collide.h, for the lanes that touch.
template <class D, class At>
HWY_INLINE void respond(D d, PointStates<D>& point, const At& before, const At& after, const Points<D>& local,
                        const Contacts<D>& contact, const Points<D>& n, const Points<D>& out_of_it, Vec<D> friction,
                        Vec<D> grip, bool layers, const ContactSums& sums) {
  const auto one = hn::Set(d, 1.F), zero = hn::Zero(d);
  const Points<D> on_surface = add(local, scale(d, contact.normal, contact.depth));
  const Points<D> carried = carried_by(d, before, after, on_surface);
  const Points<D> displacement = add(sub(point.position, point.previous), point.carry);
  const Points<D> relative = sub(displacement, carried);
  const auto along = dot(d, relative, n);
  const Points<D> sliding = sub(relative, scale(d, n, along));
  const auto slid = length(d, sliding);
  const auto brake = hn::Mul(friction, hn::Min(contact.depth, grip));
  const auto held = hn::IfThenElse(hn::Gt(slid, brake), hn::Mul(brake, hn::Div(one, slid)), one);

  const Points<D> back =
      layers ? braked_way(d, sub(sub(point.position, point.previous), carried), n, brake) : scale(d, sliding, held);
  const Points<D> position = sub(add(point.position, out_of_it), back);
  const Points<D> kept = add(add(carried, scale(d, sliding, hn::Sub(one, held))),
                             scale(d, n, hn::IfThenElse(hn::Lt(along, zero), zero, along)));
  if (sums.sum != nullptr) add_contacts(d, sums, contact.touches, sub(kept, displacement), n, position);
  const Points<D> previous = sub(position, kept);
  replace(contact.touches, position, point.position);
  replace(contact.touches, previous, point.previous);
  replace(contact.touches, sub(kept, sub(position, previous)), point.carry);
}

/// Not the bits of the shared text: for guards, which have room for rounding.
template <class D>
HWY_INLINE Vec<D> fused_dot(D, const Points<D>& a, const Points<D>& b) {
  return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, hn::Mul(a.x, b.x)));
}

/// The colliders of a substep, from which most points are too far.
struct Guards {
  const ColliderGuard* guards;
  size_t count;

  Guards(const SweepFrame& frame, uint32_t substep)
      : guards(frame.guards + size_t{substep} * frame.contexts[substep].cloth.params.collider_count),
        count(frame.contexts[substep].cloth.params.collider_count) {}

  /// Points that are nearer to a guard than that.
  template <ColliderGuard::Kind kKind, class D>
  static HWY_INLINE Mask<D> reaches(D d, const ColliderGuard& guard, const Points<D>& place, const Points<D>& position,
                                    Vec<D> reach) {
    if constexpr (kKind == ColliderGuard::Kind::plane) return hn::Lt(fused_dot(d, position, place), reach);
    Points<D> from = sub(position, place);
    if constexpr (kKind == ColliderGuard::Kind::segment) {
      const Points<D> axis = set(d, guard.axis_x, guard.axis_y, guard.axis_z);
      const auto end = hn::Set(d, guard.half_length);
      from = sub(from, scale(d, axis, hn::Min(hn::Max(fused_dot(d, from, axis), hn::Neg(end)), end)));
    }
    return hn::Lt(fused_dot(d, from, from), hn::Mul(reach, reach));
  }
  /// Points that a collider may touch when they went no farther than half of that.
  template <class D>
  static HWY_INLINE Mask<D> near(D d, const ColliderGuard& guard, const Points<D>& position, Vec<D> twice) {
    using Kind = ColliderGuard::Kind;
    const Points<D> place = set(d, guard.x, guard.y, guard.z);
    const auto reach = hn::MulAdd(twice, hn::Set(d, guard.spread), hn::Set(d, guard.reach));
    switch (guard.kind) {
      case Kind::plane:
        return reaches<Kind::plane>(d, guard, place, position, reach);
      case Kind::segment:
        return reaches<Kind::segment>(d, guard, place, position, reach);
      default:
        return reaches<Kind::ball>(d, guard, place, position, reach);
    }
  }
  template <class D>
  HWY_INLINE Mask<D> near(D d, const Points<D>& position, Vec<D> way) const {
    const auto twice = hn::Add(way, way);
    Mask<D> any = hn::Gt(hn::Zero(d), hn::Zero(d));
    for (size_t c = 0; c < count; ++c) any = hn::Or(any, near(d, guards[c], position, twice));
    return any;
  }
};

/// The sweep of find_contact() of lib/collide.h.
template <class D>
HWY_NOINLINE Contacts<D> sweep_points(D d, const float* numbers, const shader::ColliderShape& shape, Mask<D> lanes,
                                      const Points<D>& p0, const Points<D>& p1, Vec<D> way, Vec<D> thickness) {
  const auto zero = hn::Zero(d);
  const Points<D> direction = scale(d, sub(p1, p0), hn::Div(hn::Set(d, 1.F), way));
  const auto close = hn::Set(d, shader::min(0.01F * shape.core, shader::kSweepClose));
  auto travelled = zero;
  Contacts<D> r{hn::Gt(zero, zero), set(d, 0, 1, 0), zero};
  for (uint32_t i = 0; i < shader::kSweepSteps && !hn::AllFalse(d, lanes); ++i) {
    const Points<D> q = add(p0, scale(d, direction, travelled));
    const Nearest<D> near = nearest_of_shape(d, numbers, shape, q);
    const auto gap = hn::Sub(near.distance, thickness);
    const auto there = hn::And(lanes, hn::Lt(gap, close));
    const auto height = hn::Add(dot(d, sub(p1, q), near.normal), gap);
    r.touches = hn::Or(r.touches, hn::And(there, hn::Lt(height, zero)));
    r.normal = choose<D>(there, near.normal, r.normal);
    r.depth = hn::IfThenElse(there, hn::Neg(height), r.depth);
    travelled = hn::Add(travelled, gap);
    lanes = hn::AndNot(hn::Or(there, hn::Ge(travelled, way)), lanes);
  }
  return r;
}

/// What all points of a substep meet.
struct Meeting {
  const PassContext& context;
  const FrameInput& frame;
  const shader::ClothParams& params;
  MetColliders met;
  const shader::ColliderPose* poses;  ///< before the substep
  const float* numbers;
  ContactSum* contacts;  ///< one for each collider; null: contacts are not summed
  Guards guards;

  Meeting(const SweepFrame& sweep, uint32_t substep)
      : context(sweep.contexts[substep]),
        frame(context.frame),
        params(context.cloth.params),
        met(frame, params),
        poses(met.poses.data() + substep * met.shapes.size()),
        numbers(frame.collider_numbers ? frame.collider_numbers->data() : nullptr),
        contacts(sweep.state->contacts.empty() ? nullptr : sweep.state->contacts.data()),
        guards(sweep, substep) {}

  /// @param masses  of the points that meet it
  [[nodiscard]] ContactSums sum_of(size_t collider, const PointMasses& masses) const {
    return {contacts == nullptr ? nullptr : contacts + collider, params, masses};
  }
  /// A collider as it is when the substep begins, and when it has ended.
  template <bool kMayDeform = true>
  [[nodiscard]] PosedAs<kMayDeform> begun(size_t collider) const {
    return {numbers, met.shapes[collider], poses[collider]};
  }
  template <bool kMayDeform = true>
  [[nodiscard]] PosedAs<kMayDeform> ended(size_t collider) const {
    return {numbers, met.shapes[collider], poses[met.shapes.size() + collider]};
  }
};

/// out_of_reach() of lib/collide.h: larger gaps than that are.
template <class D>
HWY_INLINE Vec<D> reach_of(D d, const shader::ColliderShape& shape, Vec<D> way) {
  return hn::Mul(hn::Set(d, 2.F), hn::Add(way, hn::Set(d, shape.way)));
}

/// find_contact() of lib/collide.h for points that may have met the collider.
/// @param first  where a swept way begins
/// @param gap    of the distance, less the thickness
template <class D>
HWY_INLINE Contacts<D> find_contacts(D d, const Meeting& meeting, const shader::ColliderShape& shape, Mask<D> lanes,
                                     const Points<D>& first, const Points<D>& local, const Nearest<D>& near, Vec<D> gap,
                                     Vec<D> thickness, bool swept) {
  Contacts<D> r{hn::And(lanes, hn::Lt(gap, hn::Zero(d))), {near.normal.x, near.normal.y, near.normal.z}, hn::Neg(gap)};
  if (!swept) return r;
  const auto way = length(d, sub(local, first));
  const auto met = hn::AndNot(hn::Gt(gap, way), lanes);
  const auto far = hn::And(met, hn::Gt(way, hn::Set(d, 0.5F * shape.core)));
  if (hn::AllFalse(d, far)) return r;
  Contacts<D> entry = sweep_points(d, meeting.numbers, shape, far, first, local, way, thickness);
  if (shader::is_edged(shape)) {
    const auto opposed = hn::Lt(dot(d, entry.normal, near.normal), hn::Set(d, shader::kOpposed));
    entry.touches = hn::And(entry.touches, opposed);
  }
  r.touches = hn::Or(r.touches, entry.touches);
  replace(entry.touches, entry.normal, r.normal);
  r.depth = hn::IfThenElse(entry.touches, entry.depth, r.depth);
  return r;
}

/// out_of_cleft() of lib/collide.h, lane by lane.
template <class D>
HWY_NOINLINE Points<D> out_of_cleft(D d, const Meeting& meeting, Mask<D> lanes, Points<D> start, Points<D> position) {
  using Coordinates = std::array<float, hn::MaxLanes(D())>;
  Coordinates x{}, y{}, z{}, start_x{}, start_y{}, start_z{};
  const PointRow row{x.data(), y.data(), z.data()};
  store(d, position, row);
  store(d, start, {start_x.data(), start_y.data(), start_z.data()});
  for_lanes(d, lanes, [&](size_t k) {
    const shader::vec3 out =
        cpu::out_of_cleft(meeting.context, {start_x[k], start_y[k], start_z[k]}, {x[k], y[k], z[k]});
    x[k] = out.x;
    y[k] = out.y;
    z[k] = out.z;
  });
  return load(d, row);
}

constexpr float kRoomForRounding = 1.00001F;

/// Yields of one, where those of the points do not count.
alignas(64) inline constexpr std::array<float, 16> kFullYields{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

HWY_INLINE PointMasses masses_of(const Meeting& meeting, const ClothState& state, uint32_t i) {
  return {&state.inverse_mass[i], shader::yield_counts(meeting.params) ? &state.yield[i] : kFullYields.data()};
}

/// push_out() of lib/collide.h.
template <bool kMayDeform, class D>
HWY_INLINE void push_out(D d, const Meeting& meeting, Mask<D> lanes, const PointMasses& masses,
                         PointStates<D>& points) {
  const size_t count = meeting.met.shapes.size();
  const auto thickness = hn::Set(d, meeting.params.thickness), room = hn::Set(d, kRoomForRounding);
  const Points<D> start{points.previous.x, points.previous.y, points.previous.z};
  const Points<D> none = set(d, 0, 0, 0);
  const bool layers = meeting.params.self_points + meeting.params.inter_points > 0;
  Points<D> last = set(d, 0, 0, 0);
  Mask<D> again = lanes;
  for (uint32_t round = 0; round < shader::kContactRounds && !hn::AllFalse(d, again); ++round) {
    const auto deep = hn::Set(d, shader::worth_a_round(meeting.params, round));
    Mask<D> touched = hn::Gt(hn::Zero(d), hn::Zero(d));
    auto way = length(d, sub(points.position, start));
    for (size_t i = 0; i < count; ++i) {
      const auto near_guard = Guards::near(d, meeting.guards.guards[i], points.position, hn::Add(way, way));
      if (hn::AllFalse(d, hn::And(again, near_guard))) continue;
      const shader::ColliderShape& shape = meeting.met.shapes[i];
      const auto before = meeting.begun<kMayDeform>(i), after = meeting.ended<kMayDeform>(i);
      const Points<D> local = to_local(d, after, points.position);
      const bool swept = round == 0 && !before.deforms();
      auto reach = hn::Zero(d);
      if (swept) reach = reach_of(d, shape, way);
      const auto beyond = hn::Mul(hn::Add(thickness, reach), room);
      const Nearest<D> near = nearest_of_shape(d, meeting.numbers, shape, local, beyond);
      const auto gap = hn::Sub(near.distance, thickness);
      const auto in_reach = hn::AndNot(hn::Gt(gap, reach), again);
      if (hn::AllFalse(d, in_reach)) continue;
      Points<D> first{local.x, local.y, local.z};
      if (swept) assign(first, to_local(d, before, start));
      Contacts<D> contact = find_contacts(d, meeting, shape, in_reach, first, local, near, gap, thickness, swept);
      if (round > 0)
        contact.touches = hn::And(contact.touches, hn::Gt(contact.depth, hn::Set(d, shader::kContactSlack)));
      if (hn::AllFalse(d, contact.touches)) continue;
      const float friction = round == 0 ? std::sqrt(meeting.params.friction * shape.friction) : 0.F;
      const Points<D> n = rotate_to_world(d, after.pose, contact.normal);
      const Points<D> out_of_it = way_out(d, n, contact.depth, thickness, shader::slides_out(round) ? last : none);
      respond(d, points, before, after, local, contact, n, out_of_it, hn::Set(d, friction),
              hn::Set(d, shader::largest_grip(meeting.params, shape)), layers, meeting.sum_of(i, masses));
      replace(contact.touches, n, last);
      way = length(d, sub(points.position, start));
      if (count > 1 || shape.kind == shader::kShapeMesh)
        touched = hn::Or(touched, hn::And(contact.touches, hn::Gt(contact.depth, deep)));
    }
    again = touched;
  }
  if (hn::AllFalse(d, again)) return;
  const Points<D> way = add(sub(points.position, points.previous), points.carry);
  const Points<D> position = out_of_cleft(d, meeting, again, {start.x, start.y, start.z},
                                          {points.position.x, points.position.y, points.position.z});
  const Points<D> previous = sub(position, way);
  replace(again, position, points.position);
  replace(again, previous, points.previous);
  replace(again, sub(way, sub(position, previous)), points.carry);
}

/// limit_speed() of lib/collide.h.
template <class D>
HWY_INLINE PointStates<D> limit_speed(D d, const PointStates<D>& point, float max_step) {
  const Points<D> displacement = add(sub(point.position, point.previous), point.carry);
  const auto way = length(d, displacement), most = hn::Set(d, max_step);
  const auto share = hn::Mul(most, hn::Div(hn::Set(d, 1.F), way));
  const PointStates<D> slow{add(point.previous, scale(d, displacement, share)), point.previous, set(d, 0, 0, 0)};
  return choose<D>(hn::Gt(way, most), slow, point);
}

/// field_back() of lib/frame.h.
template <class D>
HWY_INLINE Points<D> field_back(D d, const shader::FrameField& field, float substep, const Points<D>& p) {
  const Points<D> q = sub(p, set(d, field.row0.w + field.drift.x * substep, field.row1.w + field.drift.y * substep,
                                 field.row2.w + field.drift.z * substep));
  const Points<D> turn = add(add(scale(d, set(d, field.row0.x, field.row0.y, field.row0.z), q.x),
                                 scale(d, set(d, field.row1.x, field.row1.y, field.row1.z), q.y)),
                             scale(d, set(d, field.row2.x, field.row2.y, field.row2.z), q.z));
  return add(q, turn);
}

template <class D>
HWY_INLINE Vec<D> at_most(D, const Points<D>& way) {  // its length; needs no root
  return hn::Add(hn::Add(hn::Abs(way.x), hn::Abs(way.y)), hn::Abs(way.z));
}

/// collide() of lib/collide.h where points change without being touched: taken along by a parent.
template <bool kMayDeform, class D>
HWY_INLINE void collide_changed(D d, const Meeting& meeting, uint32_t substep, Mask<D> lanes, const PointMasses& masses,
                                PointStates<D>& points) {
  const shader::ClothParams& params = meeting.params;
  const Points<D> slow_previous = points.previous;
  if (params.moving != 0) {
    points.previous = field_back(d, params.taken, static_cast<float>(substep), points.previous);
  }
  const Points<D> taken = sub(slow_previous, points.previous);
  const auto way = at_most(d, sub(points.position, points.previous));
  const auto near = hn::And(lanes, meeting.guards.near(d, points.position, way));
  if (!hn::AllFalse(d, near)) push_out<kMayDeform>(d, meeting, near, masses, points);
  if (params.moving == 0) return;
  const Points<D> displacement = add(sub(sub(points.position, points.previous), taken), points.carry);
  points.previous = sub(points.position, displacement);
  points.carry = sub(displacement, sub(points.position, points.previous));
}

/// next_yield() of lib/yield.h.
/// @param way2  squares of how far colliders moved the points [m^2]
template <class D>
HWY_INLINE Vec<D> next_yield(D d, Vec<D> yield, Vec<D> way2, float spacing) {
  const float drawn = shader::kDrawn * spacing, thrown = shader::kThrown * spacing, drawn2 = drawn * drawn;
  const auto half = hn::Set(d, 0.5F);
  auto r = hn::IfThenElse(hn::Lt(way2, hn::Set(d, 0.0625F * drawn2)), hn::Add(yield, yield), yield);
  for (const float times : {1.F, 4.F, 16.F})
    r = hn::IfThenElse(hn::Gt(way2, hn::Set(d, times * drawn2)), hn::Mul(half, r), r);
  r = hn::Min(hn::Max(r, hn::Set(d, shader::kLeastYield)), hn::Set(d, 1.F));
  return hn::IfThenElse(hn::Gt(way2, hn::Set(d, thrown * thrown)), yield, r);
}

/// Yields of the points from pixel i on that colliders have moved.
/// @param yielded  whether one may not be 1 before
/// @return whether one is not 1 then
template <class D>
HWY_INLINE bool change_yields(D d, ClothState& state, Mask<D> free, uint32_t i, Vec<D> way2, float spacing,
                              bool yielded) {
  const float drawn = shader::kDrawn * spacing;
  if (!yielded && hn::AllFalse(d, hn::Gt(way2, hn::Set(d, drawn * drawn)))) return false;
  const auto one = hn::Set(d, 1.F);
  const auto next = hn::IfThenElse(free, next_yield(d, hn::LoadU(d, &state.yield[i]), way2, spacing), one);
  hn::StoreU(next, d, &state.yield[i]);
  return !hn::AllTrue(d, hn::Eq(next, one));
}

/// From pixel i on.
/// @param yielded  whether a yield may not be 1 before
/// @return whether one is not 1 then
template <bool kChanged, bool kMayDeform, class D>
HWY_NOINLINE bool collide_from(D d, const Meeting& meeting, ClothState& state, uint32_t substep, uint32_t i,
                               bool yielded) {
  const PointRow p = at(state.position, i), pp = at(state.previous, i), pc = at(state.carry, i);
  const PointStates<D> before{load(d, p), load(d, pp), load(d, pc)};
  const auto free = free_lanes(d, &state.inverse_mass[i]);
  PointStates<D> points = before;
  if (kChanged && meeting.params.max_step > 0) points = limit_speed(d, points, meeting.params.max_step);
  const Points<D> slowed{points.position.x, points.position.y, points.position.z};
  if constexpr (kChanged) {
    collide_changed<kMayDeform>(d, meeting, substep, free, masses_of(meeting, state, i), points);
    points = choose<D>(free, points, before);
  } else {
    push_out<kMayDeform>(d, meeting, free, masses_of(meeting, state, i), points);
  }
  store(d, points.position, p);
  store(d, points.previous, pp);
  store(d, points.carry, pc);
  const Points<D> moved = sub(points.position, slowed);
  return change_yields(d, state, free, i, dot(d, moved, moved), meeting.params.spacing, yielded);
}

/// The same, once it is known whether a collider deforms.
template <bool kChanged, class D>
HWY_INLINE bool collide_one(D d, const Meeting& meeting, ClothState& state, uint32_t substep, uint32_t i,
                            bool yielded) {
  return meeting.frame.deforms ? collide_from<kChanged, true>(d, meeting, state, substep, i, yielded)
                               : collide_from<kChanged, false>(d, meeting, state, substep, i, yielded);
}

/// Where no collider was near points give way again.
template <class D>
HWY_INLINE bool yield_again(D d, const Meeting& meeting, ClothState& state, uint32_t i) {
  const auto free = free_lanes(d, &state.inverse_mass[i]);
  return change_yields(d, state, free, i, hn::Zero(d), meeting.params.spacing, true);
}

/// As many vectors as a word has bits.
constexpr uint32_t kWordVectors = 64;

/// near_vectors() for one collider.
/// @param near  near(guard, points, what to reach): see Guards::near()
template <class D, class Near>
HWY_INLINE uint64_t vectors_near_one(D d, const ColliderGuard& guard, const PointRow& positions, const PointRow& before,
                                     uint32_t count, const Near& near) {
  const auto twice = hn::Set(d, 2 * guard.spread), least = hn::Set(d, guard.reach);
  uint64_t bits = 0;
  for (uint32_t k = 0; k < count; ++k) {
    const size_t i = anew(k * hn::Lanes(d));  // else six addresses are counted up
    const Points<D> p = load(d, after(positions, i));
    const auto reach = hn::MulAdd(at_most(d, sub(p, load(d, after(before, i)))), twice, least);
    bits |= uint64_t{hn::AllFalse(d, near(p, reach)) ? 0U : 1U} << k;
  }
  return bits;
}

/// A bit for each of some vectors in a row: a collider may touch one of its points. One collider after the other, so
/// that nothing is read and chosen anew for each vector.
/// @param before  where the points were before they moved
template <class D>
HWY_INLINE uint64_t near_vectors(D d, const Guards& guards, const PointRow& positions, const PointRow& before,
                                 uint32_t count) {
  uint64_t bits = 0;
  for (size_t c = 0; c < guards.count; ++c) {
    const ColliderGuard guard = guards.guards[c];
    const Points<D> place = set(d, guard.x, guard.y, guard.z);
    const auto near = [&](auto kind) GEOCLOTH_LANES {
      return vectors_near_one(d, guard, positions, before, count, [&](const Points<D>& p, Vec<D> reach) GEOCLOTH_LANES {
        return Guards::reaches<decltype(kind)::value>(d, guard, place, p, reach);
      });
    };
    switch (guard.kind) {
      case ColliderGuard::Kind::plane:
        bits |= near(std::integral_constant<ColliderGuard::Kind, ColliderGuard::Kind::plane>());
        break;
      case ColliderGuard::Kind::ball:
        bits |= near(std::integral_constant<ColliderGuard::Kind, ColliderGuard::Kind::ball>());
        break;
      case ColliderGuard::Kind::segment:
        bits |= near(std::integral_constant<ColliderGuard::Kind, ColliderGuard::Kind::segment>());
        break;
    }
  }
  return bits;
}

/// Where no collider can reach, collide.h leaves a point as it is.
template <class D>
HWY_NOINLINE void collide(D d, const SweepFrame& frame, uint32_t substep, std::span<const Run> runs) {
  ClothState& state = *frame.state;
  const Meeting meeting(frame, substep);
  const uint32_t width = state.data.width;
  if (frame.collide_all) {
    return for_vectors(d, runs, [&](uint32_t i) GEOCLOTH_LANES {
      if (collide_one<true>(d, meeting, state, substep, i, true)) state.mark_yielding(i / width, true);
    });
  }
  const auto lanes = static_cast<uint32_t>(hn::Lanes(d));
  const PointRow positions = at(state.position, 0), before = at(state.previous, 0);
  for (size_t k = 0; k < runs.size();) {
    const uint32_t row = runs[k].first / width;
    const bool yielded = state.yields_in(row, row + 1);
    bool yields = false;
    for (; k < runs.size() && runs[k].first / width == row; ++k) {
      const Run& run = runs[k];
      for (uint32_t first = run.first; first < run.last; first += kWordVectors * lanes) {
        const uint32_t count = std::min(kWordVectors, (run.last - first) / lanes);
        const uint64_t near = near_vectors(d, meeting.guards, after(positions, first), after(before, first), count);
        for (uint64_t left = near; left != 0; left &= left - 1) {
          const uint32_t i = first + static_cast<uint32_t>(std::countr_zero(left)) * lanes;
          if (hn::AllFalse(d, free_lanes(d, &state.inverse_mass[i]))) continue;
          if (collide_one<false>(d, meeting, state, substep, i, yielded)) yields = true;
        }
        for (uint32_t n = 0; yielded && n < count; ++n) {
          if ((near >> n & 1) == 0 && yield_again(d, meeting, state, first + n * lanes)) yields = true;
        }
      }
    }
    if (yields != yielded) state.mark_yielding(row, yields);
  }
}

/// depth_in_colliders() of lib/collide.h from pixel i on, the largest of all that move.
template <class D>
HWY_NOINLINE float depth_of(D d, const SweepFrame& frame, uint32_t substep, uint32_t i) {
  const Meeting meeting(frame, substep);
  const size_t count = meeting.met.shapes.size();
  const Points<D> position = load(d, at(frame.state->position, i));
  const auto free = free_lanes(d, &frame.state->inverse_mass[i]);
  auto depth = hn::Zero(d);
  for (size_t c = 0; c < count; ++c) {
    const auto near = hn::And(free, Guards::near(d, meeting.guards.guards[c], position, hn::Zero(d)));
    if (hn::AllFalse(d, near)) continue;
    const Points<D> local = to_local(d, meeting.ended(c), position);
    const auto own = hn::Neg(distance_to_shape(d, meeting.numbers, meeting.met.shapes[c], local));
    depth = max_of(d, depth, hn::IfThenElseZero(free, own));
  }
  return hn::GetLane(hn::MaxOfLanes(d, depth));
}

template <class D>
HWY_NOINLINE void check_colliders(D d, const SweepFrame& frame, uint32_t substep, std::span<const Run> runs) {
  const Guards guards(frame, substep);
  float depth = frame.penetration[substep];
  for_vectors(d, runs, [&](uint32_t i) GEOCLOTH_LANES {
    const auto near = guards.near(d, load(d, at(frame.state->position, i)), hn::Zero(d));
    if (!hn::AllFalse(d, near)) depth = std::max(depth, depth_of(d, frame, substep, i));
  });
  frame.penetration[substep] = depth;
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
