// SPDX-License-Identifier: GPL-3.0-or-later
// Google Benchmark over the cpu backend: where a frame's time goes when one thing changes at a time. `geocloth bench`
// measures whole scenes on every backend; this is for work on the solver.
//
//   ninja solver_bench && tests/bench/solver_bench --benchmark_filter=sheet

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include "geocloth/solver/solver.h"
#include "support/make_sheet.h"

namespace {

using namespace geocloth;

constexpr float kSpacing = 0.01F;  // [m]

/// What a benchmark's numbers stand for.
struct Setup {
  uint32_t size = 100, substeps = 8, threads = 1, charts = 1;
  bool plain = false, curvature = false, attached = true, ball = false, wind = false, swing = false, bends = true;
  uint32_t relaxation_steps = 1;
  bool momentum = false, cells = false, parent = false;  ///< cells: triangles meet colliders too
  bool avx2 = false;                                     ///< no better vectors than these
  bool leashed = false;                                  ///< every point is pinned by a distance and a backstop
};

std::vector<Pin> leashes(const ClothAsset& asset) {
  std::vector<Pin> pins;
  for (uint32_t p = 0; p < asset.pixel_count(); ++p) {
    if (!asset.valid(p)) continue;
    pins.push_back({.pixel = p, .target = asset.rest_position[p], .max_distance = 0.05F});
    pins.back().backstop = Backstop{{0, 0, 1}, 0.01F};
  }
  return pins;
}

Solver make_solver(const Setup& setup, SolverStatistics& statistics) {
  const float side = kSpacing * static_cast<float>(setup.size - 1);
  Material material;
  material.damping = 0;
  if (setup.attached) material.max_stretch = 0.002F;
  if (!setup.curvature) {
    material.stiffness = 1;
    if (setup.bends) material.bend_stiffness = 1;
  }
  if (!setup.bends) material.bend_warp = material.bend_weft = 0;
  const auto asset = std::make_shared<const ClothAsset>(test::make_sheet({.nx = setup.size,
                                                                          .ny = setup.size,
                                                                          .width = side,
                                                                          .height = side,
                                                                          .charts_x = setup.charts,
                                                                          .charts_y = setup.charts,
                                                                          .horizontal = setup.swing}));
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.substeps = setup.substeps;
  settings.threads = setup.threads;
  settings.relaxation_steps = setup.relaxation_steps;
  settings.keep_momentum = setup.momentum;
  if (setup.plain) settings.path = SolverPath::plain;
  Solver solver(std::vector<ClothDesc>{{asset, material, {}}}, settings);
  std::vector<Pin> pins;
  if (setup.leashed) pins = leashes(*asset);
  for (const uint32_t v : asset->vertex_groups.front().source_vertex) {
    const uint32_t pixel = asset->binding[v].pixel[0];
    pins.push_back({pixel, asset->rest_position[pixel]});
  }
  solver.set_pins(0, pins);
  if (setup.ball || setup.swing || setup.cells) {
    const Vec3 center{0, -0.55F * side, setup.swing ? -0.5F * side : 3 * side};
    const float radius = setup.cells ? 0.5F * kSpacing : 0.15F * side;
    solver.set_colliders(std::vector<Collider>{{"ball", Sphere{center, radius}, 0.3F, {}}});
  }
  if (setup.wind) solver.set_wind({{1, 0, 2}, 0.3F, 1, 1, 0.2F});
  statistics = solver.statistics();
  return solver;
}

/// Swings to and fro by a centimetre.
void move_parent(Solver& solver, int frame) {
  solver.set_parent(0, {{0.01F * std::sin(0.1F * static_cast<float>(frame)), 0, 0}, {}, 1}, {0.5F, 0.5F, 0.5F});
}

void run(benchmark::State& state, const Setup& setup) {
  hwy::SetSupportedTargetsForTest(setup.avx2 ? HWY_AVX2 : 0);
  SolverStatistics statistics;
  Solver solver = make_solver(setup, statistics);
  const std::vector<Pin> pins = setup.leashed ? leashes(*solver.asset(0)) : std::vector<Pin>();
  // Long enough for the swinging sheet to lie on the ball.
  for (int frame = 0; frame < (setup.swing ? 60 : 3); ++frame) solver.step();
  int frame = 0;
  for (auto _ : state) {
    if (setup.parent) move_parent(solver, frame++);
    if (setup.leashed) solver.set_pins(0, pins);  // as a skin has them in every frame
    solver.step();
    solver.wait();
  }
  state.counters["solves"] =
      benchmark::Counter(static_cast<double>(statistics.springs) * setup.substeps,
                         benchmark::Counter::kIsIterationInvariantRate, benchmark::Counter::OneK::kIs1000);
}

struct Crowd {
  Crowd() { settings.backend = Backend::cpu; }
  ClothDesc sheet{.asset = std::make_shared<const ClothAsset>(test::make_sheet({.nx = 64, .ny = 64, .charts_x = 2}))};
  std::vector<ClothDesc> cloths = std::vector(20, sheet);
  SolverSettings settings;
};

/// A crowd and its first frame.
void make_crowd(benchmark::State& state) {
  const Crowd crowd;
  for (auto _ : state) {
    Solver solver(crowd.cloths, crowd.settings);
    solver.step();
  }
}

/// One of a crowd goes and another one comes in its place, up to the next frame.
void exchange_one(benchmark::State& state) {
  const Crowd crowd;
  Solver solver(crowd.cloths, crowd.settings);
  for (auto _ : state) {
    solver.remove_cloth(solver.cloths().front());
    benchmark::DoNotOptimize(solver.add_cloth(crowd.sheet));
    solver.step();
  }
}

/// A frame of the crowd.
void step_crowd(benchmark::State& state) {
  const Crowd crowd;
  Solver solver(crowd.cloths, crowd.settings);
  for (auto _ : state) solver.step();
}

/// Capes beside each other, each with eight capsules of its own that go to and fro.
/// @param in_groups  each cape is told to meet its own only
void step_wearers(benchmark::State& state, bool in_groups) {
  constexpr uint32_t kWearers = 64, kInARow = 8, kGroups = 32;
  const auto asset = std::make_shared<const ClothAsset>(
      test::make_sheet({.nx = 32, .ny = 32, .width = 0.8F, .height = 1.2F, .charts_x = 2}));
  SolverSettings settings;
  settings.backend = Backend::cpu;
  settings.substeps = 8;
  std::vector<ClothDesc> capes;
  for (uint32_t i = 0; i < kWearers; ++i) {
    ClothDesc& cape = capes.emplace_back(ClothDesc{.asset = asset});
    cape.material = find_material_preset("cotton")->material;
    cape.transform.translate = {2 * static_cast<float>(i % kInARow), 0, 2 * static_cast<float>(i / kInARow)};
    if (in_groups) cape.meets = 1U << i % kGroups;
  }
  Solver solver(capes, settings);
  std::vector<Collider> colliders;
  for (uint32_t i = 0; i < kWearers; ++i) {
    std::vector<Pin> pins;
    for (const uint32_t v : asset->vertex_groups.front().source_vertex) {
      const uint32_t pixel = asset->binding[v].pixel[0];
      pins.push_back({pixel, apply(capes[i].transform, asset->rest_position[pixel])});
    }
    solver.set_pins(i, pins);
    for (int k = 0; k < 8; ++k) {
      const auto n = static_cast<float>(k);
      const Vec3 at = capes[i].transform.translate + Vec3{0.1F * (n - 4), -0.1F * n, -0.12F};
      Collider& capsule = colliders.emplace_back();
      capsule = {std::to_string(i) + " " + std::to_string(k), Capsule{at, at + Vec3{0, 0.1F, 0}, 0.08F, 0.08F}};
      if (in_groups) capsule.groups = capes[i].meets;
    }
  }
  float frame = 0;
  const auto step = [&] {
    frame += 1;
    for (Collider& c : colliders) c.pose.translate = {0, 0, 0.03F * std::sin(0.1F * frame)};
    solver.set_colliders(colliders);
    solver.step();
  };
  constexpr int kSettled = 40;  // frames after it was pinned
  for (int f = 0; f < kSettled; ++f) step();
  for (auto _ : state) step();
}

const std::vector<std::pair<const char*, Setup>> kSetups{
    {"sheet/100", {}},
    {"sheet/100/plain", {.plain = true}},
    {"sheet/100/curvature", {.curvature = true}},
    {"sheet/100/no_attachments", {.attached = false}},
    {"sheet/100/ball_far_away", {.ball = true}},
    {"sheet/100/swing", {.swing = true}},
    {"sheet/100/wind", {.wind = true}},
    {"sheet/100/avx2", {.avx2 = true}},
    {"sheet/100/swing/avx2", {.swing = true, .avx2 = true}},
    {"sheet/100/relaxation_2", {.relaxation_steps = 2}},
    {"sheet/100/substeps_80", {.substeps = 80}},
    {"sheet/100/substeps_96_fine", {.substeps = 96}},
    {"sheet/100/curvature/momentum", {.curvature = true, .momentum = true}},
    {"sheet/100/collide_cells", {.cells = true}},
    {"sheet/100/parent", {.parent = true}},
    {"sheet/100/parent/ball_far_away", {.ball = true, .parent = true}},
    {"sheet/100/parent/swing", {.swing = true, .parent = true}},
    {"sheet/100/leashed", {.wind = true, .leashed = true}},
    {"sheet/100/two_threads", {.threads = 2}},
    {"sheet/100/charts_2x2", {.charts = 2}},
    {"sheet/100/zeller", {.substeps = 1, .attached = false, .bends = false}},
    {"sheet/64", {.size = 64}},
    {"sheet/256", {.size = 256}},
    {"sheet/256/avx2", {.size = 256, .avx2 = true}},
    {"sheet/256/plain", {.size = 256, .plain = true}},
    {"sheet/256/two_threads", {.size = 256, .threads = 2}},
    {"sheet/1024", {.size = 1024, .substeps = 4}},
    {"sheet/1024/plain", {.size = 1024, .substeps = 4, .plain = true}},
};

}  // namespace

int main(int argc, char** argv) {
  for (const auto& [name, setup] : kSetups) {
    benchmark::RegisterBenchmark(name, [setup = setup](benchmark::State& state) { run(state, setup); })
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  const auto of_crowd = [](const char* name, void (*function)(benchmark::State&)) {
    benchmark::RegisterBenchmark(name, function)->Unit(benchmark::kMillisecond)->UseRealTime();
  };
  of_crowd("crowd/20x64/make", make_crowd);
  of_crowd("crowd/20x64/exchange_one", exchange_one);
  of_crowd("crowd/20x64/step", step_crowd);
  of_crowd("crowd/64x32/capsules", [](benchmark::State& state) { step_wearers(state, false); });
  of_crowd("crowd/64x32/capsules_in_groups", [](benchmark::State& state) { step_wearers(state, true); });
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
