// SPDX-License-Identifier: Apache-2.0
// The passes of shaders/lib in vectors, for every instruction set that Highway knows; the best one is chosen when the
// program runs. Each operation is the one that the shared text names, in its order, so that the bits are the same.
#include <chrono>

#include "cpu/sweep.h"
#include "vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "cpu/sweep_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "cpu/bends_inl.h"
#include "cpu/cells_inl.h"
#include "cpu/collide_inl.h"
#include "cpu/constraints_inl.h"
#include "cpu/finish_inl.h"
#include "cpu/lines_inl.h"
#include "cpu/normals_inl.h"
#include "cpu/pins_inl.h"
#include "cpu/predict_inl.h"
#include "cpu/self_inl.h"

HWY_BEFORE_NAMESPACE();
namespace geocloth::cpu::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR  // no vectors: nothing is planned for one lane, the plain path runs

void run_sweep_here(uint32_t, const SweepFrame&, uint32_t, const SweepBand&) {}
void run_normals_here(uint32_t, ClothState& state, std::span<const Run> runs) {
  for (const Run& run : runs) normal_pixels(state, run.first, run.last);
}
void run_cells_here(uint32_t, const SweepFrame&, uint32_t, uint32_t, RowRange) {}
void run_lines_here(uint32_t, ClothState&, const LineStream&, uint32_t, uint32_t, uint32_t, float*) {}
void self_drift_here(SelfArrays&, const shader::SelfSet&, const shader::SelfRoom&, uint32_t, uint32_t,
                     shader::SelfDrift&) {}
void self_cells_here(SelfArrays&, const shader::SelfSet&, const shader::SelfRoom&, uint32_t, uint32_t,
                     PointGrid::Bounds&) {}
void self_find_here(const SelfArrays&, const shader::SelfSet&, const shader::SelfRoom&, uint32_t, uint32_t) {}
void self_push_here(SelfArrays&, const shader::SelfSet&, const shader::SelfRoom&, uint32_t, uint32_t) {}
uint32_t lanes_here() {
  return 1;
}

#else

template <class T, bool kAnyYields>
struct Chosen {
  using Type = T;
  static constexpr bool kYields = kAnyYields;
};
/// Calls body(Chosen<SpringKind<...>, ...>()). The kernel makes its own: to hand one over goes through memory, in
/// pieces that are read as a whole.
template <bool kYields, class Body>
HWY_INLINE void with_kind(const SweepOp& op, const Body& body) {
  const bool several = op.multipliers != nullptr;
  if (op.on_offsets) {
    return several ? body(Chosen<SpringKind<true, false, false, true>, kYields>())
                   : body(Chosen<SpringKind<false, false, false, true>, kYields>());
  }
  if (several) return body(Chosen<SpringKind<true, false, false>, kYields>());
  if (op.share == 1) return body(Chosen<SpringKind<false, true, false>, kYields>());
  body(Chosen<SpringKind<false, false, false>, kYields>());
}
template <class Body>
HWY_INLINE void with_kind(const SweepOp& op, bool yields, const Body& body) {
  yields ? with_kind<true>(op, body) : with_kind<false>(op, body);
}
template <bool kOnOffsets>
using Pulls = SpringKind<false, true, true, kOnOffsets>;

template <class D>
HWY_INLINE void pull_across(D d, const SweepOp& op, ClothState& state, bool yields, uint32_t first, uint32_t last) {
  if (op.on_offsets) {
    yields ? springs_across<Pulls<true>, true>(d, op, state, first, last)
           : springs_across<Pulls<true>, false>(d, op, state, first, last);
  } else {
    yields ? springs_across<Pulls<false>, true>(d, op, state, first, last)
           : springs_across<Pulls<false>, false>(d, op, state, first, last);
  }
}

template <bool kSeveral, class D>
HWY_INLINE void bend_across(D d, const SweepOp& op, ClothState& state, bool yields, uint32_t first, uint32_t last) {
  if (op.on_offsets) {
    yields ? bends_across<kSeveral, true, true>(d, op, state, first, last)
           : bends_across<kSeveral, false, true>(d, op, state, first, last);
  } else {
    yields ? bends_across<kSeveral, true, false>(d, op, state, first, last)
           : bends_across<kSeveral, false, false>(d, op, state, first, last);
  }
}
template <bool kSeveral, class D>
HWY_INLINE void bend_along(D d, const SweepOp& op, ClothState& state, bool yields, const SweepFrame& frame,
                           const RowRange& rows) {
  op.on_offsets ? bends_along<kSeveral, true>(d, op, state, yields, frame, rows)
                : bends_along<kSeveral, false>(d, op, state, yields, frame, rows);
}

template <bool kOnOffsets, class D>
HWY_INLINE void predict_or_fall(D d, const PassContext& context, ClothState& state, std::span<const Run> runs) {
  const bool forces = context.cloth.params.air != 0 || context.cloth.params.moving != 0;
  forces ? predict<true, kOnOffsets>(d, context, state, runs) : predict<false, kOnOffsets>(d, context, state, runs);
}

