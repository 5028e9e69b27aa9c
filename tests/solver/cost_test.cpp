// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame costs, counted: dispatches and bytes per substep of each path, and that the cpu allocates nothing once
// it runs. Counts are the same on every machine; the times are in tests/bench.

#include <gtest/gtest.h>

#include "cpu/sweep_plan.h"
#include "solver_fixture.h"
#include "solver_impl.h"
#include "support/count_allocations.h"

namespace geocloth {
namespace {

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
  void fill_statistics(SolverStatistics&) override {}

 private:
  FrameInput& frame_;
};

/// A cloth hung by its first row, behind a ball.
BackendScene make_scene(const test::SheetOptions& sheet, const Material& material) {
  const ClothDesc cloth = test::describe(test::make_sheet(sheet), material);
  SolverSettings settings;
  settings.substeps = 6;
  BackendScene scene;
  Solver::Impl solver(std::vector{cloth}, settings, [&](SimulationData data) {
    scene.data = std::move(data);
    return std::make_unique<Recorder>(scene.frame);
  });
  solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
  solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, 0, 0.1F}, 0.15F}, 0.3F, {}}}, true);
  solver.step();
  return scene;
}

Material attached() {
  Material material;
  material.max_stretch = 0.02F;
  return material;
}

TEST(Cost, TheCpuAllocatesNothingOnceItRuns) {
  for (const uint32_t charts : {1U, 2U}) {
    BackendScene scene = make_scene({.nx = 70, .ny = 50, .charts_x = charts}, attached());
    const std::unique_ptr<SolverBackend> backend = make_cpu_backend(scene.data, 1);
    backend->run_frame(scene.frame);
    scene.frame.cloths.front().pins_changed = false;
    backend->run_frame(scene.frame);
    const uint64_t before = test::count_allocations();
    for (int frame = 0; frame < 5; ++frame) backend->run_frame(scene.frame);
    EXPECT_EQ(test::count_allocations() - before, 0U) << charts;
  }
}

/// The plan of a scene's substep.
std::unique_ptr<cpu::SweepPlan> plan_of(const BackendScene& scene) {
  const ClothFrame& input = scene.frame.cloths.front();
  cpu::ClothState state(scene.data.cloths.front(), false, false);
  const std::vector<cpu::Run> runs = cpu::valid_runs(state);
  std::copy(input.inverse_mass.begin(), input.inverse_mass.end(), state.inverse_mass.begin());
  if (state.data.attachments) state.attachments = input.attachments;
  const ScheduleOptions options = schedule_options(scene.data, 0, scene.frame);
  return cpu::SweepPlan::make(state, substep_schedule(options), input, runs, 1);
}

size_t sweeps_of(const cpu::SweepPlan& plan) {
  size_t count = 0;
  for (const cpu::SweepPlan::Part& part : plan.parts())
    count += static_cast<size_t>(std::holds_alternative<cpu::Sweep>(part));
  return count;
}

TEST(Cost, ASubstepOfUncutClothGoesThroughMemoryOnce) {
  const auto plan = plan_of(make_scene({.nx = 256, .ny = 256}, attached()));
  if (!plan) GTEST_SKIP() << "no vectors on this machine";
  EXPECT_EQ(plan->parts().size(), 1U);
  EXPECT_EQ(sweeps_of(*plan), 1U);
  // Position, previous and carry both ways and the mass: 76 bytes. Four springs of 8 bytes and two bends of 12, an
  // attachment of 8: 64 bytes. What blocks at the rows' ends add stays below a tenth.
  const double per_pixel = static_cast<double>(plan->bytes_per_substep()) / (256 * 256);
  EXPECT_GT(per_pixel, 0.98 * (76 + 64));
  EXPECT_LT(per_pixel, 1.1 * (76 + 64));
}

TEST(Cost, SeamsPartASubstepIntoThreeSweeps) {
  const auto plan = plan_of(make_scene({.nx = 128, .ny = 128, .charts_x = 2}, attached()));
  if (!plan) GTEST_SKIP() << "no vectors on this machine";
  EXPECT_EQ(sweeps_of(*plan), 3U);
}

TEST(Cost, MaskedChartsCostWhatTheirPixelsCost) {
  // Two charts with an empty strip of their own width between them, against one sheet of as many pixels.
  const auto cut = plan_of(make_scene({.nx = 129, .ny = 128, .charts_x = 2, .gap = 64}, attached()));
  const auto sheet = plan_of(make_scene({.nx = 130, .ny = 128}, attached()));
  if (!cut || !sheet) GTEST_SKIP() << "no vectors on this machine";
  EXPECT_LT(static_cast<double>(cut->memory_bytes()), 1.25 * static_cast<double>(sheet->memory_bytes()));
}

/// Bytes that a pixel's invocations of a pass load and store in images, with one invocation for each pixel of a group.
double image_bytes_per_pixel(const PassStep& step) {
  constexpr double kTexel = 16;
  switch (step.pass) {
    case Pass::predict:
      return 6 * kTexel;  // position, previous, carry both ways
    case Pass::structural:
    case Pass::shear:
    case Pass::bending:
      return 0.5 * 5 * kTexel;  // half the pixels: two ends both ways, rest data
    case Pass::curvature:
      return (1.0 / 3) * 9 * kTexel;  // a third: three points both ways, rest data of three
    case Pass::limit:
      return 3 * kTexel + sizeof(shader::Attachment);
    case Pass::collide:
      return 6 * kTexel;
    default:
      return 0;
  }
}

TEST(Cost, ThePlainPathIsOneDispatchForEachGroup) {
  const auto count = [](const Material& material, uint32_t charts) {
    const BackendScene scene = make_scene({.nx = 64, .ny = 64, .charts_x = charts}, material);
    const std::vector<PassStep> steps = substep_schedule(schedule_options(scene.data, 0, scene.frame));
    double bytes = 0;
    for (const PassStep& step : steps) bytes += image_bytes_per_pixel(step);
    return std::pair{steps.size(), bytes};
  };
  // predict, pins, 4 structural, 4 shear, 6 curvature, limit, collide.
  EXPECT_EQ(count(attached(), 1).first, 18U);
  EXPECT_NEAR(count(attached(), 1).second, 856, 1);
  Material springs = attached();
  springs.stiffness = springs.bend_stiffness = 1;
  EXPECT_EQ(count(springs, 1).first, 16U);
  // Two stitches and the colours of the bends over the seam.
  const BackendScene cut = make_scene({.nx = 64, .ny = 64, .charts_x = 2}, attached());
  EXPECT_EQ(count(attached(), 2).first, 18U + 2 + cut.data.cloths.front().seam_colors());
}

}  // namespace
}  // namespace geocloth
