// SPDX-License-Identifier: Apache-2.0
// A cloth without seams goes through its substeps in one piece: each thread takes the next substep and follows the one
// before at the distance that the plan says, so any number of threads does the same operations in the same order for
// every pixel. Seams need all copies at once, so there the substep is made of several sweeps.

#include "cpu/sweep_runner.h"

#include <algorithm>
#include <chrono>
#include <numeric>

namespace geocloth::cpu {

void SweepRunner::prepare(const ClothState& state, const ClothFrame& cloth, const ScheduleOptions& options) {
  const shader::ClothParams& p = cloth.params;
  const auto is_soft = [](const shader::PinTarget& pin) { return pin.target.w > 0; };
  if (p.moving != 0 || p.fine != shader::kFineOff ||
      std::any_of(cloth.pins.begin(), cloth.pins.end(), is_soft)) {  // not among the sweep's passes
    plan_ = {};
    planned_ = false;
    return;
  }
  const Recipe recipe{options, p.inverse_dt2, p.stretch_limit, p.share_structural, p.share_shear, p.share_bending};
  if (planned_ && !cloth.pins_changed && recipe == recipe_) return;
  recipe_ = recipe;
  planned_ = true;
  plan_ = SweepPlan::make(state, substep_schedule(options), cloth, runs_, options.relaxation_steps);
}

void SweepRunner::place_anchors(const ClothState& state) {
  const std::vector<shader::PinTarget>& pins = contexts_.front().cloth.pins;
  const size_t count = pins.size();
  anchors_.resize(3 * count * contexts_.size());
  for (size_t k = 0; k < count; ++k) {
    shader::vec3 position = state.position.at(pins[k].pixel.x);
    for (size_t s = 0; s < contexts_.size(); ++s) {
      position = pinned_position(contexts_[s], pins[k], position, position);
      float* const of_substep = &anchors_[3 * count * s];
      of_substep[k] = position.x;
      of_substep[count + k] = position.y;
      of_substep[2 * count + k] = position.z;
    }
  }
}

void SweepRunner::run_substeps(SweepFrame& frame, const Sweep& sweep, uint32_t first, uint32_t last,
                               const Threads& threads, const Measuring& measuring) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  frame.sweep = &sweep;
  if (measuring.seconds != nullptr) seconds_.assign(contexts_.size() * sweep.ops.size(), 0.0);
  frame.seconds = measuring.seconds != nullptr ? seconds_.data() : nullptr;

  if (progress_.size() != contexts_.size()) progress_ = std::vector<std::atomic<uint32_t>>(contexts_.size());
  for (std::atomic<uint32_t>& p : progress_) p.store(0, std::memory_order_relaxed);
  // Substeps are taken in order, so the first unfinished one never waits for one that nobody has begun.
  std::atomic<uint32_t> next{first};
  const auto work = [&] {
    for (uint32_t s = next.fetch_add(1); s < last; s = next.fetch_add(1)) {
      run_sweep(plan_->lanes(), frame, s, s > first ? &progress_[s - 1] : nullptr, &progress_[s]);
    }
  };
  threads.for_each_thread(last - first, work);

  if (measuring.seconds == nullptr) return;
  const double sampled = std::accumulate(seconds_.begin(), seconds_.end(), 0.0);
  const double all = std::chrono::duration<double>(Clock::now() - start).count();
  for (size_t k = 0; k < seconds_.size(); ++k) {
    (*measuring.seconds)[static_cast<size_t>(sweep.ops[k % sweep.ops.size()].pass)] += all * seconds_[k] / sampled;
  }
}

void SweepRunner::normals(const Threads& threads, ClothState& state) const {
  constexpr uint32_t kRunGrain = 32;
  threads.for_range(static_cast<uint32_t>(runs_.size()), kRunGrain, [&](uint32_t first, uint32_t last) {
    run_normals(vector_lanes(), state, std::span(runs_).subspan(first, last - first));
  });
}

bool SweepRunner::run(const FrameInput& frame, const ClothFrame& cloth, const ScheduleOptions& options,
                      const Threads& threads, ClothState& state, const Measuring& measuring,
                      const std::function<void(const PassStep&, const PassContext&)>& pass) {
  prepare(state, cloth, options);
  if (!plan_) return false;
  const auto substeps = static_cast<uint32_t>(frame.substeps.size());
  contexts_.clear();
  for (uint32_t s = 0; s < substeps; ++s) contexts_.push_back({frame, cloth, threads, s, options.relaxation_steps});
  place_anchors(state);
  guard_colliders(frame, cloth.params, guards_);
  SweepFrame sweep{contexts_.data(),
                   &state,
                   nullptr,
                   anchors_.data(),
                   static_cast<uint32_t>(cloth.pins.size()),
                   guards_.data(),
                   cloth.params.max_step > 0,
                   std::all_of(frame.shapes.begin(), frame.shapes.end(), is_simple)};

  penetration_.assign(substeps, 0.F);
  sweep.penetration = penetration_.data();

  const std::vector<SweepPlan::Part>& parts = plan_->parts();
  if (parts.size() == 1 && std::holds_alternative<Sweep>(parts.front())) {
    run_substeps(sweep, std::get<Sweep>(parts.front()), 0, substeps, threads, measuring);
  } else {
    for (uint32_t s = 0; s < substeps; ++s) {
      for (const SweepPlan::Part& part : parts) {
        if (const auto* step = std::get_if<PassStep>(&part)) {
          pass(*step, contexts_[s]);
        } else {
          run_substeps(sweep, std::get<Sweep>(part), s, s + 1, threads, measuring);
        }
      }
    }
  }
  for (const float depth : penetration_) {
    measuring.measures->penetration = std::max(measuring.measures->penetration, depth);
  }
  return true;
}

}  // namespace geocloth::cpu
