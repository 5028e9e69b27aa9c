// SPDX-License-Identifier: GPL-3.0-or-later
// geocloth bench: measures the solver on scenes of its own, in every size and number of substeps that is asked for.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <fmt/format.h>
#include <hwy/targets.h>

#include "bench/bench_report.h"
#include "bench/bench_run.h"
#include "bench/bench_scene.h"
#include "bench/machine.h"
#include "command.h"
#include "geocloth/solver/device.h"
#include "options.h"
#include "progress.h"
#include "scene_input.h"

namespace geocloth {
namespace {

constexpr uint32_t kMinSize = 8;
constexpr uint32_t kMaxSize = 4096;
constexpr uint32_t kMaxSubsteps = 256;
constexpr BenchBudget kFullBudget{300, 2.0};
constexpr BenchBudget kQuickBudget{60, 0.5};

struct BenchArguments {
  Backend backend = Backend::automatic;
  std::string device, scene;
  uint32_t threads = 0, size = 0, substeps = 0;  ///< 0: not given
  SolverPath path = SolverPath::automatic;
  int64_t vectors = 0;  ///< widest ones that the cpu may use, of Highway's targets; 0: any
  bool quick = false, json = false, quiet = false;
  std::vector<std::filesystem::path> compare;
};

/// Scene, size, substeps, backend: what stretch follows from. Threads change no bit.
using StretchCase = std::tuple<std::string_view, uint32_t, uint32_t, Backend>;

struct Case {
  const BenchSceneKind* kind;
  uint32_t size, substeps;
  Backend backend;
  uint32_t threads;
};

std::vector<uint32_t> asked_or(uint32_t asked, const std::vector<uint32_t>& otherwise) {
  return asked > 0 ? std::vector<uint32_t>{asked} : otherwise;
}

/// The cpu with one thread and with all, then a device. Nothing asked for: the cpu and a real GPU if there is one; only
/// a name: what goes by it.
std::vector<std::pair<Backend, uint32_t>> backends_of(const BenchArguments& options) {
  std::vector<std::pair<Backend, uint32_t>> backends;
  const uint32_t cores = default_solver_settings().threads;
  if (options.backend == Backend::automatic && !options.device.empty()) {
    return {{Backend::automatic, asked_or(options.threads, {1U}).front()}};
  }
  if (options.backend != Backend::vulkan) {
    for (const uint32_t threads : asked_or(options.threads, cores > 1 ? std::vector{1U, cores} : std::vector{1U})) {
      backends.emplace_back(Backend::cpu, threads);
    }
  }
  const std::vector<DeviceInfo> devices = enumerate_devices();
  const bool gpu = std::any_of(devices.begin(), devices.end(), [](const DeviceInfo& device) {
    return device.backend == Backend::vulkan && device.chosen_automatically;
  });
  if (options.backend == Backend::vulkan || (options.backend == Backend::automatic && gpu)) {
    backends.emplace_back(Backend::vulkan, 1U);
  }
  return backends;
}

/// None where the scene takes too long for a quick run that did not ask for it.
std::vector<uint32_t> sizes_of(const BenchSceneKind& kind, const BenchArguments& options) {
  if (!options.quick) return asked_or(options.size, kind.sizes);
  if (!kind.quick_sizes.empty()) return asked_or(options.size, kind.quick_sizes);
  return options.scene.empty() ? std::vector<uint32_t>{} : asked_or(options.size, {kind.sizes.front()});
}

std::vector<Case> cases_of(const BenchArguments& options) {
  std::vector<Case> cases;
  const auto backends = backends_of(options);
  for (const BenchSceneKind& kind : bench_scene_kinds()) {
    if (!options.scene.empty() && options.scene != kind.name) continue;
    for (const uint32_t size : sizes_of(kind, options)) {
      for (const uint32_t substeps : asked_or(options.substeps, options.quick ? kind.quick_substeps : kind.substeps)) {
        for (const auto& [backend, threads] : backends) cases.push_back({&kind, size, substeps, backend, threads});
      }
    }
  }
  return cases;
}

/// Highway numbers better instruction sets lower.
void use_vectors(int64_t widest) {
  if (widest != 0) hwy::DisableTargets(widest - 1);
}

/// Lines appear as they are measured; with --json nothing but the JSON.
void measure(const BenchArguments& options) {
  use_vectors(options.vectors);
  const MachineInfo machine = measure_machine();
  const std::vector<Case> cases = cases_of(options);
  if (!options.json) fmt::print("{}\n{}\n", describe(machine), bench_table_head());
  std::vector<BenchResult> results;
  std::map<StretchCase, StretchStatistics> stretches;
  BenchScene scene;
  ProgressDisplay progress("bench", options.quiet || !options.json);
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& c = cases[i];
    progress.show("measure", static_cast<double>(i) / static_cast<double>(cases.size()));
    if (i == 0 || c.kind != cases[i - 1].kind || c.size != cases[i - 1].size) scene = c.kind->make(c.size);
    SolverSettings settings;
    settings.backend = c.backend;
    settings.device = options.device;
    settings.threads = c.threads;
    settings.substeps = c.substeps;
    settings.path = options.path;
    settings.frame_time = scene.frame_time;
    const StretchCase same{c.kind->name, c.size, c.substeps, c.backend};
    const auto known = stretches.find(same);
    results.push_back(run_bench(std::string(c.kind->name), scene, settings, options.quick ? kQuickBudget : kFullBudget,
                                known == stretches.end() ? std::nullopt : std::optional(known->second)));
    stretches[same] = results.back().stretch;
    if (options.json) continue;
    fmt::print("{}\n", bench_table_line(results.back()));
    std::fflush(stdout);
  }
  if (options.json) fmt::print("{}", bench_report(machine, results));
}

}  // namespace

