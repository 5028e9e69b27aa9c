// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "cpu/bands.h"
#include "cpu/plan_pool.h"
#include "cpu/sweep_times.h"

namespace geocloth::cpu {

/// Runs the substeps of one cloth by sweeps. Nothing is allocated while schedule and pins stay the same.
class SweepRunner {
 public:
  /// @param pool  of the solver; outlives the runner
  SweepRunner(const ClothState& state, PlanPool& pool) : pool_(&pool), runs_(valid_runs(state)) {}

  /// What is measured on the way.
  struct Measuring {
    Measures* measures = nullptr;    ///< raised by the checks
    PassSeconds* seconds = nullptr;  ///< of each pass, added to; none: not measured
  };

  using RunPass = std::function<void(const PassStep&, const PassContext&)>;
  /// Before a frame, whose arguments have to live as long as it is run.
  /// @return false, with nothing done, when the cloth is too narrow for vectors: then it cannot be run
  bool begin(const FrameInput& frame, const ClothFrame& cloth, const ScheduleOptions& options, const Threads& threads,
             ClothState& state);
  /// The substeps first .. last - 1, of a cloth that collides with others their first half; see SubstepHalves.
  /// @param pass  runs what does not go by rows: one entry of the schedule in one substep
  void run(uint32_t first, uint32_t last, const Measuring& measuring, const RunPass& pass);
  void run_second_half(uint32_t substep, const Measuring& measuring, const RunPass& pass);
  /// What follows the last one; see finish_schedule().
  void finish(const Measuring& measuring, const RunPass& pass);

  /// What the springs are has changed.
  void forget_plan() { planned_ = false; }

  /// Of the cloth's pixels.
  [[nodiscard]] const std::vector<Run>& valid() const { return runs_; }

  /// Unit normals of all pixels from their own cells.
  void normals(const Threads& threads, ClothState& state) const;

  /// Without the plans, which are the pool's.
  [[nodiscard]] size_t memory_bytes() const { return (line_scratch_.capacity() + pins_.capacity()) * sizeof(float); }
  /// Forgets all that frames have left: lanes beside the cloth are worked on too, and a number that is not finite stays
  /// one there.
  void forget();

 private:
  /// What the constants in the plan and its scratch follow from, besides the cloth itself.
  struct Recipe {
    ScheduleOptions options;
    uint32_t threads = 1;
    float inverse_dt2 = 0, stretch_limit = 0, share_structural = 0, share_shear = 0, share_bending = 0;
    bool operator==(const Recipe&) const = default;
  };

  struct Plan {
    std::shared_ptr<const SweepPlan> sweeps;  ///< nothing: no passes, or none by sweeps
    BandPlan bands;                           ///< without rows: not planned
    std::vector<Threads> shares;              ///< of a pass that does not go by rows, one for each band
    SweepTimes times;
  };

  void prepare(const ClothState& state, const ClothFrame& cloth, const ScheduleOptions& options, uint32_t threads);
  void make_scratch(uint32_t threads);
  [[nodiscard]] float* scratch_of(uint32_t thread) { return scratch_.data() + thread * scratch_length_; }
  /// @return length of a line of them
  uint32_t place_anchors(const ClothState& state);
  /// One thread's share of what does not go by rows; with the guards of colliders where they help.
  void run_step(const Plan& plan, const PassStep& step, const SweepFrame& frame, const PassContext& context,
                const RunPass& pass);
  void run_cell_rows(const SweepFrame& frame, const PassContext& context, uint32_t group) const;
  void run_line_blocks(const SweepPlan& plan, const SweepFrame& frame, const PassContext& context, uint32_t group);
  /// Runs a plan in the substeps first .. last - 1.
  void run_plan(Plan& plan, SweepFrame frame, uint32_t first, uint32_t last, const Threads& threads,
                const Measuring& measuring, const RunPass& pass);
  /// The plan's parts one after another, each by all threads.
  void run_in_bands(Plan& plan, const SweepFrame& frame, uint32_t first, uint32_t last, const Threads& threads,
                    const RunPass& pass);
  /// One of them by one thread, which measures it if it is to.
  /// @param frame  with the thread's scratch and penetration
  /// @param rows   of a sweep
  void run_part(Plan& plan, uint32_t part, SweepFrame frame, const PassContext& context, const SweepBand* rows,
                uint32_t band, const RunPass& pass);

  PlanPool* pool_;
  std::vector<Run> runs_;
  bool planned_ = false;
  Recipe recipe_;
  Plan substep_, second_half_, finish_;
  Threads alone_{1};
  SweepFrame frame_;  ///< of the frame that runs
  std::vector<PassContext> contexts_;
  Floats anchors_, pins_;  ///< see SweepFrame
  std::vector<ColliderGuard> guards_;
  std::vector<float> penetration_;
  Floats scratch_;  ///< see SweepFrame, for each thread
  size_t scratch_length_ = 0;
  Floats line_scratch_;  ///< for the blocks of LineStream
  bool timed_ = false;
  uint32_t watched_ = 0;           ///< the substep whose passes are told apart
  std::vector<TaskChain> chains_;  ///< of the bands
};

}  // namespace geocloth::cpu
