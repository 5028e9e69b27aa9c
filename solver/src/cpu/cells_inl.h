// SPDX-License-Identifier: Apache-2.0
// Which cells a collider may reach, in vectors; those are done one by one by the shared text, lib/collide_cell.h.
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
    const auto open = hn::Ge(longest, hn::Set(d, shader::open_side(meeting.params, meeting.frame.shapes[c])));
    any = hn::Or(any, hn::And(open, Guards::near(d, meeting.guards.guards[c], first, slack)));
  }
  return hn::And(any, large);
}

template <class D>
HWY_NOINLINE void collide_cells(D d, const SweepFrame& frame, uint32_t substep, uint32_t group, uint32_t y) {
  const auto lanes = static_cast<uint32_t>(hn::Lanes(d));
  ClothState& state = *frame.state;
  const uint32_t width = state.data.width;
  const Meeting meeting(frame, substep);
  const uint32_t odd = shader::cell_corner(group, 0, 0).x;
  float least = std::numeric_limits<float>::max();
  for (const shader::ColliderShape& shape : meeting.frame.shapes)
    least = std::min(least, shader::open_side(meeting.params, shape));
  for (uint32_t first = 0; first + 1 < width; first += lanes) {
    std::array<uint8_t, 8> bits{};
    hn::StoreMaskBits(d, near_cells(d, meeting, state, size_t{y} * width + first, least), bits.data());
    for (uint32_t lane = odd; lane < lanes && first + lane + 1 < width; lane += 2) {
      if ((bits[lane / 8] >> lane % 8 & 1) != 0) collide_cell(frame.contexts[substep], state, first + lane, y);
    }
  }
}

#endif
}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
