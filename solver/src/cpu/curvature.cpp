// SPDX-License-Identifier: Apache-2.0
// Bending on the cpu: shaders/cloth/curvature.comp and seam_curvature.comp, line by line of the image. Down the columns
// the bends that start in a row are next to each other; along a row every third pixel starts one.

#include "cpu/curvature.h"

#include <algorithm>

#include "cpu/line.h"
#include "cpu/seam_list.h"
#include "lib/bend.h"
#include "lib/bend_groups.h"

namespace geocloth::cpu {
namespace {

struct BendLine {
  PointLine a, middle, b;
  const float *h1, *h2, *rest, *compliance;
  float* multiplier;  ///< only with several relaxation steps
};

/// Projects the bend over point i of three lines. @return the new multiplier
template <uint32_t fine>
inline float project_bend(const PointLine& a, const PointLine& middle, const PointLine& b, size_t i, float chord,
                          float rest, float compliance, float multiplier, Fine<fine> mode) {
  const float wa = a.inverse_mass[i], wm = middle.inverse_mass[i], wb = b.inverse_mass[i];
  const shader::BendMove move =
      shader::bend_move(way_between(middle, a, i, mode), wa, wm, way_between(middle, b, i, mode), wb, chord, rest,
                        compliance, multiplier);
  a.move(i, -move.step, wa * (1.F - chord) * a.yield_at(i));
  middle.move(i, move.step, wm * middle.yield_at(i));
  b.move(i, -move.step, wb * chord * b.yield_at(i));
  return move.multiplier;
}

template <size_t stride, bool accumulate, uint32_t fine>
void project_line(const BendLine line, uint32_t count, float inverse_dt2, float kept_multiplier, Fine<fine> mode) {
  GEOCLOTH_INDEPENDENT_TURNS
  for (size_t k = 0; k < count; ++k) {
    const size_t i = k * stride;
    const float sum = accumulate ? kept_multiplier * line.multiplier[i] : 0.F;
    const float next = project_bend(line.a, line.middle, line.b, i, shader::chord_share(line.h1[i], line.h2[i]),
                                    line.rest[i], line.compliance[i] * inverse_dt2, sum, mode);
    if constexpr (accumulate) line.multiplier[i] = next;
  }
}

template <size_t stride>
void project_line(const BendLine& line, uint32_t count, float inverse_dt2, float kept_multiplier, uint32_t fine) {
  with_fine(fine, [&](auto mode) {
    line.multiplier != nullptr ? project_line<stride, true>(line, count, inverse_dt2, kept_multiplier, mode)
                               : project_line<stride, false>(line, count, inverse_dt2, kept_multiplier, mode);
  });
}

}  // namespace

void curvature(const PassContext& context, ClothState& state, const PassStep& step) {
  const uint32_t width = state.data.width, height = state.data.height, group = step.group;
  const uint32_t component = shader::bend_component(group);
  const uint32_t fine = context.cloth.params.fine;
  const bool row = component == 4;
  if ((row ? width : height) < 3) return;
  const bool accumulate = context.relaxation_steps > 1;
  const float inverse_dt2 = context.cloth.params.inverse_dt2 * static_cast<float>(compliance_times(step));
  const float kept = step.relaxation > 0 ? 1.F : 0.F;
  const size_t offset = row ? 1 : width;

  const auto line_from = [&](size_t a) {
    return BendLine{PointLine(state, a, fine),
                    PointLine(state, a + offset, fine),
                    PointLine(state, a + 2 * offset, fine),
                    state.rest[component - 4].data() + a,
                    state.rest[component - 4].data() + a + offset,
                    state.rest[component].data() + a,
                    state.compliance[component].data() + a,
                    accumulate ? state.multiplier[component].data() + a : nullptr};
  };
  const auto along_row = [&](uint32_t y) {
    if (group + 2 >= width) return;
    project_line<3>(line_from(size_t{y} * width + group), (width - 2 - group + 2) / 3, inverse_dt2, kept, fine);
  };
  const auto down_columns = [&](uint32_t n) {
    const uint32_t y = 3 * n + group - 3;
    if (y + 2 >= height) return;
    project_line<1>(line_from(size_t{y} * width), width, inverse_dt2, kept, fine);
  };
  context.threads.for_range(row ? height : (height + 2) / 3, std::max(1U, kPixelGrain / width),
                            [&](uint32_t first, uint32_t last) {
                              for (uint32_t n = first; n < last; ++n) row ? along_row(n) : down_columns(n);
                            });
}

void seam_curvature(const PassContext& context, ClothState& state, const PassStep& step) {
  const float inverse_dt2 = context.cloth.params.inverse_dt2;
  for_seam_list(
      context, state, step, [=](const PointLine& pixels, const shader::SeamSpring& s, float multiplier, auto mode) {
        const PointLine a = pixels.from(s.a), m = pixels.from(s.middle), b = pixels.from(s.b),
                        c = pixels.from(s.beside);
        const float wa = a.inverse_mass[0], wm = m.inverse_mass[0], wb = b.inverse_mass[0], wc = c.inverse_mass[0];
        const shader::BendMove move = shader::turned_bend_move(
            way_between(m, a, 0, mode), wa, wm, way_between(m, b, 0, mode), wb, way_between(m, c, 0, mode), wc,
            s.middle_share, s.chord, s.turn, s.rest, s.compliance * inverse_dt2, multiplier);
        a.move(0, -move.step, wa * (1.F - s.chord) * a.yield_at(0));
        m.move(0, move.step, wm * (1.F - s.turn) * m.yield_at(0));
        b.move(0, -move.step, wb * s.chord * b.yield_at(0));
        if (s.turn != 0) c.move(0, move.step, wc * s.turn * c.yield_at(0));
        return move.multiplier;
      });
}

}  // namespace geocloth::cpu