CommandRun add_bench(CLI::App& app) {
  auto options = std::make_shared<BenchArguments>();
  add_choice<Backend>(app, "--backend", options->backend,
                      {{"auto", Backend::automatic}, {"cpu", Backend::cpu}, {"vulkan", Backend::vulkan}},
                      "what to measure; auto: the cpu, and a real GPU if there is one");
  add_text(app, "--device", "NAME", options->device, "part of a device's name as `geocloth devices` lists it",
           "default the first of the backend");
  add_number<uint32_t>(app, "--threads", "N", options->threads, 1, kMaxThreads, "threads", "for the cpu backend",
                       "1 and all of the machine's");
  add_choice<SolverPath>(
      app, "--path", options->path,
      {{"auto", SolverPath::automatic},
       {"plain", SolverPath::plain},
       {"tiled", SolverPath::tiled},
       {"tiny", SolverPath::tiny}},
      "how the passes run, with the same results: plain one by one; tiled and tiny several at once in "
      "a GPU's shared memory, where the cloth fits; auto the fastest");
  add_choice<int64_t>(app, "--vectors", options->vectors, {{"any", 0}, {"avx2", HWY_AVX2}, {"sse4", HWY_SSE4}},
                      "the best instruction set that the cpu backend may use, to compare with machines that have less");
  add_number<uint32_t>(app, "--size", "N", options->size, kMinSize, kMaxSize, "points",
                       "side of the sheets; a garment has about N x N points", "the scene's own sizes");
  add_number<uint32_t>(app, "--substeps", "N", options->substeps, 1, kMaxSubsteps, "substeps", "of a frame",
                       "the scene's own numbers");
  std::vector<std::pair<std::string, std::string>> scenes;
  for (const BenchSceneKind& kind : bench_scene_kinds()) scenes.emplace_back(kind.name, kind.name);
  std::string about = "what to simulate: ";
  for (const BenchSceneKind& kind : bench_scene_kinds()) {
    about += fmt::format("{}{}, {}", &kind == bench_scene_kinds().data() ? "" : "; ", kind.name, kind.summary);
  }
  add_choice<std::string>(app, "--scene", options->scene, scenes, about, "all of them");
  app.add_flag("--quick", options->quick, "few sizes, short runs: all of it within 30 s [default off]");
  app.add_flag("--json", options->json, "print JSON for programs [default off]");
  app.add_option("--compare", options->compare,
                 "compare two files that --json wrote instead of measuring: the older one first [default none]")
      ->option_text("OLD.json NEW.json")
      ->expected(2);
  add_quiet(app, options->quiet);
  return [options] {
    if (options->compare.empty()) {
      measure(*options);
    } else {
      fmt::print("{}", compare_bench_reports(options->compare[0], options->compare[1]));
    }
  };
}

}  // namespace geocloth