template <class D>
HWY_INLINE void run_turn(D d, const SweepFrame& frame, uint32_t substep, const SweepTurn& turn) {
  ClothState& state = *frame.state;
  const SweepOp& op = frame.sweep->ops[turn.op];
  const RowStream& stream = *op.stream;
  const RowRange& rows = turn.rows;
  const uint32_t first = turn.first, last = turn.last;
  const bool several = op.multipliers != nullptr;  // relaxation steps
  const auto runs = [&] { return std::span(stream.runs).subspan(first, last - first); };
  const auto yields = [&] { return state.yields_in(rows.first, rows.last + op.down); };
  switch (op.kernel) {
    case RowKernel::normals:
      normals(d, state, runs());
      break;
    case RowKernel::predict: {
      const PassContext& context = frame.contexts[substep];
      op.on_offsets ? predict_or_fall<true>(d, context, state, runs())
                    : predict_or_fall<false>(d, context, state, runs());
      break;
    }
    case RowKernel::pins:
      op.on_offsets ? pins<true>(d, frame, substep, stream.runs, first, last)
                    : pins<false>(d, frame, substep, stream.runs, first, last);
      break;
    case RowKernel::springs_across:
      with_kind(op, yields(), [&](auto kind) GEOCLOTH_LANES {
        using Kind = decltype(kind);
        springs_across<typename Kind::Type, Kind::kYields>(d, op, state, first, last);
      });
      break;
    case RowKernel::springs_along:
      with_kind(op, yields(), [&](auto kind) GEOCLOTH_LANES {
        using Kind = decltype(kind);
        springs_along<1, typename Kind::Type, Kind::kYields>(d, op, state, first, last);
      });
      break;
    case RowKernel::springs_along_two:
      with_kind(op, yields(), [&](auto kind) GEOCLOTH_LANES {
        using Kind = decltype(kind);
        springs_along<2, typename Kind::Type, Kind::kYields>(d, op, state, first, last);
      });
      break;
    case RowKernel::spans_along:  // half of the columns are the other ends
      pull_across(hn::CappedTag<float, HWY_MIN(kSpanLanes, hn::MaxLanes(D()))>(), op, state, yields(), first, last);
      break;
    case RowKernel::ties_across:
      pull_across(d, op, state, yields(), first, last);
      break;
    case RowKernel::ties_along:
      yields() ? springs_along<1, Pulls<false>, true>(d, op, state, first, last)
               : springs_along<1, Pulls<false>, false>(d, op, state, first, last);
      break;
    case RowKernel::short_spans_along:
      pull_across(hn::CappedTag<float, kShortSpanLanes>(), op, state, yields(), first, last);
      break;
    case RowKernel::bends_across:
      several ? bend_across<true>(d, op, state, yields(), first, last)
              : bend_across<false>(d, op, state, yields(), first, last);
      break;
    case RowKernel::bends_along:
      several ? bend_along<true>(d, op, state, yields(), frame, rows)
              : bend_along<false>(d, op, state, yields(), frame, rows);
      break;
    case RowKernel::limit: {
      const float* const anchors = frame.anchors + size_t{3} * frame.anchor_line * substep;
      const bool beside = std::find(stream.beside.begin() + rows.first, stream.beside.begin() + rows.last, 0) ==
                          stream.beside.begin() + rows.last;
      beside ? limit<AnchorsBeside>(d, op, state, anchors, frame.anchor_line, first, last)
             : limit<ChosenAnchors>(d, op, state, anchors, frame.anchor_line, first, last);
      break;
    }
    case RowKernel::settle:
      settle(d, state, runs());
      break;
    case RowKernel::collide:
      collide(d, frame, substep, runs());
      break;
    case RowKernel::hold_way:
      hold_way(d, state, runs());
      break;
    case RowKernel::give_way:
      give_way(d, frame, substep, runs());
      break;
    case RowKernel::check_colliders:
      check_colliders(d, frame, substep, runs());
      break;
  }
}

template <class D>
HWY_NOINLINE void time_turns(D d, const SweepFrame& frame, uint32_t substep, const SweepBand& band) {
  using Clock = std::chrono::steady_clock;
  auto start = Clock::now();
  for (const SweepTurn& turn : band.turns) {
    run_turn(d, frame, substep, turn);
    const auto end = Clock::now();
    frame.seconds[turn.op] += std::chrono::duration<double>(end - start).count();
    start = end;
  }
}

template <class D>
void run_turns(D d, const SweepFrame& frame, uint32_t substep, const SweepBand& band) {
  if (frame.seconds != nullptr) return time_turns(d, frame, substep, band);
  for (const SweepTurn& turn : band.turns) run_turn(d, frame, substep, turn);
}

