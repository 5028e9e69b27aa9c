// SPDX-License-Identifier: Apache-2.0
// Triangles between pixels against colliders in vectors, a triangle in each lane, operation by operation those of
// lib/collide_cell.h.
#if defined(GEOCLOTH_CPU_TRIANGLES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_TRIANGLES_INL_H
#undef GEOCLOTH_CPU_TRIANGLES_INL_H
#else
#define GEOCLOTH_CPU_TRIANGLES_INL_H
#endif

#include <array>
#include <cstdint>

#include "cpu/collide_inl.h"
#include "lib/collide_cell.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

template <class D>
struct Corners {
  Points<D> a, b, c;
};

/// shader::MovedTriangle and the inverse masses of its corners.
template <class D>
struct MovedTriangles {
  Corners<D> now, start;
  Points<D> mass;
};

template <class D>
HWY_INLINE Points<D> at_weights(D d, const Corners<D>& t, const Points<D>& weights) {
  return add(add(scale(d, t.a, weights.x), scale(d, t.b, weights.y)), scale(d, t.c, weights.z));
}
template <class D>
HWY_INLINE Points<D> thirds(D d) {
  const float third = 1.F / 3.F;
  return set(d, third, third, third);
}
template <class D>
HWY_INLINE Corners<D> corners_to_local(D d, const Posed& at, const Corners<D>& t) {
  return {to_local(d, at, t.a), to_local(d, at, t.b), to_local(d, at, t.c)};
}
template <class D>
HWY_INLINE Vec<D> longest_side(D d, const Corners<D>& t) {
  return max_of(d, length(d, sub(t.b, t.a)), max_of(d, length(d, sub(t.c, t.b)), length(d, sub(t.a, t.c))));
}
template <class D>
HWY_INLINE Vec<D> way_of_corners(D d, const Corners<D>& from, const Corners<D>& to) {
  return max_of(d, length(d, sub(to.a, from.a)), max_of(d, length(d, sub(to.b, from.b)), length(d, sub(to.c, from.c))));
}

template <class D>
HWY_INLINE Points<D> nearest_weights(D d, const Corners<D>& t, const Points<D>& p) {
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.F), tiny = hn::Set(d, 1e-30F);
  const Points<D> ab = sub(t.b, t.a), ac = sub(t.c, t.a), ap = sub(p, t.a), bp = sub(p, t.b), cp = sub(p, t.c);
  const auto d1 = dot(d, ab, ap), d2 = dot(d, ac, ap), d3 = dot(d, ab, bp);
  const auto d4 = dot(d, ac, bp), d5 = dot(d, ab, cp), d6 = dot(d, ac, cp);
  const auto vc = hn::Sub(hn::Mul(d1, d4), hn::Mul(d3, d2));
  const auto vb = hn::Sub(hn::Mul(d5, d2), hn::Mul(d1, d6));
  const auto va = hn::Sub(hn::Mul(d3, d6), hn::Mul(d5, d4));
  const auto over = [&](Vec<D> whole) GEOCLOTH_LANES { return hn::Div(one, max_of(d, whole, tiny)); };
  // From the last case of the text to its first, which counts most.
  const auto whole = over(hn::Add(hn::Add(va, vb), vc));
  auto v = hn::Mul(vb, whole), w = hn::Mul(vc, whole);
  const auto choose_case = [&](Mask<D> holds, Vec<D> case_v, Vec<D> case_w) GEOCLOTH_LANES {
    v = hn::IfThenElse(holds, case_v, v);
    w = hn::IfThenElse(holds, case_w, w);
  };
  const auto to_c = hn::Sub(d4, d3), to_b = hn::Sub(d5, d6);
  const auto on_bc = hn::Mul(to_c, over(hn::Add(to_c, to_b)));
  choose_case(hn::And(hn::Le(va, zero), hn::And(hn::Ge(d4, d3), hn::Ge(d5, d6))), hn::Sub(one, on_bc), on_bc);
  choose_case(hn::And(hn::Le(vb, zero), hn::And(hn::Ge(d2, zero), hn::Le(d6, zero))), zero,
              hn::Mul(d2, over(hn::Sub(d2, d6))));
  choose_case(hn::And(hn::Le(vc, zero), hn::And(hn::Ge(d1, zero), hn::Le(d3, zero))),
              hn::Mul(d1, over(hn::Sub(d1, d3))), zero);
  choose_case(hn::And(hn::Ge(d6, zero), hn::Le(d5, d6)), zero, one);
  choose_case(hn::And(hn::Ge(d3, zero), hn::Le(d4, d3)), one, zero);
  choose_case(hn::And(hn::Le(d1, zero), hn::Le(d2, zero)), zero, zero);
  return {max_of(d, hn::Sub(hn::Sub(one, v), w), zero), v, w};
}

