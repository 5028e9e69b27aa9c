// SPDX-License-Identifier: GPL-3.0-or-later
// Times frames one by one, with the device's work waited for. The roofline is that of the best algorithm known to us,
// which reads and writes every pixel once per substep (60 bytes), or of the springs' arithmetic, whichever takes
// longer.
#include "bench/bench_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>

#include "bench/machine.h"
#include "geocloth/solver/device.h"

namespace geocloth {
namespace {

using Clock = std::chrono::steady_clock;

constexpr uint32_t kWarmUpFrames = 2;
constexpr uint32_t kPassFrames = 3, kPassFramesOfMotion = 90;
/// Position and previous position, 16 bytes each, read and the former two written: 60 with the rest data of four
/// springs and two bends in half precision.
constexpr double kBytesPerParticle = 60;
constexpr double kOperationsPerSpring = 34;  ///< as counted in shaders/lib/spring.h; a root or division is one

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A scene being played.
class Play {
 public:
  Play(const BenchScene& scene, const SolverSettings& settings) : scene_(scene), solver_(scene.cloths, settings) {
    solver_.set_colliders(scene.colliders);
    for (uint32_t c = 0; c < scene.cloths.size(); ++c) solver_.set_pins(c, scene.pins[c]);
  }
  void step() {
    ++frames_;
    if (scene_.colliders_at != nullptr) solver_.set_colliders(scene_.colliders_at(frames_ * scene_.frame_time));
    solver_.step();
  }
  [[nodiscard]] uint32_t frames() const { return frames_; }
  [[nodiscard]] Solver& solver() { return solver_; }

 private:
  const BenchScene& scene_;
  Solver solver_;
  uint32_t frames_ = 0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> time_frames(Play& play, const BenchBudget& budget) {
  const auto start = Clock::now();
  std::vector<double> seconds;
  while (play.frames() < budget.frames) {
    if (!seconds.empty() && seconds_since(start) > budget.seconds) break;
    const auto frame_start = Clock::now();
    play.step();
    play.solver().wait();
    if (play.frames() > kWarmUpFrames || seconds_since(start) > budget.seconds) {
      seconds.push_back(seconds_since(frame_start));
    }
  }
  return seconds;
}

std::vector<std::pair<std::string, double>> time_passes(const BenchScene& scene, SolverSettings settings) {
  settings.timings = true;
  Play play(scene, settings);
  const uint32_t frames = scene.colliders_at != nullptr || scene.falls ? kPassFramesOfMotion : kPassFrames;
  while (play.frames() < frames) play.step();
  std::vector<std::pair<std::string, double>> passes;
  for (const PassTiming& pass : play.solver().statistics().passes) {
    passes.emplace_back(pass.pass, 1e3 * pass.seconds / frames);
  }
  return passes;
}

StretchStatistics stretch_of(const BenchScene& scene, Play& play) {
  const auto last = static_cast<uint32_t>(std::lround(scene.stretch_after / scene.frame_time));
  while (play.frames() < last) play.step();
  StretchStatistics all;
  std::vector<Vec3> positions;
  for (uint32_t c = 0; c < scene.cloths.size(); ++c) {
    play.solver().read_positions(c, positions);
    const StretchStatistics one = measure_stretch(*scene.cloths[c].asset, 1, positions);
    all.max = std::max(all.max, one.max);
    all.p99 = std::max(all.p99, one.p99);
    all.mean += one.mean / static_cast<double>(scene.cloths.size());
  }
  return all;
}

/// A real GPU's ceilings are not known here; a software device has all cores of this machine.
std::optional<uint32_t> host_threads(const BenchResult& result) {
  if (result.backend == to_string(Backend::cpu)) return result.threads;
  const std::vector<DeviceInfo> devices = enumerate_devices();
  const bool software = std::any_of(devices.begin(), devices.end(), [&](const DeviceInfo& device) {
    return device.name == result.device && device.type == "software";
  });
  if (!software) return {};
  return std::max(1U, std::thread::hardware_concurrency());
}

/// [s] below which no frame of this work can be on this machine; 0 when that is not known.
double shortest_frame(const BenchResult& result) {
  const std::optional<uint32_t> threads = host_threads(result);
  if (!threads) return 0;
  const double bytes = kBytesPerParticle * static_cast<double>(result.particles);
  const double operations = kOperationsPerSpring * static_cast<double>(result.springs);
  const double copy = bytes / measure_copy_rate(*threads, static_cast<uint64_t>(bytes));
  const double arithmetic = operations / measure_arithmetic_rate(*threads);
  return result.substeps * std::max(copy, arithmetic);
}

}  // namespace

BenchResult run_bench(const std::string& name, const BenchScene& scene, const SolverSettings& settings,
                      const BenchBudget& budget, const std::optional<StretchStatistics>& stretch) {
  Play play(scene, settings);
  BenchResult result;
  const std::vector<double> seconds = time_frames(play, budget);
  result.frames = play.frames();
  const SolverStatistics statistics = play.solver().statistics();
  const double frame = median(seconds);
  result.scene = name;
  result.backend = statistics.backend;
  result.device = statistics.device;
  result.path = statistics.path;
  result.threads = statistics.threads;
  result.cloths = static_cast<uint32_t>(scene.cloths.size());
  result.width = scene.cloths.front().asset->width;
  result.height = scene.cloths.front().asset->height;
  result.particles = statistics.particles;
  result.springs = statistics.springs;
  result.substeps = settings.substeps;
  result.ms_per_frame = 1e3 * frame;
  result.ms_per_frame_min = 1e3 * *std::min_element(seconds.begin(), seconds.end());
  result.springs_per_second = static_cast<double>(statistics.springs) * settings.substeps / frame;
  result.roofline_share = shortest_frame(result) / frame;
  result.memory_bytes = statistics.memory_bytes;
  result.stretch = stretch ? *stretch : stretch_of(scene, play);
  result.passes_ms = time_passes(scene, settings);
  return result;
}

}  // namespace geocloth
