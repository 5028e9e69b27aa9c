// SPDX-License-Identifier: Apache-2.0
// Signed distances and normals of collider shapes in vectors, operation by operation those of lib/shapes.h.
#if defined(GEOCLOTH_CPU_SHAPES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_SHAPES_INL_H
#undef GEOCLOTH_CPU_SHAPES_INL_H
#else
#define GEOCLOTH_CPU_SHAPES_INL_H
#endif

#include <array>
#include <limits>

#include "cpu/collider_set.h"
#include "cpu/lanes_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

template <class D>
struct Nearest {
  Vec<D> distance;
  Points<D> normal;
};

/// min and max of shared/types.h: of equal zeros the first one.
template <class D>
HWY_INLINE Vec<D> min_of(D, Vec<D> a, Vec<D> b) {
  return hn::IfThenElse(hn::Lt(b, a), b, a);
}
template <class D>
HWY_INLINE Vec<D> max_of(D, Vec<D> a, Vec<D> b) {
  return hn::IfThenElse(hn::Lt(a, b), b, a);
}
template <class D>
HWY_INLINE Vec<D> max_of(D d, const Points<D>& a) {
  return max_of(d, a.x, max_of(d, a.y, a.z));
}
template <class D>
HWY_INLINE Points<D> abs_of(D, const Points<D>& a) {
  return {hn::Abs(a.x), hn::Abs(a.y), hn::Abs(a.z)};
}
template <class D>
HWY_INLINE Points<D> mul(D, const Points<D>& a, const Points<D>& b) {
  return {hn::Mul(a.x, b.x), hn::Mul(a.y, b.y), hn::Mul(a.z, b.z)};
}
template <class D>
HWY_INLINE Points<D> sides_of(D d, const Points<D>& p) {
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.F), less = hn::Set(d, -1.F);
  return {hn::IfThenElse(hn::Lt(p.x, zero), less, one), hn::IfThenElse(hn::Lt(p.y, zero), less, one),
          hn::IfThenElse(hn::Lt(p.z, zero), less, one)};
}

template <class D>
HWY_INLINE Nearest<D> nearest_along(D d, const UnitAndLength<D>& out, Vec<D> distance) {
  return {distance, choose<D>(hn::Gt(out.length, hn::Zero(d)), out.unit, set(d, 0, 1, 0))};
}

template <class D>
HWY_INLINE Nearest<D> nearest_ball(D d, const Points<D>& from_center, Vec<D> radius) {
  const UnitAndLength<D> out = unit_and_length(d, from_center);
  return nearest_along(d, out, hn::Sub(out.length, radius));
}

template <class D>
HWY_INLINE Nearest<D> nearest_capsule(D d, const shader::ColliderShape& shape, const Points<D>& p) {
  const auto end = hn::Set(d, shape.a.x), start = hn::Neg(end);
  const auto rho = hn::Sqrt(hn::Add(hn::Mul(p.y, p.y), hn::Mul(p.z, p.z)));
  const auto along = min_of(d, max_of(d, hn::Sub(p.x, hn::Mul(rho, hn::Set(d, shape.b.y))), start), end);
  const auto radius = hn::Sub(hn::Set(d, 0.5F * (shape.a.y + shape.a.z)), hn::Mul(hn::Set(d, shape.b.x), along));
  return nearest_ball(d, sub(p, Points<D>{along, hn::Zero(d), hn::Zero(d)}), radius);
}

template <class D>
HWY_NOINLINE Nearest<D> nearest_box(D d, const shader::ColliderShape& shape, const Points<D>& p) {
  const auto zero = hn::Zero(d);
  const Points<D> q = sub(abs_of(d, p), set(d, shape.a.x, shape.a.y, shape.a.z)), side = sides_of(d, p);
  const auto largest = max_of(d, q);
  const UnitAndLength<D> out =
      unit_and_length(d, Points<D>{max_of(d, q.x, zero), max_of(d, q.y, zero), max_of(d, q.z, zero)});
  const auto of_x = hn::Eq(q.x, largest), of_y = hn::AndNot(of_x, hn::Eq(q.y, largest));
  const Points<D> face{hn::IfThenElseZero(of_x, side.x), hn::IfThenElseZero(of_y, side.y),
                       hn::IfThenZeroElse(hn::Or(of_x, of_y), side.z)};
  const auto outside = hn::Gt(largest, zero);
  return {hn::IfThenElse(outside, out.length, largest), choose<D>(outside, mul(d, out.unit, side), face)};
}