template <class D>
HWY_NOINLINE Points<D> deepest_weights(D d, const float* numbers, const shader::ColliderShape& shape, Mask<D> lanes,
                                       const Corners<D>& t) {
  Points<D> weights = thirds(d);
  const uint32_t steps = shape.kind == shader::kShapeSphere ? 1U : shader::kDeepestSteps;
  for (uint32_t i = 0; i < steps && !hn::AllFalse(d, lanes); ++i) {
    const Points<D> p = at_weights(d, t, weights);
    const Nearest<D> near = nearest_of_shape(d, numbers, shape, p);
    const auto to_core = hn::Neg(hn::Add(near.distance, hn::Set(d, shape.core)));
    const Points<D> next = nearest_weights(d, t, shifted(d, p, near.normal, to_core));
    const auto arrived = hn::Lt(length(d, sub(next, weights)), hn::Set(d, shader::kArrived));
    replace(lanes, next, weights);
    lanes = hn::AndNot(arrived, lanes);
  }
  return weights;
}

template <class D>
HWY_INLINE void push_corner(D d, const Posed& before, const Posed& after, Mask<D> lanes, Points<D>& now,
                            Points<D>& start, const Points<D>& n, const Points<D>& local_n, Vec<D> push) {
  const auto zero = hn::Zero(d);
  const auto along = dot(d, sub(to_local(d, after, now), to_local(d, before, start)), local_n);
  const auto kept = max_of(d, hn::Add(push, min_of(d, along, zero)), zero);
  replace(lanes, shifted(d, now, n, push), now);
  replace(lanes, shifted(d, start, n, kept), start);
}

/// The poses of a collider at both ends of a substep.
struct ColliderWay {
  Posed before, after;
};

/// @param start    the corners when the substep began, in the collider's frame of then
/// @return the lanes that were moved
template <class D>
HWY_NOINLINE Mask<D> push_points(D d, const Meeting& meeting, size_t collider, const ColliderWay& poses, Mask<D> lanes,
                                 MovedTriangles<D>& t, const Corners<D>& start, const Points<D>& weights) {
  const shader::ColliderShape& shape = meeting.met.shapes[collider];
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.F);
  const Points<D> p0 = at_weights(d, start, weights);
  const Points<D> p1 = to_local(d, poses.after, at_weights(d, t.now, weights));
  const Nearest<D> near = nearest_of_shape(d, meeting.numbers, shape, p1);
  const bool swept = !poses.before.deforms();
  const Contacts<D> contact = find_contacts(d, meeting, shape, lanes, p0, p1, near, near.distance, zero, swept);
  const Points<D> share = mul(d, t.mass, weights);
  const auto sum = dot(d, share, weights);
  const auto moved = hn::AndNot(hn::Le(sum, zero), contact.touches);
  if (hn::AllFalse(d, moved)) return moved;
  const auto approach =
      hn::Add(max_of(d, dot(d, sub(p0, p1), contact.normal), zero), hn::Set(d, shader::lift_of(meeting.params, shape)));
  const auto least = hn::Mul(max_of(d, share), hn::Set(d, 1.F / shader::kLargestLever));
  const auto lifted = min_of(d, hn::Mul(sum, hn::Div(one, least)), one);
  const auto push = hn::Mul(hn::Mul(min_of(d, contact.depth, approach), lifted), hn::Div(one, max_of(d, sum, least)));
  const Points<D> n = rotate_to_world(d, poses.after.pose, contact.normal);
  const auto push_one = [&](Points<D>& now, Points<D>& began, Vec<D> of_it, Vec<D> mass) GEOCLOTH_LANES {
    const Points<D> came = sub(now, began);
    push_corner(d, poses.before, poses.after, moved, now, began, n, contact.normal, hn::Mul(push, of_it));
    if (meeting.contacts != nullptr) {
      std::array<float, hn::MaxLanes(D())> masses;
      hn::StoreU(mass, d, masses.data());
      add_contacts(d, meeting.sum_of(collider, {masses.data(), kFullYields.data()}), moved, sub(sub(now, began), came),
                   n, now);
    }
  };
  push_one(t.now.a, t.start.a, share.x, t.mass.x);
  push_one(t.now.b, t.start.b, share.y, t.mass.y);
  push_one(t.now.c, t.start.c, share.z, t.mass.z);
  return moved;
}

