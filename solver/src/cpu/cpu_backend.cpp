// SPDX-License-Identifier: Apache-2.0
// Runs the schedules on the cpu: by sweeps through the rows where it can, else pass by pass.

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "backend.h"
#include "cpu/cloth_state.h"
#include "cpu/cpu_name.h"
#include "cpu/passes.h"
#include "cpu/plan_pool.h"
#include "cpu/sweep_runner.h"
#include "cpu/threads.h"
#include "cpu/wide_rows.h"

namespace geocloth {
namespace {

using shader::vec4;

using PassSeconds = std::array<double, kPasses.size()>;

/// Passes one by one, as the last frame had them.
struct Schedules {
  std::optional<ScheduleOptions> options;
  std::vector<PassStep> substep, finish;

  void make(const ScheduleOptions& wanted) {
    if (options == wanted) return;  // frames that are like the one before allocate nothing
    options = wanted;
    substep = substep_schedule(wanted);
    finish = finish_schedule(wanted);
  }
};

/// One cloth with what goes with it.
struct Cloth {
  Cloth(const ClothData& data, bool accumulate, bool fine, cpu::PlanPool& plans)
      : rows(data.width), state(rows.widened(data), accumulate, fine), sweep(state, plans) {}

  cpu::WideRows rows;
  cpu::ClothState state;
  ClothFrame frame;  ///< with wide rows
  cpu::SweepRunner sweep;
  Schedules schedules;
  bool normals_stale = true;  ///< the positions have changed since
  cpu::Measures measures;
  PassSeconds seconds{};
};

class CpuBackend final : public SolverBackend {
 public:
  CpuBackend(SimulationData data, uint32_t threads) : data_(std::move(data)), threads_(threads) {
    cloths_.reserve(data_.cloths.size());
    for (ClothData& cloth : data_.cloths) {
      cloths_.emplace_back(cloth, data_.relaxation_steps > 1, data_.fine, plans_);
      cloth.position = {};
      cloth.self = {};
      cloth.springs = {};
    }
  }

  /// Enough cloths keep every thread busy by themselves; threads within a cloth have to wait for each other.
  void run_frame(const FrameInput& frame) override {
    const auto count = static_cast<uint32_t>(cloths_.size());
    if (threads_.count() == 1 || count < threads_.count()) {
      for (uint32_t c = 0; c < count; ++c) run_cloth(c, frame, threads_);
    } else {
      threads_.for_range(count, 1, [&](uint32_t first, uint32_t last) {
        for (uint32_t c = first; c < last; ++c) run_cloth(c, frame, alone_);
      });
    }
  }

  void wait() override {}

  void read_positions(uint32_t cloth, std::vector<vec4>& out) override {
    const cpu::ClothState& state = cloths_[cloth].state;
    gather(
        cloth, state.position, [&](size_t i) { return state.packed_mass(i); }, out);
  }
  void read_previous(uint32_t cloth, std::vector<vec4>& out) override {
    const cpu::ClothState& state = cloths_[cloth].state;
    gather(
        cloth, state.previous, [&](size_t i) { return state.inverse_mass[i]; }, out);
  }
  void read_carry(uint32_t cloth, std::vector<vec4>& out) override {
    const cpu::ClothState& state = cloths_[cloth].state;
    gather(
        cloth, state.carry, [&](size_t i) { return state.inverse_mass[i]; }, out);
  }
  /// Nobody else looks at the normals after a frame, so they are computed when they are asked for.
  void read_normals(uint32_t cloth, std::vector<vec4>& out) override {
    if (cloths_[cloth].normals_stale) compute_normals(cloths_[cloth], threads_);
    const cpu::ClothState& state = cloths_[cloth].state;
    gather(
        cloth, state.normal, [&](size_t i) { return state.normal_length[i]; }, out);
  }

  void write_state(uint32_t cloth, std::span<const vec4> position, std::span<const vec4> previous) override {
    cpu::ClothState& state = cloths_[cloth].state;
    for (uint32_t k = 0; k < position.size(); ++k) {
      const uint32_t i = cloths_[cloth].rows.pixel(k);
      state.position.set(i, {position[k].x, position[k].y, position[k].z});
      state.set_packed_mass(i, position[k].w);
      state.previous.set(i, {previous[k].x, previous[k].y, previous[k].z});
      state.carry.set(i, {0, 0, 0});
      if (data_.fine) state.offset.set(i, {0, 0, 0});
    }
    cloths_[cloth].normals_stale = true;
  }

  void replace_topology(uint32_t cloth, ClothData data) override {
    data_.cloths[cloth] = data;
    data_.cloths[cloth].position = {};
    data_.cloths[cloth].springs = {};
    data_.cloths[cloth].self = {};
    cloths_[cloth].state.set_topology(cloths_[cloth].rows.widened(data));
    cloths_[cloth].sweep.forget_plan();
    cloths_[cloth].normals_stale = true;
  }

  float longest_way(uint32_t cloth, uint32_t word) override { return cloths_[cloth].measures.longest_way[word]; }
  uint32_t left_behind(uint32_t cloth, uint32_t word) override { return cloths_[cloth].measures.left_behind[word]; }