/// Newton's method of nearest_ellipsoid().
template <class D>
HWY_INLINE Nearest<D> nearest_ellipsoid(D d, const shader::vec3& radii, const Points<D>& p) {
  const float largest = shader::max(radii.x, shader::max(radii.y, radii.z)), to_unit = 1.F / largest;
  const shader::vec3 r1 = radii * to_unit, r2 = r1 * r1;
  const auto one = hn::Set(d, 1.F), tiny = hn::Set(d, 1e-20F);
  const Points<D> r = set(d, r1.x, r1.y, r1.z), squares = set(d, r2.x, r2.y, r2.z);
  const Points<D> scaled = scale(d, abs_of(d, p), hn::Set(d, to_unit));
  const Points<D> y{max_of(d, scaled.x, hn::Set(d, 1e-5F * r1.x)), max_of(d, scaled.y, hn::Set(d, 1e-5F * r1.y)),
                    max_of(d, scaled.z, hn::Set(d, 1e-5F * r1.z))};
  const Points<D> ry = mul(d, r, y);
  auto t = max_of(d, sub(ry, squares));
  const auto inverses = [&](Vec<D> at) GEOCLOTH_LANES {
    return Points<D>{hn::Div(one, hn::Add(at, squares.x)), hn::Div(one, hn::Add(at, squares.y)),
                     hn::Div(one, hn::Add(at, squares.z))};
  };
  for (uint32_t i = 0; i < shader::kEllipsoidSteps; ++i) {
    const Points<D> s = inverses(t), g = mul(d, ry, s);
    const auto value = hn::Sub(dot(d, g, g), one);
    const auto slope = hn::Mul(hn::Set(d, 2.F), dot(d, mul(d, g, g), s));
    const auto step = hn::Mul(value, hn::Div(one, max_of(d, slope, tiny)));
    t = hn::Add(t, max_of(d, step, hn::Zero(d)));
  }
  const Points<D> g = mul(d, ry, inverses(t));
  const Points<D> on_unit = scale(d, g, hn::Div(one, max_of(d, length(d, g), tiny)));
  const Points<D> q = mul(d, on_unit, r);
  const Points<D> outward = mul(d, on_unit, set(d, 1.F / r1.x, 1.F / r1.y, 1.F / r1.z));
  const Points<D> n = unit_and_length(d, outward).unit;
  return {hn::Mul(dot(d, sub(scaled, q), n), hn::Set(d, largest)), mul(d, n, sides_of(d, p))};
}

template <class D>
HWY_NOINLINE Nearest<D> nearest_ellipsoid_in_reach(D d, const shader::ColliderShape& shape, const Points<D>& p) {
  const shader::vec3 radii = shader::xyz(shape.a);
  const auto largest = hn::Set(d, shader::max(radii.x, shader::max(radii.y, radii.z)));
  const UnitAndLength<D> outward = unit_and_length(d, p);
  const auto bound = hn::Sub(outward.length, largest);
  const auto far = hn::Gt(bound, largest);
  if (hn::AllTrue(d, far)) return {bound, outward.unit};
  const Nearest<D> near = nearest_ellipsoid(d, radii, p);
  return {hn::IfThenElse(far, bound, near.distance), choose<D>(far, outward.unit, near.normal)};
}

template <class D>
HWY_NOINLINE Nearest<D> nearest_convex(D d, const float* numbers, const shader::ColliderShape& shape,
                                       const Points<D>& p) {
  Nearest<D> r{hn::Set(d, -1e30F), set(d, 0, 1, 0)};
  const float* const end = numbers + shape.data.x + size_t{4} * shape.data.y;
  for (const float* plane = numbers + shape.data.x; plane < end; plane += 4) {
    const Points<D> n = set(d, plane[0], plane[1], plane[2]);
    const auto height = hn::Sub(dot(d, n, p), hn::Set(d, plane[3]));
    const auto higher = hn::Gt(height, r.distance);
    r = {hn::IfThenElse(higher, height, r.distance), choose<D>(higher, n, r.normal)};
  }
  return r;
}

