// SPDX-License-Identifier: Apache-2.0
// The order of the passes, once for both backends. A family of springs is followed by a stitch: after each family the
// length of a hanging sheet is within 0.02 % of the uncut one, after all of them only within 0.3 % (measured). What is
// projected last is met best, so the structural springs are: a sheet on a ball is stretched a quarter less (measured).

#include "pass.h"

#include <algorithm>
#include <cstddef>

#include "lib/bend_groups.h"
#include "lib/cell_groups.h"
#include "lib/span.h"
#include "shared/layout.h"

namespace geocloth {
namespace {

constexpr uint32_t kGroupsPerFamily = shader::kSpringGroups / 3;

void add_family(std::vector<PassStep>& steps, Pass pass, uint32_t first_group, uint32_t relaxation) {
  for (uint32_t g = 0; g < kGroupsPerFamily; ++g) steps.push_back({pass, first_group + g, relaxation});
}

void add_normals(std::vector<PassStep>& steps, const ScheduleOptions& options) {
  steps.push_back({Pass::normals});
  if (options.splits) steps.push_back({Pass::normals_stitch});
}

/// Of the threads, in the list over seams.
uint32_t first_sewing_color(const ScheduleOptions& options) {
  return options.seam_bend_colors + options.seam_span_colors + options.seam_tie_colors + options.whole_tie_colors;
}

void add_seam_bends(std::vector<PassStep>& steps, const ScheduleOptions& options, uint32_t relaxation) {
  if (options.bending == Bending::none) return;
  const bool springs = options.bending == Bending::springs;
  const auto add = [&](uint32_t first, uint32_t colors) {
    for (uint32_t color = first; color < first + colors; ++color)
      steps.push_back({springs ? Pass::seam_bends : Pass::seam_curvature, color, relaxation});
  };
  add(0, options.seam_bend_colors);
  add(first_sewing_color(options) + options.sewing_colors + options.more_sewing_colors, options.sewn_bend_colors);
}

void add_curvatures(std::vector<PassStep>& steps, const ScheduleOptions& options, uint32_t relaxation) {
  // Half of the steps there and half of them back: every second one back would converge more slowly. Six leave nothing
  // that could grow.
  constexpr uint32_t kEnough = 6;
  const bool goes_back = 2 * relaxation >= options.relaxation_steps && options.relaxation_steps < kEnough;
  const BendOrder order = !options.stiff_bends            ? BendOrder::forward
                          : options.relaxation_steps == 1 ? BendOrder::there_and_back
                          : goes_back                     ? BendOrder::backward
                                                          : BendOrder::forward;
  for (uint32_t k = 0; k < shader::kBendGroups; ++k) {
    const uint32_t g = order == BendOrder::backward ? shader::kBendGroups - 1 - k : k;
    steps.push_back({Pass::curvature, g, relaxation, order});
    if (order != BendOrder::there_and_back || g % 3 != 2) continue;
    for (const uint32_t back : {g - 1, g - 2}) steps.push_back({Pass::curvature, back, relaxation, order, true});
  }
}

void add_sewing(std::vector<PassStep>& steps, const ScheduleOptions& options, bool more, uint32_t relaxation) {
  const uint32_t colors = options.sewing_colors + (more ? options.more_sewing_colors : 0);
  const uint32_t first = first_sewing_color(options);
  for (uint32_t color = 0; color < colors; ++color) steps.push_back({Pass::sew, first + color, relaxation});
}

void add_bending(std::vector<PassStep>& steps, const ScheduleOptions& options, uint32_t relaxation) {
  if (options.bending == Bending::none) return;
  if (options.bending == Bending::springs) {
    add_family(steps, Pass::bending, 2 * kGroupsPerFamily, relaxation);
  } else {
    add_curvatures(steps, options, relaxation);
  }
}

void add_checks(std::vector<PassStep>& steps, const ScheduleOptions& options) {
  if (options.check && options.splits) steps.push_back({Pass::check_copies});
  if (options.check && options.collide) steps.push_back({Pass::check_colliders});
}

void add_relaxation(std::vector<PassStep>& steps, const ScheduleOptions& options, uint32_t relaxation) {
  add_family(steps, Pass::shear, kGroupsPerFamily, relaxation);
  add_sewing(steps, options, false, relaxation);
  if (options.splits) steps.push_back({Pass::stitch, 0, relaxation});
  add_seam_bends(steps, options, relaxation);
  if (options.spans) {
    for (uint32_t color = 0; color < options.seam_span_colors; ++color)
      steps.push_back({Pass::seam_spans, options.seam_bend_colors + color, relaxation});
    const uint32_t lengths = options.attachments ? 1 : 2;
    for (uint32_t g = 0; g < lengths * shader::kSpanGroups; ++g) steps.push_back({Pass::spans, g, relaxation});
  }
  add_bending(steps, options, relaxation);
  add_family(steps, Pass::structural, 0, relaxation);
  add_sewing(steps, options, true, relaxation);
  if (options.splits) steps.push_back({Pass::stitch, 0, relaxation});
}

}  // namespace

std::vector<PassStep> substep_schedule(const ScheduleOptions& options) {
  std::vector<PassStep> steps;
  if (options.rescale) steps.push_back({Pass::rescale});
  if (options.air) add_normals(steps, options);
  steps.push_back({Pass::predict});
  if (options.pins) steps.push_back({Pass::pins});
  for (uint32_t r = 0; r < options.relaxation_steps; ++r) add_relaxation(steps, options, r);
  if (options.fine) steps.push_back({Pass::settle});
  if (options.attachments) steps.push_back({Pass::limit});
  if (options.self_collision) {
    for (const Pass pass :
         {Pass::self_drift, Pass::self_clear, Pass::self_insert, Pass::self_find, Pass::self_push, Pass::self_move})
      steps.push_back({pass});
  }
  if (options.inter_collision) steps.insert(steps.end(), inter_schedule().begin(), inter_schedule().end());
  for (uint32_t r = 0; r < options.cell_rounds; ++r) {
    for (uint32_t g = 0; g < shader::kCellGroups; ++g) steps.push_back({Pass::collide_cells, g});
    if (options.splits) steps.push_back({Pass::stitch_contacts});
  }
  if (options.collide) steps.push_back({Pass::collide});
  add_checks(steps, options);
  return steps;
}

SubstepHalves substep_halves(const ScheduleOptions& options) {
  const std::vector<PassStep> steps = substep_schedule(options);
  const std::span<const PassStep> middle = inter_schedule();
  const auto first = std::search(steps.begin(), steps.end(), middle.begin(), middle.end());
  const auto last = first == steps.end() ? first : first + static_cast<std::ptrdiff_t>(middle.size());
  return {{steps.begin(), first}, {last, steps.end()}};
}

std::span<const PassStep> inter_schedule() {
  static constexpr std::array<PassStep, 7> kSteps{{{Pass::inter_gather},
                                                   {Pass::inter_drift},
                                                   {Pass::inter_clear},
                                                   {Pass::inter_insert},
                                                   {Pass::inter_find},
                                                   {Pass::inter_push},
                                                   {Pass::inter_move}}};
  return kSteps;
}

std::vector<PassStep> finish_schedule(const ScheduleOptions& options) {
  // Rounds of ties after each sweep of lines. What one spring gives, the next one gets, and lines end at seams: where a
  // garment with seams hangs, ties carry its weight over them and a second sweep of lines takes it on to the pins. What
  // is left then is in single springs, 9 % in a draped dress.
  const bool hangs_by_seams = options.attachments && options.splits;
  const std::vector<uint32_t> rounds = hangs_by_seams ? std::vector<uint32_t>{1, 5} : std::vector<uint32_t>{3};
  std::vector<PassStep> steps;
  if (!options.ties) return steps;
  const auto add_whole_ties = [&](bool last) {
    const uint32_t first = options.seam_bend_colors + options.seam_span_colors + options.seam_tie_colors;
    for (uint32_t color = 0; color < options.whole_tie_colors; ++color)
      steps.push_back({Pass::whole_ties, first + color, last ? 1U : 0U});
  };
  const auto add_round = [&](bool last) {
    add_whole_ties(false);
    for (uint32_t g = 0; g < kGroupsPerFamily; ++g) steps.push_back({Pass::ties, g, last && g % 2 == 1 ? 1U : 0U});
    for (uint32_t color = 0; color < options.seam_tie_colors; ++color)
      steps.push_back({Pass::seam_spans, options.seam_bend_colors + options.seam_span_colors + color});
    add_sewing(steps, options, true, 0);
    if (options.splits) steps.push_back({Pass::stitch});
  };
  steps.push_back({Pass::hold_way});
  for (size_t sweep = 0; sweep < rounds.size(); ++sweep) {
    for (uint32_t direction = 0; direction < 2; ++direction) steps.push_back({Pass::lines, direction});
    for (uint32_t r = 0; r < rounds[sweep]; ++r) add_round(sweep + 1 == rounds.size() && r + 1 == rounds[sweep]);
  }
  add_whole_ties(true);
  steps.push_back({Pass::give_way});
  add_checks(steps, options);
  return steps;
}

std::vector<PassStep> frame_schedule(const ScheduleOptions& options) {
  std::vector<PassStep> steps;
  add_normals(steps, options);
  if (options.motion) steps.push_back({Pass::measure_motion, options.motion_word});
  return steps;
}

}  // namespace geocloth