  void fill_statistics(SolverStatistics& statistics) override {
    statistics.backend = "cpu";
    statistics.device = cpu::cpu_name();
    statistics.path = by_sweeps() ? std::string("sweep ") + cpu::vector_target() : "plain";
    statistics.threads = threads_.count();
    PassSeconds seconds{};
    statistics.memory_bytes += plans_.memory_bytes();
    for (const Cloth& cloth : cloths_) {
      statistics.memory_bytes += cloth.state.memory_bytes() + cloth.sweep.memory_bytes();
      statistics.copy_gap = std::max(statistics.copy_gap, static_cast<double>(cloth.measures.copy_gap));
      statistics.penetration = std::max(statistics.penetration, static_cast<double>(cloth.measures.penetration));
      for (size_t k = 0; k < seconds.size(); ++k) seconds[k] += cloth.seconds[k];
    }
    for (const PassInfo& pass : kPasses) {
      const double time = seconds[static_cast<size_t>(pass.pass)];
      if (time > 0) statistics.passes.push_back({std::string(pass.name), time});
    }
  }

 private:
  void run_cloth(uint32_t c, const FrameInput& frame, const cpu::Threads& threads) {
    Cloth& cloth = cloths_[c];
    cpu::ClothState& state = cloth.state;
    cloth.rows.widen(frame.cloths[c], cloth.frame);
    const ClothFrame& input = cloth.frame;
    if (input.pins_changed) {
      for (size_t i = 0; i < input.inverse_mass.size(); ++i) state.set_packed_mass(i, input.inverse_mass[i]);
      if (state.data.attachments) state.attachments = input.attachments;
    }
    const ScheduleOptions options = schedule_options(data_, c, frame);
    if (options.asleep) return;
    state.has_yields = !frame.shapes.empty();
    run_substeps(cloth, frame, input, options, threads);
    cloth.normals_stale = true;
    if (data_.timings) compute_normals(cloth, threads);
    if (options.motion) {
      run({Pass::measure_motion, options.motion_word}, {frame, input, threads, 0, data_.relaxation_steps}, cloth);
    }
  }

  void run_substeps(Cloth& cloth, const FrameInput& frame, const ClothFrame& input, const ScheduleOptions& options,
                    const cpu::Threads& threads) {
    const auto run_one = [&](const PassStep& step, const cpu::PassContext& context) { run(step, context, cloth); };
    const cpu::SweepRunner::Measuring measuring{&cloth.measures, data_.timings ? &cloth.seconds : nullptr};
    if (by_sweeps() && cloth.sweep.run(frame, input, options, threads, cloth.state, measuring, run_one)) return;
    cloth.schedules.make(options_of_substeps(options));
    cpu::PassContext context{frame, input, threads, 0, data_.relaxation_steps};
    for (uint32_t s = 0; s < options.substeps; ++s) {
      context.substep = s;
      for (const PassStep& step : cloth.schedules.substep) run(step, context, cloth);
    }
    for (const PassStep& step : cloth.schedules.finish) run(step, context, cloth);
  }

  /// Pass by pass is the reference.
  [[nodiscard]] bool by_sweeps() const { return data_.path != SolverPath::plain; }

  void run(const PassStep& step, const cpu::PassContext& context, Cloth& cloth) const {
    timed(cloth, step.pass, [&] { cpu::run_pass(step, context, cloth.state, cloth.measures); });
  }

  template <class Work>
  void timed(Cloth& cloth, Pass pass, const Work& work) const {
    using Clock = std::chrono::steady_clock;
    if (!data_.timings) return work();
    const auto start = Clock::now();
    work();
    cloth.seconds[static_cast<size_t>(pass)] += std::chrono::duration<double>(Clock::now() - start).count();
  }

  void compute_normals(Cloth& cloth, const cpu::Threads& threads) const {
    const FrameInput no_frame{};
    const ClothFrame no_input{};
    const cpu::PassContext context{no_frame, no_input, threads, 0, data_.relaxation_steps};
    ScheduleOptions options;
    options.splits = cloth.state.data.split_rows() > 0;
    for (const PassStep& step : frame_schedule(options)) {
      if (step.pass == Pass::normals && by_sweeps()) {
        timed(cloth, step.pass, [&] { cloth.sweep.normals(threads, cloth.state); });
      } else {
        run(step, context, cloth);
      }
    }
    cloth.normals_stale = false;
  }

  /// One vec4 for each pixel of the asset.
  /// @param w  w(i) of pixel i
  template <class W>
  void gather(uint32_t cloth, const cpu::Vec3Array& xyz, const W& w, std::vector<vec4>& out) const {
    out.resize(data_.cloths[cloth].pixel_count());
    for (uint32_t k = 0; k < out.size(); ++k) {
      const uint32_t i = cloths_[cloth].rows.pixel(k);
      out[k] = {xyz.at(i), w(i)};
    }
  }

  SimulationData data_;  ///< positions and springs have moved to the cloths
  cpu::Threads threads_;
  cpu::Threads alone_{1};
  cpu::PlanPool plans_;
  std::vector<Cloth> cloths_;
};

}  // namespace

std::unique_ptr<SolverBackend> make_cpu_backend(SimulationData data, uint32_t threads) {
  return std::make_unique<CpuBackend>(std::move(data), threads);
}

}  // namespace geocloth
