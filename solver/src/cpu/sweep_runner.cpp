// SPDX-License-Identifier: Apache-2.0
// A cloth without seams goes through its substeps in one piece; seams need all copies at once, so there the substep is
// made of several sweeps. Each thread has a band of rows; see bands.cpp.

#include "cpu/sweep_runner.h"

#include <algorithm>

#include "cpu/collider_guards.h"
#include "cpu/pin_rows.h"
#include "lib/cell_groups.h"
#include "lib/fine.h"

namespace geocloth::cpu {
namespace {

constexpr uint32_t kCellRowGrain = 16;   ///< rows of cells that are worth a thread of their own
constexpr uint32_t kLineBlockGrain = 2;  ///< blocks of lines

}  // namespace

void SweepRunner::prepare(const ClothState& state, const ClothFrame& cloth, const ScheduleOptions& options,
                          uint32_t threads) {
  const shader::ClothParams& p = cloth.params;
  if (p.fine == shader::kFineMomentum) {  // the kernels do not know where springs were
    substep_ = {};
    second_half_ = {};
    finish_ = {};
    planned_ = false;
    return;
  }
  const Recipe recipe{options_of_substeps(options), threads,       p.inverse_dt2,  p.stretch_limit,
                      p.share_structural,           p.share_shear, p.share_bending};
  if (planned_ && !cloth.pins_changed && recipe == recipe_) return;
  recipe_ = recipe;
  planned_ = true;
  const auto plan = [&](const std::vector<PassStep>& steps, uint32_t relaxation_steps) {
    return Plan{pool_->share(SweepPlan::make(state, steps, cloth, runs_, relaxation_steps)), {}, {}, {}};
  };
  const SubstepHalves halves = substep_halves(options);
  substep_ = plan(halves.before, options.relaxation_steps);
  second_half_ = halves.after.empty() ? Plan{} : plan(halves.after, options.relaxation_steps);
  finish_ = options.ties ? plan(finish_schedule(options), 1) : Plan{};
  make_scratch(threads);
}

void SweepRunner::make_scratch(uint32_t threads) {
  scratch_length_ = 0;
  for (const Plan* plan : {&substep_, &second_half_, &finish_}) {
    if (!plan->sweeps) continue;
    for (const SweepPlan::Part& part : plan->sweeps->parts()) {
      const auto* sweep = std::get_if<Sweep>(&part);
      if (sweep != nullptr) scratch_length_ = std::max(scratch_length_, size_t{sweep->scratch});
    }
  }
  scratch_.assign(threads * scratch_length_, 0.F);
  size_t line_floats = 0;  // ranges of blocks begin anywhere, so each block has its own
  for (uint32_t group = 0; group < 2 && finish_.sweeps; ++group) {
    const LineStream& stream = finish_.sweeps->lines(group);
    const size_t blocks = threads > 1 ? stream.blocks.size() : std::min<size_t>(kLinesAtOnce, stream.blocks.size());
    line_floats = std::max(line_floats, blocks * line_kept(stream, finish_.sweeps->lanes()));
  }
  line_scratch_.assign(line_floats, 0.F);
}

void SweepRunner::forget() {
  for (Floats* values : {&scratch_, &line_scratch_, &anchors_, &pins_}) std::fill(values->begin(), values->end(), 0.F);
}

void SweepRunner::run_cell_rows(const SweepFrame& frame, const PassContext& context, uint32_t group) const {
  const uint32_t height = frame.state->data.height, odd = shader::cell_corner(group, 0, 0).y;
  const uint32_t rows = (height - odd) / 2;
  context.threads.for_range(rows, kCellRowGrain, [&](uint32_t first, uint32_t last) {
    run_cells(substep_.sweeps->lanes(), frame, context.substep, group, {first, last});
  });
}

void SweepRunner::run_line_blocks(const SweepPlan& plan, const SweepFrame& frame, const PassContext& context,
                                  uint32_t group) {
  const LineStream& stream = plan.lines(group);
  const auto count = static_cast<uint32_t>(stream.blocks.size());
  context.threads.for_range(count, kLineBlockGrain, [&](uint32_t first, uint32_t last) {
    float* const kept = &line_scratch_[first * line_kept(stream, plan.lanes())];
    run_lines(plan.lanes(), *frame.state, stream, group, first, last, kept);
  });
}

void SweepRunner::run_step(const Plan& plan, const PassStep& step, const SweepFrame& frame, const PassContext& context,
                           const RunPass& pass) {
  if (step.pass == Pass::lines) return run_line_blocks(*plan.sweeps, frame, context, step.group);
  if (step.pass == Pass::collide_cells) return run_cell_rows(frame, context, step.group);
  const bool on_offsets = context.cloth.params.fine != shader::kFineOff;  // not what seams are laid out for
  if (on_offsets || !run_seams(plan.sweeps->seams(), step, context, *frame.state)) pass(step, context);
}

void SweepRunner::run_part(Plan& plan, uint32_t part, SweepFrame frame, const PassContext& context,
                           const SweepBand* rows, uint32_t band, const RunPass& pass) {
  const SweepPlan::Part& all = plan.sweeps->parts()[part];
  const auto work = [&] {
    if (const auto* step = std::get_if<PassStep>(&all)) return run_step(plan, *step, frame, context, pass);
    frame.sweep = &std::get<Sweep>(all);
    run_sweep(plan.sweeps->lanes(), frame, context.substep, *rows);
  };
  if (!timed_) return work();
  frame.seconds = context.substep == watched_ ? plan.times.passes_of(band, part) : nullptr;
  plan.times.measure(band, part, work);
}

void SweepRunner::run_in_bands(Plan& plan, const SweepFrame& frame, uint32_t first, uint32_t last,
                               const Threads& threads, const RunPass& pass) {
  const BandPlan& bands = plan.bands;
  const auto substeps = static_cast<uint32_t>(contexts_.size()), tasks = static_cast<uint32_t>(bands.tasks.size());
  const std::vector<SweepPlan::Part>& parts = plan.sweeps->parts();
  if (chains_.size() < bands.count()) chains_ = std::vector<TaskChain>(bands.count());
  penetration_.assign(size_t{substeps} * bands.count(), 0.F);
  const auto ready = [&](uint32_t band, uint32_t number) {
    for (uint32_t other = 0; other < bands.count(); ++other) {
      const uint32_t needed = other == band ? 0 : tasks_needed(bands, band, number, other);
      if (needed > 0 && chains_[other].done() < needed) return false;
    }
    return true;
  };
  const std::span<TaskChain> chains(chains_.data(), bands.count());
  threads.for_chains(chains, tasks * (last - first), ready, [&](uint32_t band, uint32_t number) {
    const uint32_t substep = first + number / tasks;
    const BandTask& task = bands.tasks[number % tasks];
    const bool alone = task.kind == BandTask::Kind::alone;
    if (alone && band > 0) return;
    SweepFrame own = frame;
    own.penetration = &penetration_[size_t{band} * substeps];
    own.scratch = scratch_of(band);
    const PassContext& all = contexts_[substep];
    const Threads& share = alone ? alone_ : plan.shares[band];
    const PassContext context{all.frame, all.cloth, share, substep, all.relaxation_steps};
    for (uint32_t n = task.first_part; n < task.last_part; ++n) {
      const SweepBand* const rows =
          std::holds_alternative<Sweep>(parts[n]) ? &bands.rows_of(n, band, task.kind) : nullptr;
      run_part(plan, n, own, context, rows, band, pass);
    }
  });
}

uint32_t SweepRunner::place_anchors(const ClothState& state) {
  const std::vector<shader::PinTarget>& pins = contexts_.front().cloth.pins;
  const std::vector<uint32_t>& anchor_of_pin = substep_.sweeps->anchor_of_pin();
  const size_t count = anchor_of_pin.size(), line = (count + kLineOfFloats - 1) / kLineOfFloats * kLineOfFloats;
  const bool fine = contexts_.front().cloth.params.fine != shader::kFineOff;
  anchors_.resize(3 * line * contexts_.size() + substep_.sweeps->lanes());  // vectors reach over the last one
  for (size_t k = 0; k < count; ++k) {
    if (state.inverse_mass[pins[k].pixel.x] > 0) continue;  // nothing is attached to what is not held
    shader::vec3 position = state.position.at(pins[k].pixel.x);
    shader::vec3 low = fine ? state.offset.at(pins[k].pixel.x) : shader::vec3(0, 0, 0);
    for (size_t s = 0; s < contexts_.size(); ++s) {
      if (fine) {
        const shader::vec3 offset = pinned_position(contexts_[s], shader::pin_from(pins[k], position), low, low);
        const shader::Settled settled = shader::settle(position, offset, low);
        position = settled.point.position;
        low = settled.low;
      } else {
        position = pinned_position(contexts_[s], pins[k], position, position);
      }
      float* const of_substep = &anchors_[3 * line * s + anchor_of_pin[k]];
      of_substep[0] = position.x;
      of_substep[line] = position.y;
      of_substep[2 * line] = position.z;
    }
  }
  return static_cast<uint32_t>(line);
}

void SweepRunner::run_plan(Plan& plan, SweepFrame frame, uint32_t first, uint32_t last, const Threads& threads,
                           const Measuring& measuring, const RunPass& pass) {
  penetration_.assign(contexts_.size(), 0.F);
  frame.penetration = penetration_.data();
  const std::vector<SweepPlan::Part>& parts = plan.sweeps->parts();
  const bool in_bands = threads.count() > 1;
  if (in_bands && plan.bands.rows.empty()) {
    plan.bands = plan_bands(*plan.sweeps, *frame.state, threads.count());
    plan.shares.clear();
    for (uint32_t k = 0; k < plan.bands.count(); ++k) plan.shares.emplace_back(k, plan.bands.count());
  }
  timed_ = measuring.seconds != nullptr;
  watched_ = first + (last - first) / 2;
  if (timed_) plan.times.begin(*plan.sweeps, in_bands ? plan.bands.count() : 1);
  if (in_bands) {
    run_in_bands(plan, frame, first, last, threads, pass);
  } else {
    frame.scratch = scratch_.data();
    for (uint32_t s = first; s < last; ++s) {
      for (uint32_t n = 0; n < parts.size(); ++n) {
        const auto* sweep = std::get_if<Sweep>(&parts[n]);
        run_part(plan, n, frame, contexts_[s], sweep != nullptr ? &sweep->whole : nullptr, 0, pass);
      }
    }
  }
  if (timed_) plan.times.end(*plan.sweeps, *measuring.seconds);
  for (const float depth : penetration_) {
    measuring.measures->penetration = std::max(measuring.measures->penetration, depth);
  }
}

void SweepRunner::normals(const Threads& threads, ClothState& state) const {
  constexpr uint32_t kRunGrain = 32;
  threads.for_range(static_cast<uint32_t>(runs_.size()), kRunGrain, [&](uint32_t first, uint32_t last) {
    run_normals(vector_lanes(), state, std::span(runs_).subspan(first, last - first));
  });
}

bool SweepRunner::begin(const FrameInput& frame, const ClothFrame& cloth, const ScheduleOptions& options,
                        const Threads& threads, ClothState& state) {
  prepare(state, cloth, options, threads.count());
  if (!substep_.sweeps) return false;
  const auto substeps = static_cast<uint32_t>(frame.substeps.size());
  contexts_.clear();
  for (uint32_t s = 0; s < substeps; ++s) contexts_.push_back({frame, cloth, threads, s, options.relaxation_steps});
  const uint32_t anchor_line = place_anchors(state);
  lay_out_pins(cloth.pins, substep_.sweeps->pins(), substep_.sweeps->lanes(), pins_);
  guard_colliders(frame, cloth.params, guards_);
  frame_ = {contexts_.data(), &state,       nullptr,        anchors_.data(),
            anchor_line,      pins_.data(), guards_.data(), cloth.params.max_step > 0 || cloth.params.moving != 0};
  return true;
}

void SweepRunner::run(uint32_t first, uint32_t last, const Measuring& measuring, const RunPass& pass) {
  run_plan(substep_, frame_, first, last, contexts_.front().threads, measuring, pass);
}

void SweepRunner::run_second_half(uint32_t substep, const Measuring& measuring, const RunPass& pass) {
  if (second_half_.sweeps) {
    run_plan(second_half_, frame_, substep, substep + 1, contexts_.front().threads, measuring, pass);
  }
}

void SweepRunner::finish(const Measuring& measuring, const RunPass& pass) {
  const auto substeps = static_cast<uint32_t>(contexts_.size());
  if (!finish_.sweeps) return;
  run_plan(finish_, frame_, substeps - 1, substeps, contexts_.front().threads, measuring, pass);
}

}  // namespace geocloth::cpu