/// Calls body(tag) with the tag of vectors of that many lanes.
template <class Body>
HWY_INLINE void with_lanes(uint32_t lanes, const Body& body) {
  const hn::ScalableTag<float> full;
  if (lanes == hn::Lanes(full)) return body(full);
  if (lanes == 8) return body(hn::CappedTag<float, 8>());
  body(hn::CappedTag<float, 4>());
}

void run_sweep_here(uint32_t lanes, const SweepFrame& frame, uint32_t substep, const SweepBand& band) {
  with_lanes(lanes, [&](auto d) GEOCLOTH_LANES { run_turns(d, frame, substep, band); });
}

void run_normals_here(uint32_t lanes, ClothState& state, std::span<const Run> runs) {
  with_lanes(lanes, [&](auto d) GEOCLOTH_LANES { normals(d, state, runs); });
}

void run_cells_here(uint32_t lanes, const SweepFrame& frame, uint32_t substep, uint32_t group, RowRange rows) {
  with_lanes(lanes, [&](auto d) GEOCLOTH_LANES { collide_cells(d, frame, substep, group, rows); });
}

void run_lines_here(uint32_t lanes, ClothState& state, const LineStream& stream, uint32_t group, uint32_t first,
                    uint32_t last, float* kept) {
  with_lanes(lanes, [&](auto d) GEOCLOTH_LANES {
    const auto blocks = std::span(stream.blocks).subspan(first, last - first);
    group == 0 ? lines_of<RowBlock>(d, stream, state, kept, blocks)
               : lines_of<ColumnBlock>(d, stream, state, kept, blocks);
  });
}

using AllOfVector = hn::ScalableTag<float>;
void self_drift_here(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                     uint32_t last, shader::SelfDrift& all) {
  self_drift(AllOfVector(), arrays, set, room, first, last, all);
}
void self_cells_here(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                     uint32_t last, PointGrid::Bounds& bounds) {
  self_cells(AllOfVector(), arrays, set, room, first, last, bounds);
}
void self_find_here(const SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room,
                    uint32_t first_cell, uint32_t last_cell) {
  self_find(AllOfVector(), arrays, set, room, first_cell, last_cell);
}
void self_push_here(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                    uint32_t last) {
  self_push(AllOfVector(), arrays, set, room, first, last);
}

uint32_t lanes_here() {
  return static_cast<uint32_t>(hn::Lanes(hn::ScalableTag<float>()));
}
#endif

const char* target_here() {
  return hwy::TargetName(HWY_TARGET);
}

}  // namespace geocloth::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geocloth::cpu {

HWY_EXPORT(run_sweep_here);
HWY_EXPORT(run_normals_here);
HWY_EXPORT(run_cells_here);
HWY_EXPORT(run_lines_here);
HWY_EXPORT(self_drift_here);
HWY_EXPORT(self_cells_here);
HWY_EXPORT(self_find_here);
HWY_EXPORT(self_push_here);
HWY_EXPORT(lanes_here);
HWY_EXPORT(target_here);

void run_sweep(uint32_t lanes, const SweepFrame& frame, uint32_t substep, const SweepBand& band) {
  HWY_DYNAMIC_DISPATCH(run_sweep_here)(lanes, frame, substep, band);
}
void run_normals(uint32_t lanes, ClothState& state, std::span<const Run> runs) {
  HWY_DYNAMIC_DISPATCH(run_normals_here)(lanes, state, runs);
}
void run_cells(uint32_t lanes, const SweepFrame& frame, uint32_t substep, uint32_t group, RowRange rows) {
  HWY_DYNAMIC_DISPATCH(run_cells_here)(lanes, frame, substep, group, rows);
}
void run_lines(uint32_t lanes, ClothState& state, const LineStream& stream, uint32_t group, uint32_t first,
               uint32_t last, float* kept) {
  HWY_DYNAMIC_DISPATCH(run_lines_here)(lanes, state, stream, group, first, last, kept);
}
void run_self_drift(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                    uint32_t last, shader::SelfDrift& all) {
  HWY_DYNAMIC_DISPATCH(self_drift_here)(arrays, set, room, first, last, all);
}
void run_self_cells(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                    uint32_t last, PointGrid::Bounds& bounds) {
  HWY_DYNAMIC_DISPATCH(self_cells_here)(arrays, set, room, first, last, bounds);
}
void run_self_find(const SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room,
                   uint32_t first_cell, uint32_t last_cell) {
  HWY_DYNAMIC_DISPATCH(self_find_here)(arrays, set, room, first_cell, last_cell);
}
void run_self_push(SelfArrays& arrays, const shader::SelfSet& set, const shader::SelfRoom& room, uint32_t first,
                   uint32_t last) {
  HWY_DYNAMIC_DISPATCH(self_push_here)(arrays, set, room, first, last);
}
uint32_t vector_lanes() {
  return HWY_DYNAMIC_DISPATCH(lanes_here)();
}
const char* vector_target() {
  return HWY_DYNAMIC_DISPATCH(target_here)();
}

}  // namespace geocloth::cpu
#endif
