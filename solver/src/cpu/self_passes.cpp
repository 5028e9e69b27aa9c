// SPDX-License-Identifier: Apache-2.0
// Self-collision and collision between cloths for the cpu: loads, stores and atomics around lib/self_collide.h. Threads
// put points into the buckets in any order; what is found does not depend on it.

#include "cpu/self_passes.h"

#include <algorithm>
#include <atomic>
#include <functional>

#include "cpu/self_set.h"

namespace geocloth::cpu {
namespace {

using shader::kSelfHigh;
using shader::kSelfLow;
using shader::kSelfNone;
using shader::SelfRoom;
using shader::SelfSet;

constexpr uint32_t kSelfGrain = 1024;  ///< points that are worth a thread of their own

/// Points with their numbers, and who shares them out.
struct SelfWork {
  SelfSet set;
  SelfRoom room;
  const Threads& threads;

  /// Calls body(point) for every point, or for every bucket.
  template <class Body>
  void for_each(uint32_t count, const Body& body) const {
    threads.for_range(count, kSelfGrain, [&](uint32_t first, uint32_t last) {
      for (uint32_t i = first; i < last; ++i) body(i);
    });
  }
};

void widen(shader::uvec2& range, const shader::uvec2& other) {
  range = {std::min(range.x, other.x), std::max(range.y, other.y)};
}

void drift(const SelfWork& work) {
  const SelfSet& set = work.set;
  const SelfRoom& room = work.room;
  work.threads.for_range(room.points, kSelfGrain, [&](uint32_t first, uint32_t last) {
    shader::SelfDrift all = shader::no_drift();
    for (uint32_t i = first; i < last; ++i) {
      const shader::SelfDrift own = shader::self_drift(set, room, i);
      widen(all.x, own.x);
      widen(all.y, own.y);
      widen(all.z, own.z);
    }
    widen_drift(set, all);
  });
}

void clear(const SelfWork& work) {
  const SelfSet& set = work.set;
  const SelfRoom& room = work.room;
  if (!shader::self_is_stale(set, room)) return;
  work.for_each(room.buckets, [&](uint32_t bucket) {
    set_self_word(set, shader::self_head_word(room, bucket), kSelfNone);
    set_self_word(set, shader::self_filled_word(room, bucket), 0);
  });
}

void insert(const SelfWork& work) {
  const SelfSet& set = work.set;
  const SelfRoom& room = work.room;
  if (!shader::self_is_stale(set, room)) return;
  uint32_t* const words = set.data->words.data();
  work.for_each(room.points, [&](uint32_t point) {
    const shader::vec3 position = self_position(set, room, point);
    shader::set_self_vector(set, shader::self_seen_word(room, point), position);
    if (!shader::self_in_range(position)) return;
    const shader::SelfCell cell = shader::self_cell(room, position);
    const uint32_t layer = shader::self_layer(set, self_point(set, point));
    const uint32_t bucket = shader::self_hash(room, cell, layer);
    std::atomic_ref<uint32_t> head(words[shader::self_head_word(room, bucket)]);
    words[shader::self_next_word(room, point)] = head.exchange(point, std::memory_order_relaxed);
    std::atomic_ref<uint32_t> filled(words[shader::self_filled_word(room, shader::self_hash(room, cell, 0))]);
    filled.fetch_add(shader::kSelfBucketPoint, std::memory_order_relaxed);
    filled.fetch_or(1U << layer, std::memory_order_relaxed);
  });
}

void find(const SelfWork& work) {
  const SelfSet& set = work.set;
  const SelfRoom& room = work.room;
  if (!shader::self_is_stale(set, room)) return;
  work.for_each(room.points, [&](uint32_t point) { shader::self_find(set, room, point); });
}

void push(const SelfWork& work) {
  const SelfSet& set = work.set;
  const SelfRoom& room = work.room;
  work.for_each(room.points, [&](uint32_t point) {
    if (point == 0) shader::self_begin(set, room);
    shader::set_self_push(set, room, point, shader::self_push(set, room, point));
  });
}

/// Takes the push on its point.
void move_pixel(ClothState& state, const SelfSet& set, const SelfRoom& room, uint32_t pixel, uint32_t point) {
  if (!shader::self_is_pushed(set, room, point)) return;
  state.set_point(pixel, shader::self_pushed(set, room, point, state.point(pixel)));
}

void move(const SelfWork& work) {
  ClothState& state = *work.set.cloth;
  work.for_each(static_cast<uint32_t>(state.pixel_count()), [&](uint32_t pixel) {
    const uint32_t point = self_word(work.set, shader::self_point_word(pixel));
    if (point != kSelfNone) move_pixel(state, work.set, work.room, pixel, point);
  });
}

}  // namespace

void widen_drift(const SelfSet& set, const shader::SelfDrift& drift) {
  uint32_t* const words = set.data->words.data();
  uint32_t axis = 0;
  for (const shader::uvec2& range : {drift.x, drift.y, drift.z}) {
    improve(words[kSelfLow + axis], range.x, std::less<>());
    improve(words[kSelfHigh + axis], range.y, std::greater<>());
    ++axis;
  }
}

/// Those between cloths are the same over the points of all.
void run_over_points(Pass pass, const SelfSet& set, const SelfRoom& room, const Threads& threads) {
  const SelfWork work{set, room, threads};
  switch (pass) {
    case Pass::self_drift:
    case Pass::inter_drift:
      return drift(work);
    case Pass::self_clear:
    case Pass::inter_clear:
      return clear(work);
    case Pass::self_insert:
    case Pass::inter_insert:
      return insert(work);
    case Pass::self_find:
    case Pass::inter_find:
      return find(work);
    case Pass::self_push:
    case Pass::inter_push:
      return push(work);
    default:
      return move(work);
  }
}

void run_self_pass(Pass pass, const PassContext& context, ClothState& state) {
  run_over_points(pass, {&state, &state.data.self, false}, shader::self_room(context.cloth.params), context.threads);
}

void run_inter_pass(Pass pass, const shader::ClothParams& params, const Threads& threads, SelfData& points) {
  run_over_points(pass, {nullptr, &points, true}, shader::self_room(params), threads);
}

void inter_gather(const InterPart& part, const PassContext& context, ClothState& state, SelfData& points) {
  const SelfWork work{{&state, &points, true}, shader::inter_room(context.cloth.params), context.threads};
  work.for_each(part.points, [&](uint32_t k) {
    const uint32_t point = part.first_point + k, pixel = self_point(work.set, point).pixel;
    shader::gather_state(work.set, work.room, point, state.point(pixel), state.inverse_mass[pixel] == 0);
  });
}

void inter_move(const InterPart& part, const PassContext& context, ClothState& state, SelfData& points) {
  const SelfWork work{{&state, &points, true}, shader::inter_room(context.cloth.params), context.threads};
  work.for_each(part.pixels, [&](uint32_t k) {
    const uint32_t word = shader::inter_pixel_word(work.room, part.first_pixel + k);
    move_pixel(state, work.set, work.room, self_word(work.set, word), self_word(work.set, word + 1));
  });
}

}  // namespace geocloth::cpu