template <class D>
HWY_INLINE Vec<D> mix(D, Vec<D> a, Vec<D> b, Vec<D> t) {
  return hn::Add(a, hn::Mul(hn::Sub(b, a), t));
}

/// in_grid() of lib/shapes.h.
template <class D>
HWY_INLINE Points<D> in_grid(D d, const shader::ColliderShape& shape, const Points<D>& p) {
  return scale(d, sub(p, set(d, shape.a.x, shape.a.y, shape.a.z)), hn::Set(d, shape.b.x));
}
template <class D>
HWY_INLINE Points<D> grid_sides(D d, const shader::ColliderShape& shape) {
  return set(d, static_cast<float>(shape.data.y - 1), static_cast<float>(shape.data.z - 1),
             static_cast<float>(shape.data.w - 1));
}
template <class D>
HWY_INLINE Points<D> clamped_to(D d, const Points<D>& g, const Points<D>& side) {
  const auto clamped = [&](Vec<D> v, Vec<D> most) GEOCLOTH_LANES { return min_of(d, max_of(d, v, hn::Zero(d)), most); };
  return {clamped(g.x, side.x), clamped(g.y, side.y), clamped(g.z, side.z)};
}
template <class D>
struct GridPlaces {
  hn::VFromD<hn::RebindToSigned<D>> node;
  Points<D> t;
};
/// place_in_grid() of lib/shapes.h.
template <class D>
HWY_INLINE GridPlaces<D> place_in_grid(D d, const shader::ColliderShape& shape, const Points<D>& q,
                                       const Points<D>& side) {
  const hn::RebindToSigned<D> di;
  const auto one = hn::Set(d, 1.F);
  const auto row = static_cast<int32_t>(shape.data.y), layer = row * static_cast<int32_t>(shape.data.z);
  const auto cell_of = [&](Vec<D> v, Vec<D> most)
                           GEOCLOTH_LANES { return min_of(d, hn::Floor(v), hn::Sub(most, one)); };
  const Points<D> cell{cell_of(q.x, side.x), cell_of(q.y, side.y), cell_of(q.z, side.z)};
  // What is no number converts to anything: it must not lead out of the field.
  const auto index_of = [&](Vec<D> v, uint32_t count) GEOCLOTH_LANES {
    const auto most = hn::Set(di, static_cast<int32_t>(count - 2));
    return hn::Min(hn::Max(hn::ConvertTo(di, v), hn::Zero(di)), most);
  };
  const auto node =
      hn::Add(hn::Add(index_of(cell.x, shape.data.y), hn::Mul(index_of(cell.y, shape.data.z), hn::Set(di, row))),
              hn::Mul(index_of(cell.z, shape.data.w), hn::Set(di, layer)));
  return {node, sub(q, cell)};
}

/// Numbers of a grid at the corners of each lane's cell.
template <class D>
struct CellCorners {
  Vec<D> n000, n100, n010, n110, n001, n101, n011, n111;
};
/// Blocks of four numbers side by side, those of the lanes `lane`, `lane` + 4, `lane` + 8 ...
/// @param block  gives that of a lane
template <class D, class Block>
HWY_INLINE Vec<D> every_fourth(D d, size_t lane, const Block& block) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return block(lane);
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, every_fourth(half, lane + hn::MaxLanes(half), block), every_fourth(half, lane, block));
  }
}
/// Blocks of four numbers, one for each lane, as four vectors: the first numbers of all, the second ones ...
/// @param v  of the lanes 0, 4, 8 ... those of 1, 5, 9 ... and so on
template <class D>
HWY_INLINE std::array<Vec<D>, 4> transposed(D d, const std::array<Vec<D>, 4>& v) {
  const hn::RepartitionToWide<hn::RebindToUnsigned<D>> pair;
  const auto low01 = hn::BitCast(pair, hn::InterleaveLower(d, v[0], v[1]));
  const auto low23 = hn::BitCast(pair, hn::InterleaveLower(d, v[2], v[3]));
  const auto high01 = hn::BitCast(pair, hn::InterleaveUpper(d, v[0], v[1]));
  const auto high23 = hn::BitCast(pair, hn::InterleaveUpper(d, v[2], v[3]));
  return {hn::BitCast(d, hn::InterleaveLower(pair, low01, low23)),
          hn::BitCast(d, hn::InterleaveUpper(pair, low01, low23)),
          hn::BitCast(d, hn::InterleaveLower(pair, high01, high23)),
          hn::BitCast(d, hn::InterleaveUpper(pair, high01, high23))};
}

