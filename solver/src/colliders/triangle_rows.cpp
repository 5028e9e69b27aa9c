// SPDX-License-Identifier: Apache-2.0
// Distances from a triangle to rows of nodes, in vectors and without a branch; the bits are the same for every
// instruction set.

#include "colliders/triangle_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "colliders/triangle_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "points_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::HWY_NAMESPACE {

constexpr uint32_t kWindow = 8;  ///< nodes of a row that are measured at once, whatever a vector holds

template <class D>
HWY_INLINE Points<D> set(D d, const Vec3& v) {
  return set(d, v.x, v.y, v.z);
}

/// @param p  [spacings] the points, from the first corner
template <class D>
HWY_INLINE Vec<D> squares_of(D d, const RowTriangle& t, const Points<D>& p) {
  const auto zero = hn::Zero(d), one = hn::Set(d, 1.F);
  auto least = hn::Set(d, std::numeric_limits<float>::max()), most_out = hn::Set(d, t.flat ? 1.F : -1.F);
  for (const RowTriangle::Edge& e : t.edges) {
    const Points<D> way = set(d, e.way), q = sub(p, set(d, e.from));
    const auto share = hn::Min(hn::Max(hn::Mul(dot(d, q, way), hn::Set(d, e.inverse)), zero), one);
    const Points<D> off = sub(q, scale(d, way, share));
    least = hn::Min(least, dot(d, off, off));
    most_out = hn::Max(most_out, dot(d, q, set(d, e.out)));
  }
  const auto above = dot(d, p, set(d, t.normal));
  return hn::IfThenElse(hn::Gt(most_out, zero), least, hn::Mul(above, above));
}

/// Nodes that lie one after another in a row.
/// @param p  [spacings] the first one, from the triangle's first corner
template <class D>
HWY_INLINE void measure_row(D d, const RowTriangle& t, uint32_t number, const Vec3& p, uint32_t count, float* square,
                            uint32_t* nearest) {
  const hn::RebindToUnsigned<D> du;
  const auto own = hn::Set(du, number);
  const auto steps = hn::Iota(d, 0.F);
  for (uint32_t k = 0; k < count; k += static_cast<uint32_t>(hn::Lanes(d))) {
    const auto x = hn::Add(hn::Set(d, p.x), hn::Add(steps, hn::Set(d, static_cast<float>(k))));
    const auto mine = squares_of<D>(d, t, {x, hn::Set(d, p.y), hn::Set(d, p.z)});
    const auto before = hn::LoadU(d, square + k);
    const auto nearer = hn::Lt(mine, before);
    hn::StoreU(hn::IfThenElse(nearer, mine, before), d, square + k);
    hn::StoreU(hn::IfThenElse(hn::RebindMask(du, nearer), own, hn::LoadU(du, nearest + k)), du, nearest + k);
  }
}

/// [spacings] From a node to what lies from low to high along an axis.
HWY_INLINE double off(double low, double high, uint32_t node) {
  const auto at = static_cast<double>(node);
  return std::max({low - at, at - high, 0.0});
}

/// @param window  nodes that are measured at once
template <class D>
HWY_INLINE void measure_layers(D d, uint32_t window, const RowTriangle& t, uint32_t number,
                               const std::array<uint32_t, 3>& size, uint32_t first, uint32_t last, float* square,
                               uint32_t* nearest) {
  for (uint32_t z = first; z < last; ++z) {
    const double off_z = off(t.low.z, t.high.z, z);
    for (uint32_t y = t.first[1]; y < t.last[1]; ++y) {
      const double off_y = off(t.low.y, t.high.y, y);
      if (off_y * off_y + off_z * off_z > t.reach * t.reach) continue;
      for (uint32_t from = t.first[0]; from < t.last[0]; from += window) {
        const uint32_t x = std::min(from, size[0] - window);  // the last window measures some twice
        const Vec3 p{static_cast<float>(x - t.a.x), static_cast<float>(y - t.a.y), static_cast<float>(z - t.a.z)};
        const size_t node = (size_t{z} * size[1] + y) * size[0] + x;
        measure_row(d, t, number, p, window, square + node, nearest + node);
      }
    }
  }
}

void measure_here(const RowTriangle& t, uint32_t number, const std::array<uint32_t, 3>& size, uint32_t first_layer,
                  uint32_t last_layer, float* square, uint32_t* nearest) {
  const uint32_t first = std::max(t.first[2], first_layer), last = std::min(t.last[2], last_layer);
  if (size[0] < kWindow) {
    const hn::CappedTag<float, 1> d;
    return measure_layers(d, 1, t, number, size, first, last, square, nearest);
  }
  const hn::CappedTag<float, kWindow> d;
  measure_layers(d, kWindow, t, number, size, first, last, square, nearest);
}

}  // namespace geocloth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth {

RowTriangle::RowTriangle(const TriangleCorners& t, double reach_of_it, const std::array<uint32_t, 3>& size)
    : a(t.a), reach(reach_of_it) {
  const std::array<Vec3d, 3> corner{t.a, t.b, t.c};
  const Vec3d n = cross(t.b - t.a, t.c - t.a);
  const double area = length(n);
  flat = !(area > 1e-12);
  const Vec3d unit = flat ? Vec3d{} : (1 / area) * n;
  normal = to_float(unit);
  for (size_t k = 0; k < 3; ++k) {
    const Vec3d edge = corner[(k + 1) % 3] - corner[k];
    const double square = dot(edge, edge);
    edges[k] = {to_float(corner[k] - t.a), to_float(edge), to_float(cross(edge, unit)),
                square > 0 ? static_cast<float>(1 / square) : 0.F};
  }
  low = {std::min({t.a.x, t.b.x, t.c.x}), std::min({t.a.y, t.b.y, t.c.y}), std::min({t.a.z, t.b.z, t.c.z})};
  high = {std::max({t.a.x, t.b.x, t.c.x}), std::max({t.a.y, t.b.y, t.c.y}), std::max({t.a.z, t.b.z, t.c.z})};
  const auto node = [](double at, uint32_t count) {
    return static_cast<uint32_t>(std::clamp(at, 0.0, static_cast<double>(count)));
  };
  const auto from = [&](double at, uint32_t count) { return node(std::ceil(at - reach), count); };
  const auto to = [&](double at, uint32_t count) { return node(std::floor(at + reach) + 1, count); };
  first = {from(low.x, size[0]), from(low.y, size[1]), from(low.z, size[2])};
  last = {to(high.x, size[0]), to(high.y, size[1]), to(high.z, size[2])};
}

HWY_EXPORT(measure_here);
void measure_triangle(const RowTriangle& triangle, uint32_t number, const std::array<uint32_t, 3>& size,
                      uint32_t first_layer, uint32_t last_layer, float* square, uint32_t* nearest) {
  HWY_DYNAMIC_DISPATCH(measure_here)(triangle, number, size, first_layer, last_layer, square, nearest);
}

}  // namespace geocloth
#endif
