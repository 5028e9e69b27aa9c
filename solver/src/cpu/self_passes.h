// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

#include "cpu/passes.h"
#include "cpu/self_set.h"

namespace geocloth::cpu {

/// Sets a number that other threads set, too, to a better one.
template <class T, class Better>
void improve(T& number, T value, const Better& better) {
  std::atomic_ref<T> atomic(number);
  T current = atomic.load(std::memory_order_relaxed);
  while (better(value, current) && !atomic.compare_exchange_weak(current, value, std::memory_order_relaxed)) {
  }
}
/// Takes the way of some points into that of all.
void widen_drift(const shader::SelfSet& set, const shader::SelfDrift& drift);

/// One of the passes self_drift .. self_push, or inter_drift .. inter_push, point by point.
void run_over_points(Pass pass, const shader::SelfSet& set, const shader::SelfRoom& room, const Threads& threads);
/// One of the passes self_drift .. self_move of a cloth; see pass.h.
void run_self_pass(Pass pass, const PassContext& context, ClothState& state);

/// One of the passes inter_drift .. inter_push over the points of all cloths that collide with each other.
void run_inter_pass(Pass pass, const shader::ClothParams& params, const Threads& threads, SelfData& points);
/// The passes inter_gather and inter_move of one of these cloths.
/// @param part  its points and pixels
void inter_gather(const InterPart& part, const PassContext& context, ClothState& state, SelfData& points);
void inter_move(const InterPart& part, const PassContext& context, ClothState& state, SelfData& points);

}  // namespace geocloth::cpu
