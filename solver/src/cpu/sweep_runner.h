// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "cpu/sweep_plan.h"

namespace geocloth::cpu {

/// Runs the substeps of one cloth by sweeps. Nothing is allocated while schedule and pins stay the same.
class SweepRunner {
 public:
  explicit SweepRunner(const ClothState& state) : runs_(valid_runs(state)) {}

  /// Runs all substeps of a frame.
  /// @param pass  runs what does not go by rows: one entry of the schedule in one substep
  /// @return false, with nothing done, when the cloth is too narrow for vectors
  bool run(const FrameInput& frame, const ClothFrame& cloth, const ScheduleOptions& options, const Threads& threads,
           ClothState& state, const std::function<void(const PassStep&, const PassContext&)>& pass);

  /// Unit normals of all pixels from their own cells.
  void normals(const Threads& threads, ClothState& state) const;

  [[nodiscard]] size_t memory_bytes() const { return plan_ ? plan_->memory_bytes() : 0; }

 private:
  /// What the constants in the plan follow from, besides the cloth itself.
  struct Recipe {
    ScheduleOptions options;
    float inverse_dt2 = 0, stretch_limit = 0, share_structural = 0, share_shear = 0, share_bending = 0;
    bool operator==(const Recipe&) const = default;
  };

  void prepare(const ClothState& state, const ClothFrame& cloth, const ScheduleOptions& options);
  void place_anchors(const ClothState& state);
  void run_side_by_side(const SweepFrame& sweep, uint32_t substeps, const Threads& threads);

  std::vector<Run> runs_;
  bool planned_ = false;
  Recipe recipe_;
  std::unique_ptr<SweepPlan> plan_;
  std::vector<PassContext> contexts_;
  std::vector<float> anchors_;
  std::vector<ColliderGuard> guards_;
  std::vector<std::atomic<uint32_t>> progress_;
};

}  // namespace geocloth::cpu
