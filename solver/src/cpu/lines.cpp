// SPDX-License-Identifier: Apache-2.0
// Line relaxation on the cpu: shaders/cloth/lines.comp.

#include "cpu/lines.h"

#include <algorithm>

#include "lib/lines.h"

namespace geocloth::cpu {
namespace {

using shader::vec3;

/// The runs of a row or a column, forth and back. Normals are made anew after the frame: till then they keep what goes
/// from one sweep to the other.
class Line {
 public:
  Line(ClothState& state, uint32_t component, size_t first, uint32_t count, const shader::ClothParams& params)
      : state_(state),
        rest_(state.rest[component]),
        first_(first),
        next_(component == 0 ? 1 : state.data.width),
        springs_(count - 1),
        limit_(params.stretch_limit),
        diagonal_(shader::line_diagonal(params.inverse_dt2)) {}

  void solve() const {
    sweep_forth();
    sweep_back();
  }

 private:
  [[nodiscard]] size_t pixel(uint32_t k) const { return first_ + k * next_; }
  [[nodiscard]] bool has_spring(uint32_t k) const { return k < springs_ && rest_[pixel(k)] > 0; }  // -1 wraps
  [[nodiscard]] float weight(uint32_t k) const {
    return shader::line_weight(state_.inverse_mass[pixel(k)], state_.data.cell[pixel(k)]);
  }

  void sweep_forth() const {
    shader::LineSpring before = shader::no_line_spring();
    vec3 d_before(0, 0, 0);
    for (uint32_t k = 0; k < springs_; ++k) {
      vec3 d(0, 0, 0);
      if (has_spring(k)) d = state_.position.at(pixel(k + 1)) - state_.position.at(pixel(k));
      before = shader::line_spring(before, d_before, d, weight(k), weight(k + 1), rest_[pixel(k)] * limit_, diagonal_);
      d_before = d;
      state_.normal.x[pixel(k)] = before.coupling;
      state_.normal.y[pixel(k)] = before.multiplier;
    }
  }

  void sweep_back() const {
    vec3 end = state_.position.at(pixel(springs_)), step_of_next(0, 0, 0);
    float coupling_of_next = 0, multiplier = 0;
    for (uint32_t k = springs_; k-- > 0;) {
      const vec3 start = state_.position.at(pixel(k));
      multiplier = shader::line_multiplier(state_.normal.y[pixel(k)], coupling_of_next, multiplier);
      coupling_of_next = state_.normal.x[pixel(k)];
      state_.normal.x[pixel(k)] = state_.normal.y[pixel(k)] = 0;
      const vec3 step = has_spring(k) ? (end - start) * multiplier : vec3(0, 0, 0);
      move(k + 1, end, step_of_next, step);
      end = start;
      step_of_next = step;
    }
    move(0, end, step_of_next, vec3(0, 0, 0));
  }

  void move(uint32_t k, const vec3& from, const vec3& step, const vec3& step_before) const {
    const float w = weight(k);
    if (w == 0 || !(has_spring(k) || has_spring(k - 1))) return;
    state_.position.set(pixel(k), shader::line_point(from, step, step_before, w));
  }

  ClothState& state_;
  const std::vector<float>& rest_;
  size_t first_, next_;
  uint32_t springs_;
  float limit_, diagonal_;
};

}  // namespace

void lines(const PassContext& context, ClothState& state, const PassStep& step) {
  const bool along = step.group == 0;
  const uint32_t width = state.data.width, height = state.data.height;
  const uint32_t count = along ? height : width, length = along ? width : height;
  context.threads.for_range(count, std::max(1U, kPixelGrain / length), [&](uint32_t first, uint32_t last) {
    for (uint32_t n = first; n < last; ++n) {
      Line(state, step.group, along ? size_t{n} * width : n, length, context.cloth.params).solve();
    }
  });
}

}  // namespace geocloth::cpu
