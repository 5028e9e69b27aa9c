// SPDX-License-Identifier: Apache-2.0
// Self-collision for the cpu's vectors. Instead of chains in a hash, through which every point goes for itself, points
// are sorted by their cells: what may be near the few points of a cell lies in some pieces of a row of numbers. Cloth
// that touches nothing finds there only what is near along its own surface.

#include "cpu/self_runner.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>

#include "cpu/self_passes.h"
#include "cpu/sweep.h"

namespace geocloth::cpu {
namespace {

using shader::SelfRoom;
using shader::SelfSet;

constexpr uint32_t kPointGrain = 1024;  ///< points that are worth a thread of their own

constexpr PointGrid::Bounds no_bounds() {
  constexpr int32_t kLowest = std::numeric_limits<int32_t>::min(), kHighest = std::numeric_limits<int32_t>::max();
  return {{kHighest, kHighest, kHighest}, {kLowest, kLowest, kLowest}};
}

/// Vectors reach over the last point into what follows it among the words.
bool suits_vectors(const SelfData& points) {
  return vector_lanes() > 1 && points.points.size() >= vector_lanes();
}

void take_push(ClothState& state, const SelfSet& set, const SelfRoom& room, uint32_t pixel, uint32_t point) {
  state.set_point(pixel, self_pushed(set, room, point, state.point(pixel)));
}

}  // namespace

SelfRunner::SelfRunner(const SelfData& points, size_t pixels, bool vectors)
    : arrays_(vectors && suits_vectors(points) ? points.points.size() : 0), bounds_(no_bounds()) {
  if (pixels == 0 || arrays_.pushed.empty()) return;
  const auto count = static_cast<uint32_t>(points.points.size());
  for (uint32_t k = 0; k < count; ++k) {
    const uint32_t pixel = points.points[k].pixel;
    if (k == 0 || pixel != runs_.back().first_pixel + (k - runs_.back().first_point)) runs_.push_back({k, pixel});
  }
  runs_.push_back({count, 0});
  for (uint32_t pixel = 0; pixel < pixels; ++pixel) {
    const uint32_t point = points.words[shader::self_point_word(pixel)];
    if (point != shader::kSelfNone && points.points[point].pixel != pixel) copies_.push_back({point, pixel});
  }
  std::sort(copies_.begin(), copies_.end(), [](const Copy& a, const Copy& b) { return a.point < b.point; });
}

void SelfRunner::run(Pass pass, const PassContext& context, ClothState& state) {
  if (arrays_.pushed.empty()) return run_self_pass(pass, context, state);
  const SelfRoom room = shader::self_room(context.cloth.params);
  const SelfSet set{&state, &state.data.self, false};
  if (pass == Pass::self_move) return move(set, room, context.threads);
  run_in_vectors(pass, set, room, context.threads);
}

void SelfRunner::run_between(Pass pass, const shader::ClothParams& params, const Threads& threads, SelfData& points) {
  if (arrays_.pushed.empty()) return run_inter_pass(pass, params, threads, points);
  run_in_vectors(pass, {nullptr, &points, true}, shader::self_room(params), threads);
}

void SelfRunner::run_in_vectors(Pass pass, const SelfSet& set, const SelfRoom& room, const Threads& threads) {
  switch (pass) {
    case Pass::self_drift:
    case Pass::inter_drift:
      return drift(set, room, threads);
    case Pass::self_clear:
    case Pass::inter_clear:
      return see(set, room, threads);
    case Pass::self_insert:
    case Pass::inter_insert:
      return threads.for_range(1, 1, [&](uint32_t, uint32_t) { sort(set, room); });
    case Pass::self_find:
    case Pass::inter_find:
      return find(set, room, threads);
    default:
      return push(set, room, threads);
  }
}

/// Positions in this substep.
void SelfRunner::fetch(const SelfSet& set, const SelfRoom& room, uint32_t first, uint32_t last) {
  Vec3Array& to = arrays_.position;
  if (set.between) {
    for (uint32_t k = first; k < last; ++k) to.set(k, self_position(set, room, k));
    return;
  }
  const Vec3Array& from = set.cloth->position;
  auto run = std::upper_bound(runs_.begin(), runs_.end(), first,
                              [](uint32_t point, const PixelRun& r) { return point < r.first_point; });
  for (--run; first < last; ++run) {
    const uint32_t end = std::min(last, run[1].first_point), pixel = run->first_pixel + (first - run->first_point);
    std::copy_n(&from.x[pixel], end - first, &to.x[first]);
    std::copy_n(&from.y[pixel], end - first, &to.y[first]);
    std::copy_n(&from.z[pixel], end - first, &to.z[first]);
    first = end;
  }
}

void SelfRunner::drift(const SelfSet& set, const SelfRoom& room, const Threads& threads) {
  threads.for_range(room.points, kPointGrain, [&](uint32_t first, uint32_t last) {
    fetch(set, room, first, last);
    shader::SelfDrift all = shader::no_drift();
    run_self_drift(arrays_, set, room, first, last, all);
    widen_drift(set, all);
  });
}

void SelfRunner::see(const SelfSet& set, const SelfRoom& room, const Threads& threads) {
  if (!self_is_stale(set, room)) return;
  threads.for_range(room.points, kPointGrain, [&](uint32_t first, uint32_t last) {
    PointGrid::Bounds own = no_bounds();
    run_self_cells(arrays_, set, room, first, last, own);
    for (size_t axis = 0; axis < 3; ++axis) {
      improve(bounds_.low[axis], own.low[axis], std::less<>());
      improve(bounds_.high[axis], own.high[axis], std::greater<>());
    }
  });
}

void SelfRunner::sort(const SelfSet& set, const SelfRoom& room) {
  if (!self_is_stale(set, room)) return;
  in_grid_ = arrays_.grid.sort(set, room, arrays_.cells, bounds_, arrays_.position);
  bounds_ = no_bounds();
  if (in_grid_) return;
  const Threads alone(1);
  for (const Pass pass : {Pass::self_clear, Pass::self_insert}) run_over_points(pass, set, room, alone);
}

void SelfRunner::find(const SelfSet& set, const SelfRoom& room, const Threads& threads) const {
  if (!self_is_stale(set, room)) return;
  if (!in_grid_) return run_over_points(Pass::self_find, set, room, threads);
  const PointGrid& grid = arrays_.grid;
  threads.for_range(grid.point_count(), kPointGrain, [&](uint32_t first, uint32_t last) {
    run_self_find(arrays_, set, room, grid.cell_from(first), grid.cell_from(last));
  });
}

void SelfRunner::push(const SelfSet& set, const SelfRoom& room, const Threads& threads) {
  threads.for_range(room.points, kPointGrain, [&](uint32_t first, uint32_t last) {
    if (first == 0) shader::self_begin(set, room);
    run_self_push(arrays_, set, room, first, last);
  });
}

void SelfRunner::move(const SelfSet& set, const SelfRoom& room, const Threads& threads) const {
  ClothState& state = *set.cloth;
  threads.for_range(room.points, kPointGrain, [&](uint32_t first, uint32_t last) {
    auto copy = std::lower_bound(copies_.begin(), copies_.end(), first,
                                 [](const Copy& c, uint32_t point) { return c.point < point; });
    for (uint32_t point = first; point < last; ++point) {
      uint64_t eight = 1;
      if (point + 8 <= last) std::memcpy(&eight, &arrays_.pushed[point], sizeof eight);
      if (eight == 0) {
        point += 7;
        continue;
      }
      if (arrays_.pushed[point] == 0) continue;
      take_push(state, set, room, self_point(set, point).pixel, point);
      while (copy != copies_.end() && copy->point < point) ++copy;
      for (; copy != copies_.end() && copy->point == point; ++copy) take_push(state, set, room, copy->pixel, point);
    }
  });
}

void SelfRunner::move_part(const InterPart& part, const PassContext& context, ClothState& state,
                           SelfData& points) const {
  if (arrays_.pushed.empty()) return inter_move(part, context, state, points);
  const SelfSet set{&state, &points, true};
  const SelfRoom room = shader::inter_room(context.cloth.params);
  context.threads.for_range(part.pixels, kPointGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t k = first; k < last; ++k) {
      const uint32_t word = shader::inter_pixel_word(room, part.first_pixel + k);
      const uint32_t point = self_word(set, word + 1);
      if (arrays_.pushed[point] != 0) take_push(state, set, room, self_word(set, word), point);
    }
  });
}

size_t SelfRunner::memory_bytes() const {
  const auto bytes = [](const auto& values) { return values.capacity() * sizeof(values.front()); };
  return 3 * bytes(arrays_.position.x) + 3 * bytes(arrays_.cells.x) + bytes(arrays_.pushed) +
         arrays_.grid.memory_bytes() + bytes(runs_) + bytes(copies_);
}

}  // namespace geocloth::cpu