/// Two corners lie next to each other: four loads of two for each lane take less time than eight gathers.
/// @param node  the first corner of each lane's cell
template <class D>
HWY_INLINE CellCorners<D> corners_of_cells(D d, const float* grid, hn::VFromD<hn::RebindToSigned<D>> node, size_t row,
                                           size_t layer) {
  const hn::RebindToSigned<D> di;
  const hn::FixedTag<float, 2> d2;
  const hn::FixedTag<float, 4> d4;
  alignas(64) std::array<int32_t, hn::MaxLanes(D())> first;  // all are written before they are read
  hn::Store(node, di, first.data());
  const auto side_of_cell = [&](size_t lane, const float* corners) GEOCLOTH_LANES {
    const float* const corner = corners + first[lane];
    return hn::Combine(d4, hn::LoadU(d2, corner + row), hn::LoadU(d2, corner));
  };
  const auto sides = [&](const float* corners) GEOCLOTH_LANES {
    const auto side = [&](size_t lane) GEOCLOTH_LANES { return side_of_cell(lane, corners); };
    return transposed<D>(
        d, {every_fourth(d, 0, side), every_fourth(d, 1, side), every_fourth(d, 2, side), every_fourth(d, 3, side)});
  };
  const auto near = sides(grid), far = sides(grid + layer);
  return {near[0], near[1], near[2], near[3], far[0], far[1], far[2], far[3]};
}

/// @param reach  where all lanes are farther off than that, no normal is looked for
template <class D>
HWY_NOINLINE Nearest<D> nearest_mesh(D d, const float* numbers, const shader::ColliderShape& shape, const Points<D>& p,
                                     Vec<D> reach) {
  const auto zero = hn::Zero(d);
  const size_t row = shape.data.y, layer = row * shape.data.z;
  const Points<D> g = in_grid(d, shape, p), side = grid_sides(d, shape), q = clamped_to(d, g, side);
  const auto off_grid = hn::Or(hn::Ne(g.x, q.x), hn::Or(hn::Ne(g.y, q.y), hn::Ne(g.z, q.z)));
  UnitAndLength<D> out_of{set(d, 0, 1, 0), zero};
  if (!hn::AllFalse(d, off_grid)) out_of = unit_and_length(d, scale(d, sub(g, q), hn::Set(d, shape.a.w)));
  const auto outside = hn::Gt(out_of.length, zero);
  const auto bound = hn::Add(out_of.length, hn::Set(d, shape.b.y));
  if (hn::AllTrue(d, outside)) return {bound, out_of.unit};

  const GridPlaces<D> place = place_in_grid(d, shape, q, side);
  const Points<D>& t = place.t;
  const auto [d000, d100, d010, d110, d001, d101, d011, d111] =
      corners_of_cells(d, numbers + shape.data.x, place.node, row, layer);
  const auto d00 = mix(d, d000, d100, t.x), d10 = mix(d, d010, d110, t.x);
  const auto d01 = mix(d, d001, d101, t.x), d11 = mix(d, d011, d111, t.x);
  const auto d0 = mix(d, d00, d10, t.y), d1 = mix(d, d01, d11, t.y);
  const auto distance = hn::IfThenElse(outside, bound, mix(d, d0, d1, t.z));
  if (hn::AllTrue(d, hn::Gt(distance, reach))) return {distance, out_of.unit};

  const auto along_x = mix(d, mix(d, hn::Sub(d100, d000), hn::Sub(d110, d010), t.y),
                           mix(d, hn::Sub(d101, d001), hn::Sub(d111, d011), t.y), t.z);
  const auto along_y = mix(d, hn::Sub(d10, d00), hn::Sub(d11, d01), t.z);
  const UnitAndLength<D> gradient = unit_and_length(d, Points<D>{along_x, along_y, hn::Sub(d1, d0)});
  return {distance, choose<D>(outside, out_of.unit, nearest_along(d, gradient, distance).normal)};
}

