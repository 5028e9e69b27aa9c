// SPDX-License-Identifier: Apache-2.0
// Runs the schedules on the cpu: cloth by cloth, pass by pass.

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

#include "backend.h"
#include "cpu/cloth_state.h"
#include "cpu/cpu_name.h"
#include "cpu/passes.h"
#include "cpu/sweep_runner.h"
#include "cpu/threads.h"

namespace geocloth {
namespace {

using shader::vec4;

class CpuBackend final : public SolverBackend {
 public:
  CpuBackend(SimulationData data, uint32_t threads) : data_(std::move(data)), threads_(threads) {
    for (ClothData& cloth : data_.cloths) {
      states_.emplace_back(cloth, data_.relaxation_steps > 1);
      sweeps_.emplace_back(states_.back());
      cloth.position = {};
      cloth.springs = {};
    }
    normals_stale_.assign(states_.size(), true);
  }

  void run_frame(const FrameInput& frame) override {
    for (uint32_t c = 0; c < states_.size(); ++c) run_cloth(c, frame);
  }

  void wait() override {}

  void read_positions(uint32_t cloth, std::vector<vec4>& out) override {
    gather(cloth, states_[cloth].position, states_[cloth].inverse_mass, out);
  }
  void read_previous(uint32_t cloth, std::vector<vec4>& out) override {
    gather(cloth, states_[cloth].previous, states_[cloth].inverse_mass, out);
  }
  /// Nobody else looks at the normals after a frame, so they are computed when they are asked for.
  void read_normals(uint32_t cloth, std::vector<vec4>& out) override {
    if (normals_stale_[cloth]) compute_normals(cloth);
    gather(cloth, states_[cloth].normal, states_[cloth].normal_length, out);
  }

  void write_state(uint32_t cloth, std::span<const vec4> position, std::span<const vec4> previous) override {
    cpu::ClothState& state = states_[cloth];
    for (size_t i = 0; i < state.pixel_count(); ++i) {
      state.position.set(i, {position[i].x, position[i].y, position[i].z});
      state.inverse_mass[i] = position[i].w;
      state.previous.set(i, {previous[i].x, previous[i].y, previous[i].z});
      state.carry.set(i, {0, 0, 0});
    }
    normals_stale_[cloth] = true;
  }

  void fill_statistics(SolverStatistics& statistics) override {
    statistics.backend = "cpu";
    statistics.device = cpu::cpu_name();
    statistics.path = by_sweeps() ? std::string("sweep ") + cpu::vector_target() : "plain";
    statistics.threads = threads_.count();
    for (const cpu::ClothState& state : states_) statistics.memory_bytes += state.memory_bytes();
    for (const cpu::SweepRunner& sweep : sweeps_) statistics.memory_bytes += sweep.memory_bytes();
    statistics.copy_gap = static_cast<double>(measures_.copy_gap);
    statistics.penetration = static_cast<double>(measures_.penetration);
    for (const PassInfo& pass : kPasses) {
      const double seconds = seconds_[static_cast<size_t>(pass.pass)];
      if (seconds > 0) statistics.passes.push_back({std::string(pass.name), seconds});
    }
  }

 private:
  void run_cloth(uint32_t c, const FrameInput& frame) {
    cpu::ClothState& state = states_[c];
    const ClothFrame& cloth = frame.cloths[c];
    if (cloth.pins_changed) {
      std::copy(cloth.inverse_mass.begin(), cloth.inverse_mass.end(), state.inverse_mass.begin());
      if (state.data.attachments) state.attachments = cloth.attachments;
    }
    const ScheduleOptions options = schedule_options(data_, c, frame);
    const auto run_one = [&](const PassStep& step, const cpu::PassContext& context) {
      cpu::run_pass(step, context, state, measures_);
    };
    normals_stale_[c] = true;
    if (by_sweeps() && sweeps_[c].run(frame, cloth, options, threads_, state, run_one)) return;
    const std::vector<PassStep> substep = substep_schedule(options);
    cpu::PassContext context{frame, cloth, threads_, 0, data_.relaxation_steps};
    for (uint32_t s = 0; s < data_.substeps; ++s) {
      context.substep = s;
      run(substep, context, state);
    }
    if (!data_.timings) return;
    run(frame_schedule(options), context, state);
    normals_stale_[c] = false;
  }

  /// Pass by pass is the reference, and the way to time each pass.
  [[nodiscard]] bool by_sweeps() const { return !data_.plain && !data_.timings; }

  void run(const std::vector<PassStep>& steps, const cpu::PassContext& context, cpu::ClothState& state) {
    using Clock = std::chrono::steady_clock;
    for (const PassStep& step : steps) {
      if (!data_.timings) {
        cpu::run_pass(step, context, state, measures_);
        continue;
      }
      const auto start = Clock::now();
      cpu::run_pass(step, context, state, measures_);
      seconds_[static_cast<size_t>(step.pass)] += std::chrono::duration<double>(Clock::now() - start).count();
    }
  }

  void compute_normals(uint32_t c) {
    FrameInput nothing;
    nothing.cloths.resize(states_.size());
    const cpu::PassContext context{nothing, nothing.cloths[c], threads_, 0, data_.relaxation_steps};
    ScheduleOptions options;
    options.splits = states_[c].data.split_rows() > 0;
    for (const PassStep& step : frame_schedule(options)) {
      if (step.pass == Pass::normals && by_sweeps()) {
        sweeps_[c].normals(threads_, states_[c]);
      } else {
        cpu::run_pass(step, context, states_[c], measures_);
      }
    }
    normals_stale_[c] = false;
  }

  void gather(uint32_t cloth, const cpu::Vec3Array& xyz, const std::vector<float>& w, std::vector<vec4>& out) const {
    out.resize(states_[cloth].pixel_count());
    for (size_t i = 0; i < out.size(); ++i) out[i] = {xyz.at(i), w[i]};
  }

  SimulationData data_;  ///< positions and springs have moved to states_
  cpu::Threads threads_;
  std::vector<cpu::ClothState> states_;
  std::vector<cpu::SweepRunner> sweeps_;  ///< of each cloth
  std::vector<bool> normals_stale_;       ///< of each cloth: its positions have changed since
  cpu::Measures measures_;
  std::array<double, kPasses.size()> seconds_{};
};

}  // namespace

std::unique_ptr<SolverBackend> make_cpu_backend(SimulationData data, uint32_t threads) {
  return std::make_unique<CpuBackend>(std::move(data), threads);
}

}  // namespace geocloth
