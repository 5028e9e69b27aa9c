// SPDX-License-Identifier: Apache-2.0
// Line relaxation on the cpu: shaders/cloth/lines.comp.

#include "cpu/lines.h"

#include <algorithm>
#include <span>
#include <vector>

#include "lib/lines.h"

namespace geocloth::cpu {
namespace {

using shader::vec3;

/// The runs of a row or a column, forth, back and forth.
class Line {
 public:
  Line(ClothState& state, uint32_t component, size_t first, const shader::ClothParams& params,
       std::span<KeptInLine> kept)
      : state_(state),
        rest_(state.rest[component]),
        first_(first),
        next_(component == 0 ? 1 : state.data.width),
        springs_(static_cast<uint32_t>(kept.size()) - 1),
        limit_(params.stretch_limit),
        diagonal_(shader::line_diagonal(params.inverse_dt2)),
        kept_(kept) {}

  void solve() const {
    find_springs();
    find_multipliers();
    move_points();
  }

 private:
  [[nodiscard]] size_t pixel(uint32_t k) const { return first_ + k * next_; }
  [[nodiscard]] bool has_spring(uint32_t k) const { return k < springs_ && rest_[pixel(k)] > 0; }  // -1 wraps
  [[nodiscard]] float weight(uint32_t k) const {
    return shader::line_weight(state_.inverse_mass[pixel(k)], state_.data.cell[pixel(k)]);
  }
  [[nodiscard]] bool is_held(uint32_t k) const { return state_.inverse_mass[pixel(k)] == 0; }

  void find_springs() const {
    shader::LineSpring before = shader::no_line_spring();
    vec3 d_before(0, 0, 0);
    for (uint32_t k = 0; k < springs_; ++k) {
      vec3 d(0, 0, 0);
      if (has_spring(k)) d = state_.position.at(pixel(k + 1)) - state_.position.at(pixel(k));
      before = shader::line_spring(before, d_before, d, weight(k), weight(k + 1), rest_[pixel(k)] * limit_, diagonal_);
      d_before = d;
      kept_[k].spring = before;
    }
  }

  void find_multipliers() const {
    shader::LinePoint point = shader::no_line_point();
    float coupling = 0, multiplier = 0;  // of the spring from k on
    for (uint32_t k = springs_ + 1; k-- > 0;) {
      kept_[k].multiplier = multiplier;
      float before = 0;
      if (k > 0) {
        const shader::LineSpring& spring = kept_[k - 1].spring;
        before = shader::line_multiplier(spring.multiplier, coupling, multiplier);
        coupling = spring.coupling;
      }
      const vec3 way = is_held(k) ? vec3(0, 0, 0) : state_.previous.at(pixel(k));
      point = shader::line_point(point, state_.position.at(pixel(k)), way, weight(k), before, multiplier);
      kept_[k].point = point;
      multiplier = before;
    }
  }

  void move_points() const {
    vec3 step_before(0, 0, 0);
    vec3 place = kept_[0].point.place, way = kept_[0].point.way, from = state_.position.at(pixel(0));
    for (uint32_t k = 0; k <= springs_; ++k) {
      vec3 step(0, 0, 0), place_of_next(0, 0, 0), way_of_next(0, 0, 0), next(0, 0, 0);
      if (k < springs_) {
        const shader::LinePoint& point = kept_[k + 1].point;
        next = state_.position.at(pixel(k + 1));
        place_of_next = shader::shifted(point.place, place, point.coupling);
        way_of_next = shader::shifted(point.way, way, point.coupling);
        if (has_spring(k)) step = shader::line_step(next - from, place_of_next - place, kept_[k].multiplier);
      }
      if (weight(k) != 0 && (has_spring(k) || has_spring(k - 1))) {
        state_.position.set(pixel(k), shader::line_moved(from, step, step_before, weight(k)));
        state_.previous.set(pixel(k), way);
      }
      from = next;
      place = place_of_next;
      way = way_of_next;
      step_before = step;
    }
  }

  ClothState& state_;
  const std::vector<float>& rest_;
  size_t first_, next_;
  uint32_t springs_;
  float limit_, diagonal_;
  std::span<KeptInLine> kept_;
};

}  // namespace

void lines(const PassContext& context, ClothState& state, const PassStep& step) {
  const bool along = step.group == 0;
  const uint32_t width = state.data.width, height = state.data.height;
  const uint32_t count = along ? height : width, length = along ? width : height;
  state.kept_in_lines.resize(state.pixel_count());  // frames after the first one allocate nothing
  context.threads.for_range(count, std::max(1U, kPixelGrain / length), [&](uint32_t first, uint32_t last) {
    for (uint32_t n = first; n < last; ++n) {
      const auto kept = std::span(state.kept_in_lines).subspan(size_t{n} * length, length);
      Line(state, step.group, along ? size_t{n} * width : n, context.cloth.params, kept).solve();
    }
  });
}

}  // namespace geocloth::cpu
