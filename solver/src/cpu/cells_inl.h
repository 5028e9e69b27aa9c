// SPDX-License-Identifier: Apache-2.0
// Which cells a collider may reach, in vectors; those of several rows share vectors for their triangles.
#if defined(GEOCLOTH_CPU_CELLS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once for each instruction set
#ifdef GEOCLOTH_CPU_CELLS_INL_H
#undef GEOCLOTH_CPU_CELLS_INL_H
#else
#define GEOCLOTH_CPU_CELLS_INL_H
#endif

#include <algorithm>
#include <array>
#include <limits>

#include "cpu/collide_inl.h"
#include "cpu/triangles_inl.h"
#include "lib/cell_groups.h"
#include "lib/collide_cell.h"
#include "lib/normal.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR

/// Cells of a row from pixel i on with a triangle that a collider may have met. Sums of coordinates take the place of
/// ways, which are no longer.
/// @param least  [m] open_side() of the collider with the least
template <class D>
HWY_INLINE Mask<D> near_cells(D d, const Meeting& meeting, ClothState& state, size_t i, float least) {
  const size_t below = i + state.data.width;
  const auto corner = [&](size_t pixel) GEOCLOTH_LANES { return load(d, at(state.position, pixel)); };
  const Points<D> first = corner(i), right = corner(i + 1), low = corner(below), last = corner(below + 1);
  const auto squared = [&](const Points<D>& a, const Points<D>& b) GEOCLOTH_LANES {
    const Points<D> side = sub(b, a);
    return dot(d, side, side);
  };
  const auto sides =
      hn::Max(hn::Max(squared(first, right), squared(low, last)), hn::Max(squared(first, low), squared(right, last)));
  const auto longest =
      hn::Mul(hn::Sqrt(hn::Max(sides, hn::Max(squared(first, last), squared(right, low)))), hn::Set(d, 1.0001F));
  const hn::RebindToUnsigned<D> du;
  const auto triangles =
      hn::And(hn::LoadU(du, state.data.cell.data() + i), hn::Set(du, shader::kCellFirstBit | shader::kCellSecondBit));
  const auto has_any = hn::RebindMask(d, hn::Ne(triangles, hn::Zero(du)));
  const Mask<D> large = hn::And(has_any, hn::Ge(longest, hn::Set(d, least)));
  if (hn::AllFalse(d, large)) return large;
  auto way = hn::Zero(d);
  const auto see_way = [&](const Points<D>& point, size_t pixel) GEOCLOTH_LANES {
    way = hn::Max(way, at_most(d, sub(point, load(d, at(state.previous, pixel)))));
  };
  see_way(first, i);
  see_way(right, i + 1);
  see_way(low, below);
  see_way(last, below + 1);
  // Triangles are seen from their first corner, which is one of the upper two.
  const auto slack = hn::Add(hn::Add(way, way), hn::Add(longest, longest));
  Mask<D> any = hn::Gt(hn::Zero(d), hn::Zero(d));
  for (size_t c = 0; c < meeting.guards.count; ++c) {
    const auto open = hn::Ge(longest, hn::Set(d, shader::open_side(meeting.params, meeting.met.shapes[c])));
    any = hn::Or(any, hn::And(open, Guards::near(d, meeting.guards.guards[c], first, slack)));
  }
  return hn::And(any, large);
}

/// As many cells as a vector has lanes, no two of which share a pixel.
template <class D>
struct CellBatch {
  std::array<uint32_t, hn::MaxLanes(D())> pixel{};  ///< first corners
  uint32_t count = 0;
};

/// One triangle of each cell: pixels of its corners, and whether it is cloth.
template <class D>
struct TriangleBatch {
  std::array<int32_t, hn::MaxLanes(D())> a{}, b{}, c{};
  std::array<float, hn::MaxLanes(D())> is_cloth{};
};