/// deforming_way() of lib/shapes.h. The ways of a node lie next to each other: they are mixed as they lie.
template <class D>
HWY_INLINE Points<D> deforming_way(D d, const float* numbers, const shader::ColliderShape& shape, const Points<D>& p) {
  const hn::RebindToSigned<D> di;
  const hn::FixedTag<float, shader::kWayNumbers> dw;
  static_assert(shader::kWayNumbers == 4);
  const Points<D> side = grid_sides(d, shape);
  const GridPlaces<D> place = place_in_grid(d, shape, clamped_to(d, in_grid(d, shape, p), side), side);
  alignas(64) std::array<int32_t, hn::MaxLanes(D())> node;  // all are written before they are read
  hn::Store(place.node, di, node.data());
  const size_t row = shader::kWayNumbers * size_t{shape.data.y}, layer = row * shape.data.z;
  const float* const ways = numbers + shape.data.x + layer / shader::kWayNumbers * shape.data.w;
  const auto mixed = [&](size_t lane, Vec<D> tx, Vec<D> ty, Vec<D> tz) GEOCLOTH_LANES {
    const auto at = [&](size_t by) GEOCLOTH_LANES {
      return every_fourth(d, lane, [&](size_t k) GEOCLOTH_LANES {
        return hn::LoadU(dw, ways + shader::kWayNumbers * static_cast<size_t>(node[k]) + by);
      });
    };
    const auto along = [&](size_t by) GEOCLOTH_LANES { return mix(d, at(by), at(by + shader::kWayNumbers), tx); };
    return mix(d, mix(d, along(0), along(row), ty), mix(d, along(layer), along(layer + row), ty), tz);
  };
  const Points<D>& t = place.t;
  const auto way = transposed<D>(d, {mixed(0, hn::Broadcast<0>(t.x), hn::Broadcast<0>(t.y), hn::Broadcast<0>(t.z)),
                                     mixed(1, hn::Broadcast<1>(t.x), hn::Broadcast<1>(t.y), hn::Broadcast<1>(t.z)),
                                     mixed(2, hn::Broadcast<2>(t.x), hn::Broadcast<2>(t.y), hn::Broadcast<2>(t.z)),
                                     mixed(3, hn::Broadcast<3>(t.x), hn::Broadcast<3>(t.y), hn::Broadcast<3>(t.z))});
  return {way[0], way[1], way[2]};
}

/// @param reach  where all lanes are farther off than that, their normals may be any
template <class D>
HWY_INLINE Nearest<D> nearest_of_shape(D d, const float* numbers, const shader::ColliderShape& shape,
                                       const Points<D>& p, Vec<D> reach) {
  switch (shape.kind) {
    case shader::kShapePlane:
      return {p.y, set(d, 0, 1, 0)};
    case shader::kShapeSphere:
      return nearest_ball(d, p, hn::Set(d, shape.a.x));
    case shader::kShapeCapsule:
      return nearest_capsule(d, shape, p);
    case shader::kShapeBox:
      return nearest_box(d, shape, p);
    case shader::kShapeConvex:
      return nearest_convex(d, numbers, shape, p);
    case shader::kShapeMesh:
      return nearest_mesh(d, numbers, shape, p, reach);
    default:
      return nearest_ellipsoid_in_reach(d, shape, p);
  }
}

template <class D>
HWY_INLINE Nearest<D> nearest_of_shape(D d, const float* numbers, const shader::ColliderShape& shape,
                                       const Points<D>& p) {
  return nearest_of_shape(d, numbers, shape, p, hn::Set(d, std::numeric_limits<float>::infinity()));
}
template <class D>
HWY_INLINE Vec<D> distance_to_shape(D d, const float* numbers, const shader::ColliderShape& shape, const Points<D>& p) {
  return nearest_of_shape(d, numbers, shape, p, hn::Set(d, -std::numeric_limits<float>::infinity())).distance;
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
