// SPDX-License-Identifier: GPL-3.0-or-later
// What a frame costs, counted: dispatches and bytes per substep of each path, and that the cpu allocates nothing once
// it runs. Counts are the same on every machine; the times are in tests/bench.

#include <gtest/gtest.h>

#include "backend_scene.h"
#include "cpu/bands.h"
#include "support/count_allocations.h"
#include "vulkan/frame_plan.h"

namespace geocloth {
namespace {

using test::attached;
using test::BackendScene;
using test::CpuCloth;
using test::make_scene;

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

TEST(Cost, AStepOfTheSolverAllocatesNothingOnceItRuns) {
  for (const SolverPath path : {SolverPath::automatic, SolverPath::plain}) {
    for (const uint32_t charts : {1U, 2U}) {
      for (const uint32_t relaxation_steps : {1U, 2U}) {
        const ClothDesc cloth = test::describe(test::make_sheet({.nx = 70, .ny = 50, .charts_x = charts}), attached());
        SolverSettings settings;
        settings.backend = Backend::cpu;
        settings.path = path;
        settings.substeps = 6;
        settings.relaxation_steps = relaxation_steps;
        Solver solver(std::vector{cloth}, settings);
        solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
        solver.set_colliders(std::vector<Collider>{{"ball", Sphere{{0, 0, 0.1F}, 0.15F}, 0.3F, {}}});
        solver.set_wind({{1, 0, 2}, 0.3F, 1, 1, 0.2F});
        test::run(solver, 3);
        const uint64_t before = test::count_allocations();
        test::run(solver, 5);
        EXPECT_EQ(test::count_allocations() - before, 0U)
            << charts << ", " << relaxation_steps << (path == SolverPath::plain ? ", pass by pass" : "");
      }
    }
  }
}

/// Checks put the text of a refusal together for each point that was right: a rollback of 128 x 128 pixels or of as
/// many pins took most of a frame by that.
TEST(Cost, StatesAndPinsThatAreRightTakeNoMemoryForEachPoint) {
  const auto taken = [](uint32_t size) {
    const ClothDesc cloth = test::describe(test::make_sheet({.nx = size, .ny = size, .charts_x = 2}));
    Solver solver(std::vector{cloth}, test::cpu_settings());
    std::vector<Pin> pins;
    for (uint32_t p = 0; p < cloth.asset->pixel_count(); ++p)
      if (cloth.asset->valid(p))
        pins.push_back({.pixel = p, .target = cloth.asset->rest_position[p], .max_distance = 0.1F});
    solver.set_pins(0, pins);
    test::run(solver, 1);
    const std::vector<Vec3> x = test::positions_of(solver), v = test::velocities_of(solver);
    const std::vector<std::byte> state = solver.save();
    const uint64_t before = test::count_allocations();
    solver.write_state(0, x, v);
    solver.restore(state);
    return test::count_allocations() - before;
  };
  EXPECT_LT(taken(48), taken(12) + 60U);  // lists that grow, but nothing for each of 2000 points more
}

std::unique_ptr<cpu::SweepPlan> plan_of(const BackendScene& scene) {
  return CpuCloth(scene).plan();
}

size_t sweeps_of(const cpu::SweepPlan& plan) {
  size_t count = 0;
  for (const cpu::SweepPlan::Part& part : plan.parts())
    count += static_cast<size_t>(std::holds_alternative<cpu::Sweep>(part));
  return count;
}

/// Cloth falls onto itself, or one onto another, so that ever more cells and neighbours are looked up.
TEST(Cost, CollisionsOfClothAllocateNothingOnceTheyRun) {
  for (const bool between : {false, true}) {
    std::vector<ClothDesc> cloths(2, test::describe(test::make_sheet({.nx = 40, .ny = 40, .center = {0, 0.6F, 0}})));
    for (ClothDesc& cloth : cloths) {
      cloth.transform.rotate = quat_from_euler_deg({10, 0, 5});
      if (between) {
        cloth.inter_collision = InterCollision{};
      } else {
        cloth.self_collision = SelfCollision{};
      }
    }
    cloths.back().transform.translate.z = between ? 0.05F : 3.F;
    SolverSettings settings;
    settings.backend = Backend::cpu;
    Solver solver(cloths, settings);
    const Collider floor{.name = "floor", .shape = Plane{}};
    solver.set_colliders({&floor, 1});
    test::run(solver, 3);
    const uint64_t before = test::count_allocations();
    test::run(solver, 40);
    EXPECT_EQ(test::count_allocations() - before, 0U) << (between ? "between cloths" : "of each");
  }
}

TEST(Cost, ASubstepOfUncutClothGoesThroughMemoryOnce) {
  const auto plan = plan_of(make_scene({.nx = 256, .ny = 256}, attached()));
  if (!plan) GTEST_SKIP() << "no vectors on this machine";
  EXPECT_EQ(plan->parts().size(), 1U);
  EXPECT_EQ(sweeps_of(*plan), 1U);
  // Position, previous and carry both ways and the mass: 76 bytes. Four springs of 8 bytes and two bends of 12, an
  // attachment of 8, two spans of 8: 80 bytes. What blocks at the rows' ends add stays below a tenth.
  const double per_pixel = static_cast<double>(plan->bytes_per_substep()) / (256 * 256);
  EXPECT_GT(per_pixel, 0.98 * (76 + 80));
  EXPECT_LT(per_pixel, 1.1 * (76 + 80));
}

TEST(Cost, SeamsPartASubstepIntoThreeSweeps) {
  const auto plan = plan_of(make_scene({.nx = 128, .ny = 128, .charts_x = 2}, attached()));
  if (!plan) GTEST_SKIP() << "no vectors on this machine";
  EXPECT_EQ(sweeps_of(*plan), 3U);
}

/// A crowd in one garment that had all constants for each of its cloths would need half as much memory again.
TEST(Cost, ACrowdInOneGarmentHasItsConstantsOnce) {
  const ClothDesc cloth = test::describe(test::make_sheet({.nx = 64, .ny = 64, .charts_x = 2}), attached());
  const auto bytes = [&](uint32_t count, uint32_t relaxation_steps) {
    SolverSettings settings = test::cpu_settings();
    settings.relaxation_steps = relaxation_steps;
    std::vector<ClothDesc> cloths(count, cloth);
    for (uint32_t i = 0; i < count; ++i) cloths[i].transform.translate = {static_cast<float>(i), 0, 0};
    Solver solver(cloths, settings);
    for (uint32_t i = 0; i < count; ++i)
      solver.set_pins(i, test::pins_at_rest(*cloth.asset, "top", cloths[i].transform.translate));
    test::run(solver, 1);
    return static_cast<double>(solver.statistics().memory_bytes);
  };
  EXPECT_LT(bytes(8, 1), 0.7 * 8 * bytes(1, 1));
  EXPECT_GT(bytes(8, 2), 0.99 * 8 * bytes(1, 2)) << "multipliers are each cloth's own";
}

/// Rows that the passes of a sweep go through in a task.
uint64_t rows_in(const cpu::SweepBand& task) {
  uint64_t rows = 0;
  for (const cpu::RowRange& own : task.rows) rows += own.last - std::min(own.first, own.last);
  return rows;
}

/// What threads go through together, and how long it takes them when each row of a pass takes as long and a thread
/// does a band.
struct Shared {
  uint32_t bands = 0;
  uint64_t all = 0, time = 0;
};
Shared share_out(const test::SheetOptions& sheet, uint32_t threads) {
  const CpuCloth cloth(make_scene(sheet, attached()));
  const std::unique_ptr<cpu::SweepPlan> plan = cloth.plan();
  if (!plan) return {};
  const cpu::BandPlan bands = cpu::plan_bands(*plan, cloth.state, threads);
  Shared shared{bands.count()};
  std::vector<std::vector<uint64_t>> ends(bands.count(), {0});  // of as many tasks as its place says
  for (uint32_t number = 0; number < bands.tasks.size(); ++number) {
    const cpu::BandTask& task = bands.tasks[number];
    const bool swept = std::holds_alternative<cpu::Sweep>(plan->parts()[task.first_part]);
    for (uint32_t band = 0; band < bands.count(); ++band) {
      const uint64_t rows = swept ? rows_in(bands.rows_of(task.first_part, band, task.kind)) : 0;
      uint64_t start = ends[band].back();
      for (uint32_t other = 0; other < bands.count(); ++other)
        if (other != band) start = std::max(start, ends[other][cpu::tasks_needed(bands, band, number, other)]);
      ends[band].push_back(start + rows);
      shared.all += rows;
      shared.time = std::max(shared.time, start + rows);
    }
  }
  return shared;
}

TEST(Cost, TwoThreadsHaveHalfOfCutClothEach) {
  const Shared alone = share_out({.nx = 128, .ny = 150, .charts_x = 2}, 1);
  const Shared two = share_out({.nx = 128, .ny = 150, .charts_x = 2}, 2);
  if (alone.bands == 0) GTEST_SKIP() << "no vectors on this machine";
  EXPECT_EQ(two.bands, 2U);
  EXPECT_EQ(two.all, alone.all);  // each row by somebody, and by nobody twice
  EXPECT_LT(static_cast<double>(two.time), static_cast<double>(alone.time) / 1.8);
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
    case Pass::spans:
      return 0.5 * 12 * kTexel;  // half the pixels: two ends both ways, rest data of eight
    case Pass::limit:
      return 3 * kTexel + sizeof(shader::Attachment);
    case Pass::collide:
      return 6 * kTexel;
    default:
      return 0;
  }
}

uint32_t colors_over_seams(const ClothData& cloth) {
  EXPECT_GT(cloth.seam_bend_colors, 0U);
  EXPECT_GT(cloth.seam_span_colors, 0U);
  return cloth.seam_bend_colors + cloth.seam_span_colors;
}

// They would keep it trembling; what comes to rest, is disturbed, hangs or is blown at has them.
TEST(Cost, ClothThatDoesNotComeToRestEndsItsFramesWithoutTies) {
  const ClothDesc cloth = test::describe(test::make_sheet({.nx = 8, .ny = 8}), attached());
  BackendScene scene;
  const SolverSettings settings;
  test::Recorder* recorder = nullptr;
  Solver::Impl solver(std::vector{cloth}, settings, [&](SimulationData data) {
    scene.data = std::move(data);
    auto backend = std::make_unique<test::Recorder>(scene.frame);
    recorder = backend.get();
    return backend;
  });
  std::vector<Collider> ball{{"ball", Sphere{{0, 0, 0.1F}, 0.15F}, 0.3F, {}}};
  solver.set_colliders(ball, true);
  const auto has_ties_after = [&](int frames) {
    for (int f = 0; f < frames; ++f) solver.step();
    return schedule_options(scene.data, 0, scene.frame).ties;
  };
  const auto move_at = [&](double speed) {
    recorder->longest = static_cast<float>(speed * settings.frame_time / settings.substeps);
  };
  constexpr int kLong = 250;  // frames, of four seconds and a little
  constexpr double kDrawn = 9.81 / 60, kTrembling = 1.5 * kDrawn;
  move_at(1.1 * kDrawn);
  EXPECT_TRUE(has_ties_after(2 * kLong)) << "gravity draws it down by what ties hold up";
  move_at(kTrembling);
  EXPECT_FALSE(has_ties_after(3));
  move_at(0);
  EXPECT_FALSE(has_ties_after(kLong)) << "they would begin again";
  ball[0].pose.translate = {0, 0, 0.01F};
  solver.set_colliders(ball, false);
  EXPECT_TRUE(has_ties_after(1)) << "a collider moves";
  EXPECT_TRUE(has_ties_after(kLong)) << "and it is at rest";
  move_at(kTrembling);
  EXPECT_FALSE(has_ties_after(3));
  solver.set_gravity({0, -10, 0});
  EXPECT_TRUE(has_ties_after(1));
  EXPECT_FALSE(has_ties_after(kLong));
  move_at(3);
  EXPECT_TRUE(has_ties_after(kLong)) << "it falls";
  move_at(kTrembling);
  EXPECT_FALSE(has_ties_after(kLong));
  solver.set_wind({.velocity = {1, 0, 0}});
  EXPECT_TRUE(has_ties_after(kLong)) << "wind never leaves it alone";
  solver.set_wind({});
  EXPECT_FALSE(has_ties_after(kLong));
  solver.set_pressure(0, 1);
  EXPECT_TRUE(has_ties_after(kLong)) << "it is inflated";
  solver.set_pressure(0, 0);
  EXPECT_FALSE(has_ties_after(kLong));
  solver.set_pins(0, test::pins_at_rest(*cloth.asset, "top"));
  EXPECT_TRUE(has_ties_after(kLong)) << "it hangs";
}

TEST(Cost, ThePlainPathIsOneDispatchForEachGroup) {
  const auto count = [](const Material& material, uint32_t charts) {
    const BackendScene scene = make_scene({.nx = 64, .ny = 64, .charts_x = charts}, material);
    const std::vector<PassStep> steps = substep_schedule(schedule_options(scene.data, 0, scene.frame));
    double bytes = 0;
    for (const PassStep& step : steps) bytes += image_bytes_per_pixel(step);
    return std::pair{steps.size(), bytes};
  };
  // predict, pins, 4 shear, 4 spans, 6 curvature, 4 structural, limit, collide.
  EXPECT_EQ(count(attached(), 1).first, 22U);
  EXPECT_NEAR(count(attached(), 1).second, 856 + 384, 1);
  Material springs = attached();
  springs.stiffness = springs.bend_stiffness = 1;
  EXPECT_EQ(count(springs, 1).first, 20U);
  // Without pins and attachments, but with spans of another length.
  const BackendScene dropped =
      make_scene(test::describe(test::make_sheet({.nx = 64, .ny = 64}), attached()), true, 1, false);
  EXPECT_EQ(substep_schedule(schedule_options(dropped.data, 0, dropped.frame)).size(), 22U - 2 + 4);
  // Two stitches and the colours of the bends and of the spans over the seam.
  const BackendScene cut = make_scene({.nx = 64, .ny = 64, .charts_x = 2}, attached());
  EXPECT_EQ(count(attached(), 2).first, 22U + 2 + colors_over_seams(cut.data.cloths.front()));
}

/// Of a dispatch, counting what its invocations load and store in images and lists of constants. A tile reads its
/// border too; what caches keep of that is not taken off.
double image_bytes_per_pixel(const vulkan::Dispatch& dispatch, const vulkan::FramePlan& plan,
                             const vulkan::TileLimits& limits) {
  if (dispatch.kind == vulkan::Dispatch::Kind::pass) return image_bytes_per_pixel(dispatch.step);
  constexpr double kTexel = 16;
  const double side = vulkan::tile_side(limits, dispatch.border), region = (side + 2 * dispatch.border) / side;
  const double read = region * region;
  const bool history = dispatch.tile.keep_history != 0;
  double bytes = kTexel * read + kTexel + (history ? 4 * kTexel : 0);  // position; previous and carry as they are
  bool rest = false, bent = false;
  for (uint32_t k = dispatch.tile.first; k < dispatch.tile.first + dispatch.tile.count; ++k) {
    const shader::TileStep& step = plan.steps[k];
    if (step.pass == shader::kTilePredict) bytes += 2 * kTexel * read + 2 * kTexel + sizeof(uint32_t) * read;
    if (step.pass == shader::kTileSprings && !rest) bytes += kTexel * read;    // of the family
    if (step.pass == shader::kTileBends && !bent) bytes += 2 * kTexel * read;  // and of the structural one
    if (step.pass == shader::kTileLimit) bytes += sizeof(shader::Attachment);
    if (step.pass == shader::kTileCollide) bytes += 4 * kTexel;
    rest = rest || step.pass == shader::kTileSprings;
    bent = bent || step.pass == shader::kTileBends;
  }
  return bytes;
}

/// What a substep of a scene costs on a path.
struct Cost {
  size_t dispatches = 0;
  double bytes_per_pixel = 0;
};
Cost cost_of_substep(const BackendScene& scene, SolverPath path, const vulkan::TileLimits& limits) {
  const ScheduleOptions options = schedule_options(scene.data, 0, scene.frame);
  const ClothData& cloth = scene.data.cloths.front();
  const auto of_frame = [&](uint32_t substeps) {
    const vulkan::FramePlan plan =
        vulkan::plan_frame(path, options, substeps, {cloth.split_rows(), cloth.seam_color_offset});
    Cost cost{plan.dispatches.size(), 0};
    for (const vulkan::Dispatch& dispatch : plan.dispatches)
      cost.bytes_per_pixel += image_bytes_per_pixel(dispatch, plan, limits);
    return cost;
  };
  const Cost two = of_frame(2), one = of_frame(1);
  return {two.dispatches - one.dispatches, two.bytes_per_pixel - one.bytes_per_pixel};
}

constexpr vulkan::TileLimits kGpu{
    .shared_bytes = 49152, .invocations = 1024, .subgroup = 32, .descriptors = true, .software = false};

TEST(Cost, TilesAreTwoDispatchesForASubstepAndHalfTheBytes) {
  const BackendScene uncut = make_scene({.nx = 64, .ny = 64}, attached(), false);
  const Cost plain = cost_of_substep(uncut, SolverPath::plain, kGpu);
  const Cost tiled = cost_of_substep(uncut, SolverPath::tiled, kGpu);
  EXPECT_EQ(plain.dispatches, 17U);
  EXPECT_EQ(tiled.dispatches, 2U);
  EXPECT_LT(tiled.bytes_per_pixel, 0.55 * plain.bytes_per_pixel);
  // Spans, which come with colliders, reach too far for a tile.
  const BackendScene on_ball = make_scene({.nx = 64, .ny = 64}, attached());
  EXPECT_EQ(cost_of_substep(on_ball, SolverPath::tiled, kGpu).dispatches, 2U + 4U);
  // Seams: stitches, the colours of the bends and of the spans over them, attachments and colliders by themselves.
  const BackendScene cut = make_scene({.nx = 64, .ny = 64, .charts_x = 2}, attached());
  const size_t colors = colors_over_seams(cut.data.cloths.front());
  EXPECT_EQ(cost_of_substep(cut, SolverPath::tiled, kGpu).dispatches, 2 + 4 + 2 + 2 + colors);
}

TEST(Cost, ATinyClothIsOneDispatchForAFrame) {
  for (const uint32_t charts : {1U, 2U}) {
    const BackendScene scene = make_scene({.nx = 40, .ny = 40, .charts_x = charts}, attached());
    const ScheduleOptions options = schedule_options(scene.data, 0, scene.frame);
    const ClothData& cloth = scene.data.cloths.front();
    const vulkan::FramePlan plan =
        vulkan::plan_frame(SolverPath::tiny, options, 6, {cloth.split_rows(), cloth.seam_color_offset});
    EXPECT_EQ(plan.dispatches.size(), 1U);
    EXPECT_EQ(plan.dispatches.front().tile.count, plan.steps.size());
  }
}

// Contacts are most of a kernel's code and registers: a dispatch that takes them along for nothing runs fewer groups at
// once on a GPU, and one that lacks them would let cloth through its colliders.
TEST(Cost, OnlyDispatchesThatMeetCollidersHoldContacts) {
  for (const bool collider : {false, true}) {
    const BackendScene scene = make_scene({.nx = 40, .ny = 40}, attached(), collider);
    const ScheduleOptions options = schedule_options(scene.data, 0, scene.frame);
    const ClothData& cloth = scene.data.cloths.front();
    for (const SolverPath path : {SolverPath::tiled, SolverPath::tiny}) {
      const vulkan::FramePlan plan =
          vulkan::plan_frame(path, options, 2, {cloth.split_rows(), cloth.seam_color_offset});
      size_t with = 0, tiles = 0;
      for (const vulkan::Dispatch& dispatch : plan.dispatches) {
        if (dispatch.kind == vulkan::Dispatch::Kind::pass) continue;
        const auto steps = std::span(plan.steps).subspan(dispatch.tile.first, dispatch.tile.count);
        const bool meets = std::ranges::any_of(steps, [](const shader::TileStep& step) {
          return step.pass == shader::kTileCollide || step.pass == shader::kTileGiveWay ||
                 step.pass == shader::kTileCheckColliders;
        });
        EXPECT_EQ(dispatch.contacts, meets) << dispatch.name;
        with += dispatch.contacts ? 1U : 0U;
        ++tiles;
      }
      ASSERT_GT(tiles, 0U);
      // Of the tiles of a substep the second one alone: the first predicts and shears.
      const size_t most = !collider ? 0 : path == SolverPath::tiny ? tiles : tiles / 2;
      EXPECT_EQ(with > 0, collider);
      EXPECT_LE(with, most);
    }
  }
}

TEST(Cost, PathsAreChosenByTheDeviceAndTheSize) {
  const auto chosen = [](const vulkan::TileLimits& limits, uint32_t side, SolverPath wish, uint32_t relaxation = 1,
                         bool fine = false) {
    return vulkan::choose_path(limits, {wish, side, side, relaxation, fine});
  };
  constexpr SolverPath kAny = SolverPath::automatic;
  EXPECT_EQ(chosen(kGpu, 55, kAny), SolverPath::tiny);
  EXPECT_EQ(chosen(kGpu, 56, kAny), SolverPath::tiled);
  EXPECT_EQ(chosen(kGpu, 55, kAny, 4), SolverPath::tiny);
  EXPECT_EQ(chosen(kGpu, 56, kAny, 4), SolverPath::plain);
  EXPECT_EQ(chosen(kGpu, 20, kAny, 1, true), SolverPath::plain);
  EXPECT_EQ(chosen(kGpu, 20, SolverPath::tiled), SolverPath::tiled);
  EXPECT_EQ(chosen(kGpu, 20, SolverPath::plain), SolverPath::plain);
  vulkan::TileLimits other = kGpu;
  other.software = true;
  EXPECT_EQ(chosen(other, 20, kAny), SolverPath::plain);
  EXPECT_EQ(chosen(other, 20, SolverPath::tiny), SolverPath::tiny);
  other = kGpu;
  other.descriptors = false;
  EXPECT_EQ(chosen(other, 20, kAny), SolverPath::plain);
  // The least that Vulkan promises still has tiles of a fair size, with the widest border.
  other = kGpu;
  other.shared_bytes = 16384;
  EXPECT_GE(vulkan::tile_side(other, 10), 8U);
}

}  // namespace
}  // namespace geocloth
