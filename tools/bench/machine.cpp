// SPDX-License-Identifier: GPL-3.0-or-later
// The two ceilings of a roofline, measured: bytes copied and floating-point operations, each as the best of several
// short runs, because whatever else runs on the machine can only lower them.
#include "bench/machine.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <functional>
#include <thread>
#include <vector>

#include "bench/arithmetic.h"
#include "geocloth/solver/device.h"

namespace geocloth {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kRuns = 5;
constexpr double kRunSeconds = 0.01;
constexpr uint64_t kBeyondCaches = 256U << 20U;  // [B] of all threads together

/// Runs work() in every thread at once until the time is up; returns calls per second of all of them, best of some
/// runs.
double best_rate(uint32_t threads, const std::function<void(uint32_t)>& work) {
  double best = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::vector<double> rate(threads, 0);
    std::atomic<uint32_t> ready{0};
    const auto measure = [&](uint32_t thread) {
      work(thread);  // pages and caches
      ++ready;
      while (ready < threads) std::this_thread::yield();
      const auto start = Clock::now();
      double seconds = 0, calls = 0;
      while (seconds < kRunSeconds) {
        work(thread);
        ++calls;
        seconds = std::chrono::duration<double>(Clock::now() - start).count();
      }
      rate[thread] = calls / seconds;
    };
    {
      std::vector<std::jthread> others;
      for (uint32_t t = 1; t < threads; ++t) others.emplace_back(measure, t);
      measure(0);
    }
    double sum = 0;
    for (const double r : rate) sum += r;
    best = std::max(best, sum);
  }
  return best;
}

}  // namespace

double measure_copy_rate(uint32_t threads, uint64_t working_set) {
  const size_t half = std::max<size_t>(4096, working_set / 2 / threads);
  std::vector<std::vector<std::byte>> from(threads), to(threads);
  for (uint32_t t = 0; t < threads; ++t) {
    from[t].resize(half);
    to[t].resize(half);
  }
  const double rate = best_rate(threads, [&](uint32_t t) {
    std::memcpy(to[t].data(), from[t].data(), half);
    std::swap(to[t], from[t]);
  });
  return rate * 2 * static_cast<double>(half);
}

double measure_arithmetic_rate(uint32_t threads) {
  constexpr uint32_t kRounds = 20000;
  std::vector<float> sink(threads);
  double operations = 0;
  const double rate = best_rate(threads, [&](uint32_t t) {
    const ArithmeticRun run = run_arithmetic(kRounds);
    sink[t] = run.result;
    if (t == 0) operations = run.operations;
  });
  return rate * operations;
}

MachineInfo measure_machine() {
  constexpr double kGiga = 1e9;
  MachineInfo machine;
  for (const DeviceInfo& device : enumerate_devices())
    if (device.backend == Backend::cpu) machine.cpu = device.name;
  machine.cores = std::max(1U, std::thread::hardware_concurrency());
  machine.copy_gb_per_s = measure_copy_rate(machine.cores, kBeyondCaches) / kGiga;
  machine.gflops = measure_arithmetic_rate(machine.cores) / kGiga;
  return machine;
}

}  // namespace geocloth
