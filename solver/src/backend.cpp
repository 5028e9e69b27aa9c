// SPDX-License-Identifier: Apache-2.0
// Which passes a cloth needs in a frame.

#include "backend.h"

namespace geocloth {

ScheduleOptions schedule_options(const SimulationData& data, uint32_t cloth, const FrameInput& frame) {
  const ClothData& c = data.cloths[cloth];
  const ClothFrame& f = frame.cloths[cloth];
  return {.relaxation_steps = data.relaxation_steps,
          .air = f.params.air != 0,
          .pins = !f.pins.empty(),
          .splits = c.split_rows() > 0,
          .bending = c.bending,
          .fine = data.fine,
          .attachments = c.attachments && !f.pins.empty(),
          .collide = !frame.shapes.empty() || f.params.max_step > 0,
          .check = data.check,
          .seam_colors = c.seam_colors()};
}

}  // namespace geocloth
