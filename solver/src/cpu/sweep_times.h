// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <variant>
#include <vector>

#include "cpu/sweep_plan.h"

namespace geocloth::cpu {

using PassSeconds = std::array<double, kPasses.size()>;

/// Where the time of a plan goes. Reading the clock for every row takes an eighth of the time, so the passes of a sweep
/// are told apart in one substep only, and share out what the sweep took in all.
class SweepTimes {
 public:
  /// Forgets what was measured.
  /// @param bands  each is measured by one thread
  void begin(const SweepPlan& plan, uint32_t bands) {
    const std::vector<SweepPlan::Part>& parts = plan.parts();
    bands_.resize(bands);
    for (Band& band : bands_) {
      band.part.assign(parts.size(), 0.0);
      band.passes.resize(parts.size());
      for (size_t n = 0; n < parts.size(); ++n) {
        const auto* sweep = std::get_if<Sweep>(&parts[n]);
        band.passes[n].assign(sweep != nullptr ? sweep->ops.size() : 0, 0.0);
      }
    }
    start_ = Clock::now();
  }

  /// For SweepFrame::seconds, of a sweep.
  [[nodiscard]] double* passes_of(uint32_t band, uint32_t part) { return bands_[band].passes[part].data(); }

  /// Runs a part of the plan in a band, or some of it.
  template <class Work>
  void measure(uint32_t band, uint32_t part, const Work& work) {
    const auto start = Clock::now();
    work();
    bands_[band].part[part] += since(start);
  }

  /// Adds the time since begin() to the passes that it was spent on: as one sees it on the clock, however many threads
  /// there are.
  void end(const SweepPlan& plan, PassSeconds& seconds) const {
    double measured = 0;
    for (const Band& band : bands_)
      for (const double part : band.part) measured += part;
    const double scale = measured > 0 ? since(start_) / measured : 0;
    const std::vector<SweepPlan::Part>& parts = plan.parts();
    for (size_t n = 0; n < parts.size(); ++n) {
      double of_part = 0;
      for (const Band& band : bands_) of_part += scale * band.part[n];
      if (const auto* step = std::get_if<PassStep>(&parts[n])) {
        seconds[static_cast<size_t>(step->pass)] += of_part;
      } else {
        share_out(std::get<Sweep>(parts[n]), n, of_part, seconds);
      }
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Band {
    std::vector<double> part;                 ///< [s] of each part of the plan
    std::vector<std::vector<double>> passes;  ///< [s] of each pass of those that are sweeps, in one substep
  };

  static double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

  void share_out(const Sweep& sweep, size_t part, double of_part, PassSeconds& seconds) const {
    double all = 0;
    for (const Band& band : bands_)
      for (const double pass : band.passes[part]) all += pass;
    if (!(all > 0)) {  // no pass had anything to do
      seconds[static_cast<size_t>(sweep.ops.front().pass)] += of_part;
      return;
    }
    for (const Band& band : bands_)
      for (size_t k = 0; k < sweep.ops.size(); ++k)
        seconds[static_cast<size_t>(sweep.ops[k].pass)] += of_part * band.passes[part][k] / all;
  }

  std::vector<Band> bands_;
  Clock::time_point start_;
};

}  // namespace geocloth::cpu
