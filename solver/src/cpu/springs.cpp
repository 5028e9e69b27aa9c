// SPDX-License-Identifier: Apache-2.0
// Springs on the cpu: shaders/cloth/springs.comp and seam_bends.comp, line by line of the image. Springs that do not
// exist have no rest length and leave their ends as they are.

#include "cpu/springs.h"

#include <algorithm>

#include "cpu/line.h"
#include "cpu/seam_list.h"
#include "lib/spring.h"
#include "lib/spring_groups.h"

namespace geocloth::cpu {
namespace {

/// The springs of one component along a line of pixels.
struct SpringLine {
  PointLine a, b;
  const float *rest, *compliance;
  float* multiplier;  ///< only with several relaxation steps
};

struct SpringParams {
  float inverse_dt2 = 0, share = 1;
  float kept_multiplier = 0;  ///< 1: XPBD's sum is continued, 0: it starts anew with the first relaxation step
};

/// Projects the spring between point i of two lines. @return the new multiplier
template <uint32_t fine>
inline float project_spring(const PointLine& a, const PointLine& b, size_t i, float rest, float compliance, float share,
                            float multiplier, Fine<fine> mode) {
  const float wa = a.inverse_mass[i], wb = b.inverse_mass[i];
  const shader::vec3 d = way_between(a, b, i, mode);
  shader::SpringMove move;
  if constexpr (fine == shader::kFineMomentum) {
    move = shader::spring_move_along(d, first_way_between(a, b, i), wa, wb, rest, compliance, share, multiplier);
  } else {
    move = shader::spring_move(d, wa, wb, rest, compliance, share, multiplier);
  }
  const shader::Weights moves = shader::yielding(wa, a.yield_at(i), wb, b.yield_at(i));
  a.move(i, move.step, moves.a);
  b.move(i, -move.step, moves.b);
  return move.multiplier;
}

template <size_t stride, bool accumulate, uint32_t fine>
void project_line(const SpringLine line, uint32_t count, const SpringParams& params, Fine<fine> mode) {
  const float inverse_dt2 = params.inverse_dt2, share = params.share, kept = params.kept_multiplier;
  GEOCLOTH_INDEPENDENT_TURNS
  for (size_t k = 0; k < count; ++k) {
    const size_t i = k * stride;
    const float sum = accumulate ? kept * line.multiplier[i] : 0.F;
    const float next =
        project_spring(line.a, line.b, i, line.rest[i], line.compliance[i] * inverse_dt2, share, sum, mode);
    if constexpr (accumulate) line.multiplier[i] = next;
  }
}

/// One group of springs, line by line of the image.
class SpringPass {
 public:
  SpringPass(const PassContext& context, ClothState& state, const PassStep& step)
      : context_(context),
        state_(state),
        group_(step.group),
        component_(shader::group_component(step.group)),
        params_{context.cloth.params.inverse_dt2, share_of(context.cloth.params, component_),
                step.relaxation > 0 ? 1.F : 0.F} {}

  void run() const {
    const uint32_t width = state_.data.width;
    const bool by_column = shader::group_by_column(group_) == 1;
    const uint32_t lines = by_column ? state_.data.height : shader::group_line_count(group_, state_.data.height);
    context_.threads.for_range(lines, std::max(1U, kPixelGrain / width), [&](uint32_t first, uint32_t last) {
      for (uint32_t n = first; n < last; ++n) by_column ? along_row(n) : across_rows(shader::group_line(group_, n));
    });
  }

 private:
  /// Springs from row y to a row below: one from every pixel.
  void across_rows(uint32_t y) const {
    const uint32_t first = component_ == 3 ? 1 : 0, last = state_.data.width - (component_ == 2 ? 1 : 0);
    const uint32_t below = shader::spring_end(component_, first, y).y;
    if (below < state_.data.height && first < last) project<1>(first, y, last - first);
  }

  /// Springs within row y: every second pixel, or, over two pixels, every fourth and its neighbour.
  void along_row(uint32_t y) const {
    const uint32_t odd = group_ % 2, width = state_.data.width;
    if (component_ == 0) {
      if (odd + 1 < width) project<2>(odd, y, (width - odd) / 2);
      return;
    }
    for (uint32_t first = 2 * odd; first < 2 * odd + 2; ++first) {
      if (first + 2 < width) project<4>(first, y, (width - 2 - first + 3) / 4);
    }
  }

  template <size_t stride>
  void project(uint32_t x, uint32_t y, uint32_t count) const {
    const shader::uvec2 end = shader::spring_end(component_, x, y);
    const size_t a = size_t{y} * state_.data.width + x, b = size_t{end.y} * state_.data.width + end.x;
    const bool accumulate = context_.relaxation_steps > 1;
    const uint32_t fine = context_.cloth.params.fine;
    const SpringLine line{PointLine(state_, a, fine), PointLine(state_, b, fine), state_.rest[component_].data() + a,
                          state_.compliance[component_].data() + a,
                          accumulate ? state_.multiplier[component_].data() + a : nullptr};
    with_fine(fine, [&](auto mode) {
      accumulate ? project_line<stride, true>(line, count, params_, mode)
                 : project_line<stride, false>(line, count, params_, mode);
    });
  }

  const PassContext& context_;
  ClothState& state_;
  uint32_t group_, component_;
  SpringParams params_;
};

}  // namespace

void springs(const PassContext& context, ClothState& state, const PassStep& step) {
  SpringPass(context, state, step).run();
}

void seam_bends(const PassContext& context, ClothState& state, const PassStep& step) {
  const shader::ClothParams& params = context.cloth.params;
  const float inverse_dt2 = params.inverse_dt2, share = params.share_bending;
  for_seam_list(context, state, step,
                [=](const PointLine& pixels, const shader::SeamSpring& s, float multiplier, auto mode) {
                  return project_spring(pixels.from(s.a), pixels.from(s.b), 0, s.rest, s.compliance * inverse_dt2,
                                        share, multiplier, mode);
                });
}

float share_of(const shader::ClothParams& params, uint32_t component) {
  const uint32_t family = component / 2;
  return family == 0 ? params.share_structural : family == 1 ? params.share_shear : params.share_bending;
}

}  // namespace geocloth::cpu