template <class D>
HWY_INLINE Vec<D> least_gap(D d, const shader::ColliderShape& shape, const Corners<D>& t, const Nearest<D>& near,
                            Vec<D> side) {
  const Points<D> middle = at_weights(d, t, thirds(d));
  const auto below = [&](const Points<D>& p) GEOCLOTH_LANES { return dot(d, sub(p, middle), near.normal); };
  const auto drop =
      shape.kind == shader::kShapeMesh ? hn::Neg(side) : min_of(d, below(t.a), min_of(d, below(t.b), below(t.c)));
  const auto rounding = hn::Mul(hn::Set(d, shader::kGapRounding), hn::Add(hn::Set(d, 1.F), hn::Abs(near.distance)));
  return hn::Sub(hn::Add(near.distance, drop), rounding);
}

template <class D>
HWY_NOINLINE Mask<D> flat_below(D d, const float* numbers, const shader::ColliderShape& shape, const Corners<D>& t,
                                const Nearest<D>& near, Vec<D> side) {
  const Points<D> middle = at_weights(d, t, thirds(d));
  const auto bent_at = [&](const Points<D>& p) GEOCLOTH_LANES {
    const auto distance = distance_to_shape(d, numbers, shape, p);
    return hn::Abs(hn::Sub(hn::Sub(distance, dot(d, sub(p, middle), near.normal)), near.distance));
  };
  const auto bent = max_of(d, max_of(d, bent_at(t.a), bent_at(t.b)), bent_at(t.c));
  return hn::Lt(bent, hn::Mul(hn::Set(d, shader::kFlat), side));
}

/// collide_triangle().
/// @return the lanes that were moved
template <class D>
HWY_NOINLINE Mask<D> collide_triangles(D d, const Meeting& meeting, Mask<D> lanes, MovedTriangles<D>& t) {
  Mask<D> moved = hn::Gt(hn::Zero(d), hn::Zero(d));
  lanes = hn::AndNot(hn::Le(max_of(d, t.mass), hn::Zero(d)), lanes);
  auto side = longest_side(d, t.now);
  const size_t count = meeting.met.shapes.size();
  for (size_t i = 0; i < count; ++i) {
    const shader::ColliderShape& shape = meeting.met.shapes[i];
    const auto open = hn::Set(d, shader::open_side(meeting.params, shape));
    Mask<D> met = hn::AndNot(hn::Lt(side, open), lanes);
    if (hn::AllFalse(d, met)) continue;
    const ColliderWay poses{meeting.begun(i), meeting.ended(i)};
    const auto way = way_of_corners(d, t.start, t.now);
    const shader::ColliderPose& pose = poses.after.pose;
    const Points<D> middle = set(d, pose.row0.w, pose.row1.w, pose.row2.w);
    const auto far = hn::Sub(hn::Sub(length(d, sub(t.now.a, middle)), hn::Set(d, shape.b.w)), side);
    met = hn::AndNot(hn::Gt(far, reach_of(d, shape, way)), met);
    if (hn::AllFalse(d, met)) continue;
    const Corners<D> last = corners_to_local(d, poses.after, t.now);
    const Nearest<D> near = nearest_of_shape(d, meeting.numbers, shape, at_weights(d, last, thirds(d)));
    const auto gap = least_gap(d, shape, last, near, side);
    met = hn::AndNot(hn::Gt(gap, reach_of(d, shape, way)), met);
    if (hn::AllFalse(d, met)) continue;
    const Corners<D> first = corners_to_local(d, poses.before, t.start);
    const auto seen_way = way_of_corners(d, first, last);
    met = hn::AndNot(hn::Gt(gap, seen_way), met);
    if (hn::AllFalse(d, met)) continue;
    if (shape.kind == shader::kShapeMesh) {
      const auto is_short = hn::Lt(seen_way, hn::Mul(hn::Set(d, shader::kShortWay), side));
      met = hn::AndNot(hn::And(is_short, flat_below(d, meeting.numbers, shape, last, near, side)), met);
      if (hn::AllFalse(d, met)) continue;
    }
    const auto push = [&](const Corners<D>& at) GEOCLOTH_LANES {
      const Points<D> weights = deepest_weights(d, meeting.numbers, shape, met, at);
      moved = hn::Or(moved, push_points(d, meeting, i, poses, met, t, first, weights));
    };
    push(first);
    push(corners_to_local(d, poses.after, t.now));
    side = longest_side(d, t.now);
  }
  return moved;
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
