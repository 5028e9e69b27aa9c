// SPDX-License-Identifier: Apache-2.0
// Spans on the cpu: shaders/cloth/spans.comp, seam_spans.comp and what is made of the same text.

#include "cpu/spans.h"

#include <algorithm>

#include "cpu/line.h"
#include "cpu/seam_list.h"
#include "lib/span.h"
#include "lib/spring_groups.h"

namespace geocloth::cpu {

namespace {

template <class Mode>
inline void pull(const PointLine& a, const PointLine& b, float longest, Mode mode, float share = 1) {
  const float wa = *a.inverse_mass, wb = *b.inverse_mass;
  const shader::SpanMove move = shader::span_move(way_between(a, b, 0, mode), wa, wb, longest, share);
  if (!move.pulls) return;
  const shader::Weights moves = shader::yielding(wa, a.yield_at(0), wb, b.yield_at(0));
  a.move(0, move.step, moves.a);
  b.move(0, -move.step, moves.b);
}

}  // namespace

float span_length(const ClothState& state, uint32_t group, size_t pixel) {
  const uint32_t component = shader::span_component(group);
  const size_t next = component == 0 ? 1 : state.data.width;
  float length = 0;
  for (uint32_t i = 0; i < shader::pixels_of_span(group); ++i) {
    const float own = state.rest[component][pixel + i * next];
    if (own == 0) return 0;
    length = length + own;
  }
  return length;
}

void spans(const PassContext& context, ClothState& state, const PassStep& step) {
  const shader::ClothParams& params = context.cloth.params;
  const uint32_t component = shader::span_component(step.group), width = state.data.width, height = state.data.height;
  const uint32_t pixels = shader::pixels_of_span(step.group);
  const uint32_t reach_x = component == 0 ? pixels : 0, reach_y = pixels - reach_x;
  if (width <= reach_x || height <= reach_y) return;
  const auto pull_from = [&](size_t pixel, auto mode) {
    const float length = span_length(state, step.group, pixel);
    if (!(length > 0)) return;
    pull(PointLine(state, pixel, params.fine), PointLine(state, pixel + reach_x + size_t{reach_y} * width, params.fine),
         length * params.stretch_limit, mode, shader::span_share(step.group));
  };
  context.threads.for_range(height - reach_y, std::max(1U, kPixelGrain / width), [&](uint32_t first, uint32_t last) {
    with_fine(params.fine, [&](auto mode) {
      for (uint32_t y = first; y < last; ++y)
        for (uint32_t x = 0; x < width - reach_x; ++x)
          if (shader::span_starts(step.group, x, y)) pull_from(size_t{y} * width + x, mode);
    });
  });
}

void ties(const PassContext& context, ClothState& state, const PassStep& step) {
  const float limit = context.cloth.params.stretch_limit, share = step.relaxation > 0 ? shader::kTieShare : 1;
  const uint32_t component = shader::group_component(step.group), width = state.data.width;
  const shader::uvec2 extent = shader::group_extent(step.group, width, state.data.height);
  context.threads.for_range(extent.y, std::max(1U, kPixelGrain / width), [&](uint32_t first, uint32_t last) {
    for (uint32_t j = first; j < last; ++j) {
      for (uint32_t i = 0; i < extent.x; ++i) {
        const shader::uvec2 p = shader::group_pixel(step.group, i, j);
        const shader::uvec2 end = shader::spring_end(component, p.x, p.y);
        if (end.x >= width || end.y >= state.data.height) continue;
        const size_t a = size_t{p.y} * width + p.x, b = size_t{end.y} * width + end.x;
        const float rest = state.rest[component][a];
        if (rest == 0) continue;
        pull(PointLine(state, a, shader::kFineOff), PointLine(state, b, shader::kFineOff), rest * limit,
             Fine<shader::kFineOff>(), share);
      }
    }
  });
}

void seam_spans(const PassContext& context, ClothState& state, const PassStep& step) {
  const float limit = context.cloth.params.stretch_limit;
  for_seam_list(context, state, step,
                [=](const PointLine& pixels, const shader::SeamSpring& s, float multiplier, auto mode) {
                  pull(pixels.from(s.a), pixels.from(s.b), s.rest * limit, mode);
                  return multiplier;
                });
}

void sew(const PassContext& context, ClothState& state, const PassStep& step) {
  const shader::ClothParams& params = context.cloth.params;
  const float share = shader::sewing_share(params.sewing_before, params.sewing_after,
                                           context.frame.substeps[context.substep].frame_fraction);
  for_seam_list(context, state, step,
                [=](const PointLine& pixels, const shader::SeamSpring& s, float multiplier, auto mode) {
                  pull(pixels.from(s.a), pixels.from(s.b), s.rest * share, mode);
                  return multiplier;
                });
}

void whole_ties(const PassContext& context, ClothState& state, const PassStep& step) {
  const float limit = context.cloth.params.stretch_limit, share = step.relaxation > 0 ? shader::kTieShare : 1;
  const uint32_t begin = state.data.seam_color_offset[step.group], end = state.data.seam_color_offset[step.group + 1];
  const auto weight = [&](uint32_t pixel) { return shader::whole_tie_weight(state.inverse_mass[pixel]); };
  const auto place_copies = [&](uint32_t pixel, uint32_t row, const shader::vec3& place) {
    if (row == shader::kNoRow) return state.position.set(pixel, place);
    for (uint32_t k = state.data.split_offset[row]; k < state.data.split_offset[row + 1]; ++k)
      state.position.set(state.data.split_pixel[k], place);
  };
  context.threads.for_range(end - begin, kRowGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t k = first; k < last; ++k) {
      const shader::SeamSpring& tie = state.data.seam_springs[begin + k];
      const shader::vec3 a = state.position.at(tie.a), b = state.position.at(tie.b);
      const float wa = weight(tie.a), wb = weight(tie.b);
      const shader::SpanMove move = shader::span_move(b - a, wa, wb, tie.rest * limit, share);
      if (!move.pulls) continue;
      place_copies(tie.a, tie.row_a, shader::shifted(a, move.step, wa));
      place_copies(tie.b, tie.row_b, shader::shifted(b, -move.step, wb));
    }
  });
}

}  // namespace geocloth::cpu
