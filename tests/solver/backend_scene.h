// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "cpu/sweep_plan.h"
#include "cpu/wide_rows.h"
#include "solver_fixture.h"
#include "solver_impl.h"

namespace geocloth::test {

/// What a backend gets to see of a scene.
struct BackendScene {
  SimulationData data;
  FrameInput frame;
};

/// Keeps what it is given and does nothing.
class Recorder final : public SolverBackend {
 public:
  explicit Recorder(FrameInput& frame) : frame_(frame) {}
  void run_frame(const FrameInput& frame) override { frame_ = frame; }
  void wait() override {}
  void read_positions(uint32_t, std::vector<shader::vec4>&) override {}
  void read_previous(uint32_t, std::vector<shader::vec4>&) override {}
  void read_carry(uint32_t, std::vector<shader::vec4>&) override {}
  void read_normals(uint32_t, std::vector<shader::vec4>&) override {}
  void write_state(uint32_t, std::span<const shader::vec4>, std::span<const shader::vec4>) override {}
  [[nodiscard]] std::optional<Whereabouts> whereabouts(uint32_t) const override { return std::nullopt; }
  void read_memory(uint32_t, ClothMemory&) override {}
  void write_memory(uint32_t, const ClothMemory&, const ClothFrame&) override {}
  void read_found(FoundPoints&) override {}
  void write_found(const FoundPoints&) override {}
  void replace_topology(uint32_t, ClothData) override {}
  void shift(const Vec3&) override {}
  void add_cloth(ClothData) override {}
  void remove_cloth(uint32_t) override {}
  void replace_inter(InterData) override {}
  float longest_way(uint32_t, uint32_t) override { return longest; }
  uint32_t left_behind(uint32_t, uint32_t) override { return 0; }
  void read_contacts(uint32_t, std::vector<ContactSum>&) override {}
  void fill_statistics(SolverStatistics&) override {}

  float longest = 0;  ///< [m] way in a substep of every cloth's fastest point

 private:
  FrameInput& frame_;
};

/// A cloth hung by its first row, or by nothing, behind a ball.
inline BackendScene make_scene(const ClothDesc& cloth, bool collider = true, uint32_t relaxation_steps = 1,
                               bool pinned = true) {
  SolverSettings settings;
  settings.substeps = 6;
  settings.relaxation_steps = relaxation_steps;
  BackendScene scene;
  Solver::Impl solver(std::vector{cloth}, settings, [&](SimulationData data) {
    scene.data = std::move(data);
    return std::make_unique<Recorder>(scene.frame);
  });
  if (pinned) solver.set_pins(0, pins_at_rest(*cloth.asset, "top"));
  const Collider ball{"ball", Sphere{{0, 0, 0.1F}, 0.15F}, 0.3F, {}};
  if (collider) solver.set_colliders(std::vector{ball}, true);
  solver.step();
  return scene;
}

inline BackendScene make_scene(const SheetOptions& sheet, const Material& material, bool collider = true) {
  return make_scene(describe(make_sheet(sheet), material), collider);
}

inline Material attached() {
  Material material;
  material.max_stretch = 0.02F;
  return material;
}

/// A scene's cloth as the cpu keeps it.
struct CpuCloth {
  /// @param wide  in rows that begin at cache lines, as the backend has it; else in an image as wide as the asset's
  explicit CpuCloth(BackendScene of, bool wide = false)
      : scene(std::move(of)),
        state(data_of(scene, wide), false, false),
        runs(cpu::valid_runs(state)),
        frame(frame_of(scene, wide)) {
    std::copy(frame.inverse_mass.begin(), frame.inverse_mass.end(), state.inverse_mass.begin());
    if (state.data.attachments) state.attachments = frame.attachments;
  }
  [[nodiscard]] ScheduleOptions options() const { return schedule_options(scene.data, 0, scene.frame); }
  /// Of a substep; nothing without vectors.
  [[nodiscard]] std::unique_ptr<cpu::SweepPlan> plan() const {
    return plan_of(substep_schedule(options()), options().relaxation_steps);
  }
  /// Of what follows the last substep.
  [[nodiscard]] std::unique_ptr<cpu::SweepPlan> finish_plan() const { return plan_of(finish_schedule(options()), 1); }
  [[nodiscard]] std::unique_ptr<cpu::SweepPlan> plan_of(const std::vector<PassStep>& steps,
                                                        uint32_t relaxation_steps) const {
    return cpu::SweepPlan::make(state, steps, frame, runs, relaxation_steps);
  }

  BackendScene scene;
  cpu::ClothState state;
  std::vector<cpu::Run> runs;
  ClothFrame frame;

 private:
  static ClothData data_of(const BackendScene& scene, bool wide) {
    const ClothData& narrow = scene.data.cloths.front();
    return wide ? cpu::WideRows(narrow.width).widened(narrow) : narrow;
  }
  static ClothFrame frame_of(const BackendScene& scene, bool wide) {
    const ClothFrame& narrow = scene.frame.cloths.front();
    ClothFrame frame;
    if (!wide) return narrow;
    cpu::WideRows(scene.data.cloths.front().width).widen(narrow, frame);
    return frame;
  }
};

}  // namespace geocloth::test