template <class D>
HWY_INLINE void collide_batch(D d, const Meeting& meeting, ClothState& state, const TriangleBatch<D>& batch) {
  const hn::RebindToSigned<D> di;
  const auto a = hn::LoadU(di, batch.a.data()), b = hn::LoadU(di, batch.b.data()), c = hn::LoadU(di, batch.c.data());
  const auto gather = [&](Vec3Array& from, auto index) GEOCLOTH_LANES {
    return Points<D>{hn::GatherIndex(d, from.x.data(), index), hn::GatherIndex(d, from.y.data(), index),
                     hn::GatherIndex(d, from.z.data(), index)};
  };
  const float* const mass = state.inverse_mass.data();
  MovedTriangles<D> t{{gather(state.position, a), gather(state.position, b), gather(state.position, c)},
                      {gather(state.previous, a), gather(state.previous, b), gather(state.previous, c)},
                      {hn::GatherIndex(d, mass, a), hn::GatherIndex(d, mass, b), hn::GatherIndex(d, mass, c)}};
  const auto is_cloth = hn::Gt(hn::LoadU(d, batch.is_cloth.data()), hn::Zero(d));
  const Mask<D> moved = collide_triangles(d, meeting, is_cloth, t);
  if (hn::AllFalse(d, moved)) return;
  const auto scatter = [&](const Points<D>& now, const Points<D>& start, const auto& pixels) GEOCLOTH_LANES {
    std::array<std::array<float, hn::MaxLanes(D())>, 6> v;
    store(d, now, PointRow{v[0].data(), v[1].data(), v[2].data()});
    store(d, start, PointRow{v[3].data(), v[4].data(), v[5].data()});
    for_lanes(d, moved, [&](size_t k) {
      move_corner(meeting.params, state, static_cast<uint32_t>(pixels[k]), {v[0][k], v[1][k], v[2][k]},
                  {v[3][k], v[4][k], v[5][k]});
    });
  };
  scatter(t.now.a, t.start.a, batch.a);
  scatter(t.now.b, t.start.b, batch.b);
  scatter(t.now.c, t.start.c, batch.c);
}

/// The first triangles of some cells, then their second ones.
template <class D>
HWY_NOINLINE void collide_cell_batch(D d, const Meeting& meeting, ClothState& state, CellBatch<D>& cells) {
  for (const bool is_first : {true, false}) {
    TriangleBatch<D> batch;
    for (uint32_t k = 0; k < cells.count; ++k) {
      const CellTriangle t = triangle_of_cell(state, cells.pixel[k], is_first);
      batch.a[k] = static_cast<int32_t>(t.a);
      batch.b[k] = static_cast<int32_t>(t.b);
      batch.c[k] = static_cast<int32_t>(t.c);
      batch.is_cloth[k] = t.is_cloth ? 1.F : 0.F;
    }
    collide_batch(d, meeting, state, batch);
  }
  cells.count = 0;
}

template <class D>
HWY_NOINLINE void collide_cells(D d, const SweepFrame& frame, uint32_t substep, uint32_t group, RowRange rows) {
  const auto lanes = static_cast<uint32_t>(hn::Lanes(d));
  ClothState& state = *frame.state;
  const uint32_t width = state.data.width;
  const Meeting meeting(frame, substep);
  const uint32_t odd = shader::cell_corner(group, 0, 0).x;
  float least = std::numeric_limits<float>::max();
  for (const shader::ColliderShape& shape : meeting.met.shapes)
    least = std::min(least, shader::open_side(meeting.params, shape));
  CellBatch<D> batch;
  for (uint32_t row = rows.first; row < rows.last; ++row) {
    const uint32_t y = shader::cell_corner(group, 0, row).y;
    for (uint32_t first = 0; first + 1 < width; first += lanes) {
      for_lanes(d, near_cells(d, meeting, state, size_t{y} * width + first, least), [&](uint32_t lane) {
        if (lane % 2 != odd || first + lane + 1 >= width) return;
        batch.pixel[batch.count++] = y * width + first + lane;
        if (batch.count == lanes) collide_cell_batch(d, meeting, state, batch);
      });
    }
  }
  if (batch.count > 0) collide_cell_batch(d, meeting, state, batch);
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
