// SPDX-License-Identifier: Apache-2.0
// What both backends do alike: which passes a cloth needs in a frame, and which cloths are left.

#include "backend.h"

namespace geocloth {
namespace {

/// Compliances below so many times the inverse mass, both of a curvature, in the units of a projection.
constexpr float kStiffBends = 3;

}  // namespace

void renumber_parts(std::vector<InterPart>& parts, uint32_t removed) {
  std::erase_if(parts, [&](const InterPart& part) { return part.cloth == removed; });
  for (InterPart& part : parts)
    if (part.cloth > removed) --part.cloth;
}

ScheduleOptions schedule_options(const SimulationData& data, uint32_t cloth, const FrameInput& frame) {
  const ClothData& c = data.cloths[cloth];
  const ClothFrame& f = frame.cloths[cloth];
  const bool attached = c.attachments && !f.pins.empty();
  const bool slack = c.evenness == Evenness::squeezed || c.short_seams || f.slack_pins || f.params.air != 0;
  const bool spans = (c.attachments && f.params.collider_count > 0) || (attached && slack);
  return {.substeps = static_cast<uint32_t>(frame.substeps.size()),
          .relaxation_steps = data.relaxation_steps,
          .rescale = f.params.gravity_step.w != 1,
          .air = f.params.air != 0,
          .pins = !f.pins.empty(),
          .splits = c.split_rows() > 0,
          .bending = c.bending,
          .stiff_bends = c.bend_yield * f.params.inverse_dt2 < kStiffBends,
          .fine = data.fine,
          .attachments = attached,
          .spans = spans,
          .ties = (spans || (attached && c.evenness != Evenness::even)) && !f.pulled_apart && !data.fine &&
                  !f.held_open && !f.restless && !frame.may_sleep,
          .self_collision = f.params.self_points > 0,
          .inter_collision = f.params.inter_points > 0,
          .collide = f.params.collider_count > 0 || f.params.max_step > 0,
          .cell_rounds = f.params.collider_count == 0 ? 0 : f.cell_rounds,
          .check = data.check,
          .asleep = f.asleep,
          .motion = frame.measure_motion || f.params.carried_at >= 0,
          .motion_word = frame.motion_word,
          .seam_bend_colors = c.seam_bend_colors,
          .seam_span_colors = c.seam_span_colors,
          .seam_tie_colors = c.seam_tie_colors,
          .whole_tie_colors = c.whole_tie_colors,
          .sewing_colors = f.sewn ? c.sewing_colors : 0,
          .more_sewing_colors = f.sewn ? c.more_sewing_colors : 0,
          .sewn_bend_colors = f.sewn && f.seams_closed ? c.sewn_bend_colors : 0};
}

}  // namespace geocloth
