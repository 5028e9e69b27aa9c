// SPDX-License-Identifier: Apache-2.0
// A cloth without seams goes through its substeps in one piece: each thread takes the next substep and follows the one
// before at the distance that the plan says, so any number of threads does the same operations in the same order for
// every pixel. Seams need all copies at once, so there the substep is made of several sweeps.

#include "cpu/sweep_runner.h"

#include <algorithm>

namespace geocloth::cpu {

void SweepRunner::prepare(const ClothState& state, const ClothFrame& cloth, const ScheduleOptions& options) {
  const shader::ClothParams& p = cloth.params;
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
      position = pinned_position(contexts_[s], static_cast<uint32_t>(k), position);
      float* const of_substep = &anchors_[3 * count * s];
      of_substep[k] = position.x;
      of_substep[count + k] = position.y;
      of_substep[2 * count + k] = position.z;
    }
  }
}

void SweepRunner::run_side_by_side(const SweepFrame& sweep, uint32_t substeps, const Threads& threads) {
  if (progress_.size() != substeps) progress_ = std::vector<std::atomic<uint32_t>>(substeps);
  for (std::atomic<uint32_t>& p : progress_) p.store(0, std::memory_order_relaxed);
  // Substeps are taken in order, so the first unfinished one never waits for one that nobody has begun.
  std::atomic<uint32_t> next{0};
  threads.for_each_thread(substeps, [&] {
    for (uint32_t s = next.fetch_add(1); s < substeps; s = next.fetch_add(1)) {
      run_sweep(plan_->lanes(), sweep, s, s > 0 ? &progress_[s - 1] : nullptr, &progress_[s]);
    }
  });
}

void SweepRunner::normals(const Threads& threads, ClothState& state) const {
  constexpr uint32_t kRunGrain = 32;
  threads.for_range(static_cast<uint32_t>(runs_.size()), kRunGrain, [&](uint32_t first, uint32_t last) {
    run_normals(vector_lanes(), state, std::span(runs_).subspan(first, last - first));
  });
}

bool SweepRunner::run(const FrameInput& frame, const ClothFrame& cloth, const ScheduleOptions& options,
                      const Threads& threads, ClothState& state,
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

  const std::vector<SweepPlan::Part>& parts = plan_->parts();
  if (parts.size() == 1 && std::holds_alternative<Sweep>(parts.front())) {
    sweep.sweep = &std::get<Sweep>(parts.front());
    run_side_by_side(sweep, substeps, threads);
    return true;
  }
  for (uint32_t s = 0; s < substeps; ++s) {
    for (const SweepPlan::Part& part : parts) {
      if (const auto* step = std::get_if<PassStep>(&part)) {
        pass(*step, contexts_[s]);
      } else {
        sweep.sweep = &std::get<Sweep>(part);
        run_sweep(plan_->lanes(), sweep, s, nullptr, nullptr);
      }
    }
  }
  return true;
}

}  // namespace geocloth::cpu
