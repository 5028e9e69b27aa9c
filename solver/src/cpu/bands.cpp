// SPDX-License-Identifier: Apache-2.0
// Bands of rows: each thread sweeps through its own and leaves out what needs the neighbours' rows, and when all are
// done, that is made up for (trapezoids and the triangles between them; Frigo and Strumpen 2005, "Cache oblivious
// stencil computations").

#include "cpu/bands.h"

#include <algorithm>
#include <numeric>

namespace geocloth::cpu {
namespace {

/// Entries of the list that a pass goes through.
size_t length_of(const PassStep& step, const ClothState& state) {
  if (is_over_seams(step.pass))
    return state.data.seam_color_offset[step.group + 1] - state.data.seam_color_offset[step.group];
  const bool over_rows = step.pass == Pass::stitch || step.pass == Pass::normals_stitch;
  return over_rows ? state.data.split_rows() : state.pixel_count();
}

bool runs_alone(const PassStep& step, const ClothState& state) {
  return step.pass == Pass::check_copies || step.pass == Pass::check_colliders || length_of(step, state) <= kRowGrain;
}

std::vector<uint32_t> rows_of_bands(const SweepPlan& plan, const ClothState& state, const std::vector<Run>& runs,
                                    uint32_t threads) {
  const uint32_t height = state.data.height, width = state.data.width;
  uint32_t least = 1;  // the gaps at a band's sides must not meet
  for (const SweepPlan::Part& part : plan.parts()) {
    const auto* sweep = std::get_if<Sweep>(&part);
    if (sweep != nullptr) least = std::max(least, sweep->last_lag + sweep->last_rise + sweep->longest_reach);
  }
  const uint32_t count = std::clamp(height / least, 1U, threads);
  std::vector<uint64_t> pixels(height + 1, 0);  // in the rows above
  for (const Run& run : runs) pixels[run.first / width + 1] += run.last - run.first;
  std::partial_sum(pixels.begin(), pixels.end(), pixels.begin());
  std::vector<uint32_t> rows{0};
  for (uint32_t k = 1; k < count; ++k) {
    const auto row = std::lower_bound(pixels.begin(), pixels.end(), pixels.back() * k / count) - pixels.begin();
    rows.push_back(std::clamp(static_cast<uint32_t>(row), rows.back() + least, height - (count - k) * least));
  }
  rows.push_back(height);
  return rows;
}

}  // namespace

BandPlan plan_bands(const SweepPlan& plan, const ClothState& state, const std::vector<Run>& runs, uint32_t threads) {
  BandPlan bands;
  bands.rows = rows_of_bands(plan, state, runs, threads);
  const uint32_t count = bands.count();
  using Kind = BandPhase::Kind;
  for (uint32_t k = 0; k < plan.parts().size(); ++k) {
    const auto* step = std::get_if<PassStep>(&plan.parts()[k]);
    if (step == nullptr) {
      bands.phases.push_back({Kind::bands, k, k + 1, count});
      if (count > 1) bands.phases.push_back({Kind::gaps, k, k + 1, count - 1});
    } else if (!runs_alone(*step, state)) {
      bands.phases.push_back({Kind::shares, k, k + 1, count});
    } else if (!bands.phases.empty() && bands.phases.back().kind == Kind::alone) {
      ++bands.phases.back().last_part;
    } else {
      bands.phases.push_back({Kind::alone, k, k + 1, 1});
    }
  }
  return bands;
}

SweepBand band_of_task(const BandPlan& plan, const Sweep& sweep, BandPhase::Kind kind, uint32_t task) {
  const uint32_t end = plan.rows.back() + sweep.last_lag, next = plan.rows[task + 1];
  SweepBand band;
  if (kind == BandPhase::Kind::gaps) {
    band = {.first_time = next, .end_time = std::min(end, next + sweep.last_lag + sweep.last_rise)};
    band.high = next;
    band.lower = true;
  } else {
    band = {.first_time = plan.rows[task], .end_time = task + 1 < plan.count() ? next : end};
    band.low = plan.rows[task];
    band.upper = task > 0;
  }
  return band;
}

}  // namespace geocloth::cpu
