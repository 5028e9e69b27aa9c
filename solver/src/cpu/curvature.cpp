// SPDX-License-Identifier: Apache-2.0
// Bending on the cpu: shaders/cloth/curvature.comp and seam_curvature.comp, line by line of the image. Down the columns
// the bends that start in a row are next to each other; along a row every third pixel starts one.

#include "cpu/curvature.h"

#include <algorithm>

#include "lib/bend.h"
#include "lib/bend_groups.h"

namespace geocloth::cpu {
namespace {

using shader::vec3;

constexpr uint32_t kPixelGrain = 4096;  ///< pixels that are worth a thread of their own
constexpr uint32_t kRowGrain = 512;     ///< seam bends

/// Three components of a point as raw pointers.
struct PointLine {
  float *x, *y, *z;
  const float* inverse_mass;
  [[nodiscard]] vec3 at(size_t i) const { return {x[i], y[i], z[i]}; }
  void set(size_t i, const vec3& v) const {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

struct BendLine {
  PointLine a, middle, b;
  const float *h1, *h2, *rest, *compliance;
  float* multiplier;  ///< only with several relaxation steps
};

/// Projects `count` bends that start `stride` pixels apart. Bends of a group share no pixel, so what is written for one
/// is never read for another: the loop vectorises (ivdep).
template <size_t stride, bool accumulate>
void project_line(const BendLine line, uint32_t count, float inverse_dt2, float kept_multiplier) {
#ifdef __clang__
#pragma clang loop vectorize(assume_safety)
#else
#pragma GCC ivdep
#endif
  for (size_t k = 0; k < count; ++k) {
    const size_t i = k * stride;
    const float sum = accumulate ? kept_multiplier * line.multiplier[i] : 0.F;
    const shader::BendEnds ends =
        shader::project_bend(line.a.at(i), line.a.inverse_mass[i], line.middle.at(i), line.middle.inverse_mass[i],
                             line.b.at(i), line.b.inverse_mass[i], 1.F, shader::chord_share(line.h1[i], line.h2[i]),
                             line.rest[i], line.compliance[i] * inverse_dt2, sum);
    line.a.set(i, ends.a);
    line.middle.set(i, ends.middle);
    line.b.set(i, ends.b);
    if constexpr (accumulate) line.multiplier[i] = ends.multiplier;
  }
}

template <size_t stride>
void project_line(const BendLine& line, uint32_t count, float inverse_dt2, float kept_multiplier) {
  line.multiplier != nullptr ? project_line<stride, true>(line, count, inverse_dt2, kept_multiplier)
                             : project_line<stride, false>(line, count, inverse_dt2, kept_multiplier);
}

PointLine points_from(ClothState& state, size_t first) {
  Vec3Array& p = state.position;
  return {p.x.data() + first, p.y.data() + first, p.z.data() + first, state.inverse_mass.data() + first};
}

}  // namespace

void curvature(const PassContext& context, ClothState& state, const PassStep& step) {
  const uint32_t width = state.data.width, height = state.data.height, group = step.group;
  const uint32_t component = shader::bend_component(group);
  const bool row = component == 4;
  if ((row ? width : height) < 3) return;
  const bool accumulate = context.relaxation_steps > 1;
  const float inverse_dt2 = context.cloth.params.inverse_dt2, kept = step.relaxation > 0 ? 1.F : 0.F;
  const size_t offset = row ? 1 : width;

  const auto line_from = [&](size_t a) {
    return BendLine{points_from(state, a),
                    points_from(state, a + offset),
                    points_from(state, a + 2 * offset),
                    state.rest[component - 4].data() + a,
                    state.rest[component - 4].data() + a + offset,
                    state.rest[component].data() + a,
                    state.compliance[component].data() + a,
                    accumulate ? state.multiplier[component].data() + a : nullptr};
  };
  const auto along_row = [&](uint32_t y) {
    if (group + 2 >= width) return;
    project_line<3>(line_from(size_t{y} * width + group), (width - 2 - group + 2) / 3, inverse_dt2, kept);
  };
  const auto down_columns = [&](uint32_t n) {
    const uint32_t y = 3 * n + group - 3;
    if (y + 2 >= height) return;
    project_line<1>(line_from(size_t{y} * width), width, inverse_dt2, kept);
  };
  context.threads.for_range(row ? height : (height + 2) / 3, std::max(1U, kPixelGrain / width),
                            [&](uint32_t first, uint32_t last) {
                              for (uint32_t n = first; n < last; ++n) row ? along_row(n) : down_columns(n);
                            });
}

void seam_curvature(const PassContext& context, ClothState& state, const PassStep& step) {
  const float inverse_dt2 = context.cloth.params.inverse_dt2;
  const bool accumulate = context.relaxation_steps > 1;
  const uint32_t begin = state.data.seam_color_offset[step.group];
  const uint32_t count = state.data.seam_color_offset[step.group + 1] - begin;
  context.threads.for_range(count, kRowGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t k = begin + first; k < begin + last; ++k) {
      const shader::SeamSpring& s = state.data.seam_bends[k];
      const float multiplier = accumulate && step.relaxation > 0 ? state.seam_multiplier[k] : 0.F;
      const shader::BendEnds ends =
          shader::project_bend(state.position.at(s.a), state.inverse_mass[s.a], state.position.at(s.middle),
                               state.inverse_mass[s.middle], state.position.at(s.b), state.inverse_mass[s.b],
                               s.middle_share, s.chord, s.rest, s.compliance * inverse_dt2, multiplier);
      state.position.set(s.a, ends.a);
      state.position.set(s.middle, ends.middle);
      state.position.set(s.b, ends.b);
      if (accumulate) state.seam_multiplier[k] = ends.multiplier;
    }
  });
}

}  // namespace geocloth::cpu
