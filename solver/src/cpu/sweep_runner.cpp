// SPDX-License-Identifier: Apache-2.0
// A cloth without seams goes through its substeps in one piece: each thread takes the next substep and follows the one
// before at the distance that the plan says, so any number of threads does the same operations in the same order for
// every pixel. Seams need all copies at once, so there the substep is made of several sweeps, and each thread has a
// band of rows: it leaves out what needs the neighbours', and when all are done, that is made up for (trapezoids and
// the triangles between them).

#include "cpu/sweep_runner.h"

#include <algorithm>
#include <chrono>
#include <numeric>

namespace geocloth::cpu {

void SweepRunner::prepare(const ClothState& state, const ClothFrame& cloth, const ScheduleOptions& options) {
  const shader::ClothParams& p = cloth.params;
  if (p.fine != shader::kFineOff) {  // offsets are not among what the kernels know
    plan_ = {};
    planned_ = false;
    return;
  }
  // What happens after the substeps, or in no frame at all, needs no other plan.
  ScheduleOptions of_substep = options;
  of_substep.asleep = of_substep.motion = false;
  of_substep.motion_word = 0;
  const Recipe recipe{of_substep, p.inverse_dt2, p.stretch_limit, p.share_structural, p.share_shear, p.share_bending};
  if (planned_ && !cloth.pins_changed && recipe == recipe_) return;
  recipe_ = recipe;
  planned_ = true;
  plan_ = SweepPlan::make(state, substep_schedule(options), cloth, runs_, options.relaxation_steps);
  bands_.clear();
}

void SweepRunner::cut_bands(const ClothState& state, uint32_t threads) {
  const uint32_t height = state.data.height, width = state.data.width;
  uint32_t least = 1;  // twice what the gaps at a band's sides take
  for (const SweepPlan::Part& part : plan_->parts()) {
    const auto* sweep = std::get_if<Sweep>(&part);
    if (sweep != nullptr) least = std::max(least, 2 * (sweep->last_lag + sweep->last_rise));
  }
  const uint32_t count = std::clamp(height / least, 1U, threads);
  std::vector<uint64_t> pixels(height + 1, 0);  // in the rows above
  for (const Run& run : runs_) pixels[run.first / width + 1] += run.last - run.first;
  std::partial_sum(pixels.begin(), pixels.end(), pixels.begin());
  bands_.assign(1, 0);
  for (uint32_t k = 1; k < count; ++k) {
    const auto row = std::lower_bound(pixels.begin(), pixels.end(), pixels.back() * k / count) - pixels.begin();
    bands_.push_back(std::clamp(static_cast<uint32_t>(row), bands_.back() + least, height - (count - k) * least));
  }
  bands_.push_back(height);
  shares_.clear();
  for (uint32_t k = 0; k < count; ++k) shares_.emplace_back(k, count);
}

void SweepRunner::run_in_bands(const SweepFrame& frame, const Threads& threads, const RunPass& pass) {
  const auto bands = static_cast<uint32_t>(bands_.size() - 1), substeps = static_cast<uint32_t>(contexts_.size());
  const std::vector<SweepPlan::Part>& parts = plan_->parts();
  const size_t phases = 2 * parts.size();  // of a substep: bands or shares of a pass, gaps
  const auto is_check = [](const PassStep& step) {
    return step.pass == Pass::check_copies || step.pass == Pass::check_colliders;
  };
  const auto tasks_of = [&](size_t phase) {
    const auto* step = std::get_if<PassStep>(&parts[phase / 2]);
    const bool gaps = phase % 2 == 1;
    if (step == nullptr) return bands - (gaps ? 1 : 0);
    return gaps ? 0 : is_check(*step) ? 1 : bands;
  };
  first_tasks_.assign(1, 0);
  for (size_t k = 0; k < phases * substeps; ++k) first_tasks_.push_back(first_tasks_.back() + tasks_of(k % phases));

  penetration_.assign(size_t{substeps} * bands, 0.F);
  const uint32_t height = frame.state->data.height;
  threads.for_phases(first_tasks_, bands, [&](size_t phase, uint32_t task) {
    const auto substep = static_cast<uint32_t>(phase / phases);
    const SweepPlan::Part& part = parts[phase % phases / 2];
    if (const auto* step = std::get_if<PassStep>(&part)) {
      const PassContext& all = contexts_[substep];
      const Threads& share = is_check(*step) ? alone_ : shares_[task];
      return pass(*step, {all.frame, all.cloth, share, substep, all.relaxation_steps});
    }
    const Sweep& sweep = std::get<Sweep>(part);
    SweepFrame own = frame;
    own.sweep = &sweep;
    own.penetration = &penetration_[size_t{task} * substeps];
    const uint32_t end = height + sweep.last_lag;
    SweepBand band{.first_time = bands_[task], .end_time = task + 1 < bands ? bands_[task + 1] : end};
    band.low = bands_[task];
    band.upper = task > 0;
    if (phase % 2 == 1) {
      const uint32_t row = bands_[task + 1];
      band = {.first_time = row, .end_time = std::min(end, row + sweep.last_lag + sweep.last_rise)};
      band.high = row;
      band.lower = true;
    }
    run_sweep(plan_->lanes(), own, substep, band, nullptr, nullptr);
  });
}

void SweepRunner::place_anchors(const ClothState& state) {
  const std::vector<shader::PinTarget>& pins = contexts_.front().cloth.pins;
  const std::vector<uint32_t>& anchor_of_pin = plan_->anchor_of_pin();
  const size_t count = anchor_of_pin.size();
  anchors_.resize(3 * count * contexts_.size() + plan_->lanes());  // vectors reach over the last one
  for (size_t k = 0; k < count; ++k) {
    shader::vec3 position = state.position.at(pins[k].pixel.x);
    for (size_t s = 0; s < contexts_.size(); ++s) {
      position = pinned_position(contexts_[s], pins[k], position, position);
      float* const of_substep = &anchors_[3 * count * s + anchor_of_pin[k]];
      of_substep[0] = position.x;
      of_substep[count] = position.y;
      of_substep[2 * count] = position.z;
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

  if (progress_.size() != contexts_.size()) progress_ = std::vector<Progress>(contexts_.size());
  for (Progress& p : progress_) p.done.store(0, std::memory_order_relaxed);
  // Substeps are taken in order, so the first unfinished one never waits for one that nobody has begun.
  std::atomic<uint32_t> next{first};
  const auto work = [&] {
    for (uint32_t s = next.fetch_add(1); s < last; s = next.fetch_add(1)) {
      run_sweep(plan_->lanes(), frame, s, whole_sweep(sweep, frame.state->data.height),
                s > first ? &progress_[s - 1] : nullptr, &progress_[s]);
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
                      const Threads& threads, ClothState& state, const Measuring& measuring, const RunPass& pass) {
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
                   static_cast<uint32_t>(plan_->anchor_of_pin().size()),
                   guards_.data(),
                   cloth.params.max_step > 0 || cloth.params.moving != 0,
                   std::all_of(frame.shapes.begin(), frame.shapes.end(), is_simple)};

  penetration_.assign(substeps, 0.F);
  sweep.penetration = penetration_.data();

  const std::vector<SweepPlan::Part>& parts = plan_->parts();
  if (parts.size() == 1 && std::holds_alternative<Sweep>(parts.front())) {
    run_substeps(sweep, std::get<Sweep>(parts.front()), 0, substeps, threads, measuring);
  } else if (threads.count() > 1 && measuring.seconds == nullptr) {
    if (bands_.empty()) cut_bands(state, threads.count());
    run_in_bands(sweep, threads, pass);
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
