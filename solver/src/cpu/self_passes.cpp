// SPDX-License-Identifier: Apache-2.0
// Self-collision for the cpu: loads, stores and atomics around lib/self_collide.h. Threads put points into the buckets
// in any order; what is found does not depend on it.

#include "cpu/self_passes.h"

#include <algorithm>
#include <atomic>

#include "cpu/self_set.h"

namespace geocloth::cpu {
namespace {

using shader::kSelfHigh;
using shader::kSelfLow;
using shader::kSelfNone;
using shader::SelfRoom;
using shader::SelfSet;

constexpr uint32_t kSelfGrain = 1024;  ///< points that are worth a thread of their own

/// Calls body(point) for every point, or for every bucket.
template <class Body>
void for_each(const PassContext& context, uint32_t count, const Body& body) {
  context.threads.for_range(count, kSelfGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t i = first; i < last; ++i) body(i);
  });
}

template <class Better>
void raise(uint32_t& word, uint32_t value, const Better& better) {
  std::atomic_ref<uint32_t> atomic(word);
  uint32_t current = atomic.load(std::memory_order_relaxed);
  while (better(value, current) && !atomic.compare_exchange_weak(current, value, std::memory_order_relaxed)) {
  }
}

void widen(shader::uvec2& range, const shader::uvec2& other) {
  range = {std::min(range.x, other.x), std::max(range.y, other.y)};
}

}  // namespace

void self_drift(const PassContext& context, ClothState& state) {
  const SelfSet set{&state};
  const SelfRoom room = shader::self_room(context.cloth.params);
  context.threads.for_range(room.points, kSelfGrain, [&](uint32_t first, uint32_t last) {
    shader::SelfDrift all = shader::no_drift();
    for (uint32_t i = first; i < last; ++i) {
      const shader::SelfDrift own = shader::self_drift(set, room, i);
      widen(all.x, own.x);
      widen(all.y, own.y);
      widen(all.z, own.z);
    }
    uint32_t* const words = state.data.self.words.data();
    uint32_t axis = 0;
    for (const shader::uvec2& range : {all.x, all.y, all.z}) {
      raise(words[kSelfLow + axis], range.x, [](uint32_t a, uint32_t b) { return a < b; });
      raise(words[kSelfHigh + axis], range.y, [](uint32_t a, uint32_t b) { return a > b; });
      ++axis;
    }
  });
}

void self_clear(const PassContext& context, ClothState& state) {
  const SelfSet set{&state};
  const SelfRoom room = shader::self_room(context.cloth.params);
  if (!shader::self_is_stale(set, room)) return;
  for_each(context, room.buckets, [&](uint32_t bucket) {
    set_self_word(set, shader::self_head_word(room, bucket), kSelfNone);
    set_self_word(set, shader::self_filled_word(room, bucket), 0);
  });
}

void self_insert(const PassContext& context, ClothState& state) {
  const SelfSet set{&state};
  const SelfRoom room = shader::self_room(context.cloth.params);
  if (!shader::self_is_stale(set, room)) return;
  uint32_t* const words = state.data.self.words.data();
  for_each(context, room.points, [&](uint32_t point) {
    const shader::vec3 position = self_position(set, self_point(set, point).pixel);
    shader::set_self_vector(set, shader::self_seen_word(room, point), position);
    if (!shader::self_in_range(position)) return;
    const uint32_t bucket = shader::self_bucket(room, shader::self_cell(room, position));
    std::atomic_ref<uint32_t> head(words[shader::self_head_word(room, bucket)]);
    words[shader::self_next_word(room, point)] = head.exchange(point, std::memory_order_relaxed);
    std::atomic_ref<uint32_t>(words[shader::self_filled_word(room, bucket)]).fetch_add(1, std::memory_order_relaxed);
  });
}

void self_find(const PassContext& context, ClothState& state) {
  const SelfSet set{&state};
  const SelfRoom room = shader::self_room(context.cloth.params);
  if (!shader::self_is_stale(set, room)) return;
  for_each(context, room.points, [&](uint32_t point) { shader::self_find(set, room, point); });
}

void self_push(const PassContext& context, ClothState& state) {
  const SelfSet set{&state};
  const SelfRoom room = shader::self_room(context.cloth.params);
  for_each(context, room.points,
           [&](uint32_t point) { shader::set_self_push(set, room, point, shader::self_push(set, room, point)); });
}

void self_move(const PassContext& context, ClothState& state) {
  const SelfSet set{&state};
  const SelfRoom room = shader::self_room(context.cloth.params);
  for_each(context, static_cast<uint32_t>(state.pixel_count()), [&](uint32_t pixel) {
    if (pixel == 0) shader::self_begin(set, room);
    const uint32_t point = self_word(set, shader::self_point_word(pixel));
    if (point == kSelfNone || !shader::self_is_pushed(set, room, point)) return;
    state.set_point(pixel, shader::self_pushed(set, room, point, self_state(set, pixel)));
  });
}

}  // namespace geocloth::cpu
