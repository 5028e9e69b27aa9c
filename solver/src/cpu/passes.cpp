// SPDX-License-Identifier: Apache-2.0
// The passes for the cpu: loads and stores around the functions of shaders/lib, which both backends share. Order of
// passes: pass.cpp. Each loop runs over things that do not touch each other, so threads split it as they like.

#include "cpu/passes.h"

#include <algorithm>
#include <mutex>

#include "cpu/collider_set.h"
#include "cpu/curvature.h"
#include "lib/limit.h"
#include "lib/normal.h"
#include "lib/pin.h"
#include "lib/predict.h"
#include "lib/spring.h"
#include "lib/spring_groups.h"
#include "lib/stitch.h"

namespace geocloth::cpu {
namespace {

using shader::vec3;
using shader::vec4;

constexpr uint32_t kPixelGrain = 4096;  ///< pixels that are worth a thread of their own
constexpr uint32_t kRowGrain = 512;     ///< split rows, pins, seam bends
constexpr float kNoNumber = 0;          ///< where no collider has numbers, so that none is asked for

shader::ColliderSet colliders_of(const FrameInput& frame) {
  return {frame.shapes.data(), frame.poses.data(), static_cast<uint32_t>(frame.shapes.size()),
          frame.collider_numbers ? frame.collider_numbers->data() : &kNoNumber};
}

/// Calls body(pixel) for every pixel.
template <class Body>
void for_pixels(const Threads& threads, const ClothState& state, const Body& body) {
  threads.for_range(static_cast<uint32_t>(state.pixel_count()), kPixelGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t i = first; i < last; ++i) body(i);
  });
}

/// Calls body(first copy, copies) for every row of the split-vertex table.
template <class Body>
void for_split_rows(const Threads& threads, const ClothState& state, const Body& body) {
  threads.for_range(state.data.split_rows(), kRowGrain, [&](uint32_t first, uint32_t last) {
    const uint32_t* pixel = state.data.split_pixel.data();
    for (uint32_t r = first; r < last; ++r)
      body(std::span<const uint32_t>(pixel + state.data.split_offset[r], pixel + state.data.split_offset[r + 1]));
  });
}

void normals(const PassContext& context, ClothState& state) {
  context.threads.for_range(static_cast<uint32_t>(state.pixel_count()), kPixelGrain,
                            [&](uint32_t first, uint32_t last) { normal_pixels(state, first, last); });
}

void normals_stitch(const PassContext& context, ClothState& state) {
  for_split_rows(context.threads, state, [&](std::span<const uint32_t> copies) {
    vec3 sum(0, 0, 0);
    for (const uint32_t i : copies) sum = sum + state.normal.at(i) * state.normal_length[i];
    const vec4 n = shader::unit_and_length(sum);
    for (const uint32_t i : copies) {
      state.normal.set(i, shader::xyz(n));
      state.normal_length[i] = n.w;
    }
  });
}

vec3 air_at(const PassContext& context, const vec3& position) {
  vec3 air = shader::xyz(context.cloth.params.wind);
  for (const shader::Wave& wave : context.frame.substeps[context.substep].waves) {
    air = air + shader::gust_at(wave, position);
  }
  return air;
}

void predict(const PassContext& context, ClothState& state) {
  const shader::ClothParams& params = context.cloth.params;
  for_pixels(context.threads, state, [&](uint32_t i) {
    const vec3 position = state.position.at(i);
    if (state.inverse_mass[i] == 0) {
      state.previous.set(i, position);
      return;
    }
    const vec3 previous = state.previous.at(i);
    vec3 acceleration(0, 0, 0);
    if (params.air != 0) {
      const vec3 velocity = ((position - previous) + state.carry.at(i)) * params.inverse_dt;
      acceleration = shader::air_acceleration(params, air_at(context, position), velocity, state.normal.at(i));
    }
    const vec3 carry = state.carry.at(i);
    const shader::Predicted next = params.moving != 0
                                       ? shader::predict_along(params, static_cast<float>(context.substep), position,
                                                               previous, carry, acceleration)
                                       : shader::predict(params, position, previous, carry, acceleration);
    state.position.set(i, next.position);
    state.previous.set(i, next.previous);
    state.carry.set(i, next.carry);
  });
}

void pins(const PassContext& context, ClothState& state) {
  context.threads.for_range(static_cast<uint32_t>(context.cloth.pins.size()), kRowGrain,
                            [&](uint32_t first, uint32_t last) { move_pins(context, state, first, last); });
}

/// The springs of one component along a line of pixels, as raw pointers to the first one.
struct SpringLine {
  float* ax;
  float* ay;
  float* az;
  const float* aw;
  float* bx;
  float* by;
  float* bz;
  const float* bw;
  const float* rest;
  const float* compliance;
  float* multiplier;  ///< only with several relaxation steps
};

struct SpringParams {
  float inverse_dt2 = 0, share = 1;
  float kept_multiplier = 0;  ///< 1: XPBD's sum is continued, 0: it starts anew with the first relaxation step
};

/// Projects `count` springs that start `stride` pixels apart. Springs that do not exist have no rest length and leave
/// their ends as they are. Within a group no pixel is an end of two springs, so what is written for one spring is never
/// read for another: the loop vectorises (ivdep).
template <size_t stride, bool accumulate>
void project_line(const SpringLine line, uint32_t count, const SpringParams& params) {
  // Copied to locals, for floats that a reference leads to might be among those that are written.
  const float inverse_dt2 = params.inverse_dt2, share = params.share, kept = params.kept_multiplier;
#ifdef __clang__
#pragma clang loop vectorize(assume_safety)
#else
#pragma GCC ivdep
#endif
  for (size_t k = 0; k < count; ++k) {
    const size_t i = k * stride;
    const float sum = accumulate ? kept * line.multiplier[i] : 0.F;
    const shader::SpringEnds ends = shader::project_spring(vec3(line.ax[i], line.ay[i], line.az[i]), line.aw[i],
                                                           vec3(line.bx[i], line.by[i], line.bz[i]), line.bw[i],
                                                           line.rest[i], line.compliance[i] * inverse_dt2, share, sum);
    line.ax[i] = ends.a.x;
    line.ay[i] = ends.a.y;
    line.az[i] = ends.a.z;
    line.bx[i] = ends.b.x;
    line.by[i] = ends.b.y;
    line.bz[i] = ends.b.z;
    if constexpr (accumulate) line.multiplier[i] = ends.multiplier;
  }
}

float share_of(const shader::ClothParams& params, uint32_t component) {
  const uint32_t family = component / 2;
  return family == 0 ? params.share_structural : family == 1 ? params.share_shear : params.share_bending;
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
    Vec3Array& p = state_.position;
    const bool accumulate = context_.relaxation_steps > 1;
    const SpringLine line{p.x.data() + a,
                          p.y.data() + a,
                          p.z.data() + a,
                          state_.inverse_mass.data() + a,
                          p.x.data() + b,
                          p.y.data() + b,
                          p.z.data() + b,
                          state_.inverse_mass.data() + b,
                          state_.rest[component_].data() + a,
                          state_.compliance[component_].data() + a,
                          accumulate ? state_.multiplier[component_].data() + a : nullptr};
    accumulate ? project_line<stride, true>(line, count, params_) : project_line<stride, false>(line, count, params_);
  }

  const PassContext& context_;
  ClothState& state_;
  uint32_t group_, component_;
  SpringParams params_;
};

void seam_bends(const PassContext& context, ClothState& state, const PassStep& step) {
  const shader::ClothParams& params = context.cloth.params;
  const bool accumulate = context.relaxation_steps > 1;
  const uint32_t begin = state.data.seam_color_offset[step.group];
  const uint32_t count = state.data.seam_color_offset[step.group + 1] - begin;
  context.threads.for_range(count, kRowGrain, [&](uint32_t first, uint32_t last) {
    for (uint32_t k = begin + first; k < begin + last; ++k) {
      const shader::SeamSpring& s = state.data.seam_bends[k];
      const float multiplier = accumulate && step.relaxation > 0 ? state.seam_multiplier[k] : 0.F;
      const shader::SpringEnds ends = shader::project_spring(
          state.position.at(s.a), state.inverse_mass[s.a], state.position.at(s.b), state.inverse_mass[s.b], s.rest,
          s.compliance * params.inverse_dt2, params.share_bending, multiplier);
      state.position.set(s.a, ends.a);
      state.position.set(s.b, ends.b);
      if (accumulate) state.seam_multiplier[k] = ends.multiplier;
    }
  });
}

void stitch(const PassContext& context, ClothState& state) {
  for_split_rows(context.threads, state, [&](std::span<const uint32_t> copies) {
    const vec4 first = state.position_and_mass(copies.front());
    if (first.w == 0) return;  // pinned, and all its copies with it
    shader::StitchSum sum = shader::stitch_begin();
    for (const uint32_t i : copies) sum = shader::stitch_add(sum, first, state.position_and_mass(i));
    const vec3 mean = shader::stitch_mean(sum, first);
    for (const uint32_t i : copies) state.position.set(i, mean);
  });
}

void limit(const PassContext& context, ClothState& state) {
  const float stretch = context.cloth.params.stretch_limit;
  for_pixels(context.threads, state, [&](uint32_t i) {
    const shader::Attachment& attachment = state.attachments[i];
    if (attachment.anchor == shader::kNoAnchor || state.inverse_mass[i] == 0) return;
    const vec3 anchor = state.position.at(attachment.anchor);
    state.position.set(i, shader::attach(state.position.at(i), anchor, attachment.reach * stretch));
  });
}

void collide(const PassContext& context, ClothState& state) {
  context.threads.for_range(static_cast<uint32_t>(state.pixel_count()), kPixelGrain,
                            [&](uint32_t first, uint32_t last) { collide_pixels(context, state, first, last); });
}

/// Largest of largest_of(first, last) over parts of 0..count. A maximum does not depend on the order.
template <class LargestOf>
float largest(const Threads& threads, uint32_t count, const LargestOf& largest_of) {
  std::mutex mutex;
  float result = 0;
  threads.for_range(count, kPixelGrain, [&](uint32_t first, uint32_t last) {
    const float part = largest_of(first, last);
    const std::lock_guard lock(mutex);
    result = std::max(result, part);
  });
  return result;
}

float copy_gap(const PassContext& context, const ClothState& state) {
  return largest(context.threads, state.data.split_rows(), [&](uint32_t first_row, uint32_t last_row) {
    float gap = 0;
    for (uint32_t r = first_row; r < last_row; ++r) {
      const uint32_t begin = state.data.split_offset[r];
      const vec3 first = state.position.at(state.data.split_pixel[begin]);
      for (uint32_t k = begin + 1; k < state.data.split_offset[r + 1]; ++k)
        gap = std::max(gap, shader::length3(state.position.at(state.data.split_pixel[k]) - first));
    }
    return gap;
  });
}

float penetration(const PassContext& context, const ClothState& state) {
  return largest(context.threads, static_cast<uint32_t>(state.pixel_count()),
                 [&](uint32_t first, uint32_t last) { return penetration_of_pixels(context, state, first, last); });
}

}  // namespace

void normal_pixels(ClothState& state, uint32_t first, uint32_t last) {
  const uint32_t width = state.data.width, height = state.data.height;
  const auto cell = [&](uint32_t x, uint32_t y, uint32_t corner) {
    if (x >= width || y >= height) return vec3(0, 0, 0);  // x - 1 of column 0 wraps to a huge number
    const uint32_t i = y * width + x;
    const uint32_t bits = state.data.cell[i];
    if ((bits & (shader::kCellFirstBit | shader::kCellSecondBit)) == 0) return vec3(0, 0, 0);
    const Vec3Array& p = state.position;
    return shader::corner_normal(bits, corner, p.at(i), p.at(i + 1), p.at(i + width), p.at(i + width + 1));
  };
  for (uint32_t i = first; i < last; ++i) {
    const uint32_t x = i % width, y = i / width;
    const vec3 sum = cell(x - 1, y - 1, 3) + cell(x, y - 1, 2) + cell(x - 1, y, 1) + cell(x, y, 0);
    const vec4 n = shader::unit_and_length(sum);
    state.normal.set(i, shader::xyz(n));
    state.normal_length[i] = n.w;
  }
}

vec3 pinned_position(const PassContext& context, uint32_t pin, const vec3& position, const vec3& previous) {
  const shader::Substep& step = context.frame.substeps[context.substep];
  return shader::pinned_position(context.cloth.pins[pin], step.pin_fraction, step.frame_fraction, step.substep_share,
                                 position, previous);
}

void move_pins(const PassContext& context, ClothState& state, uint32_t first, uint32_t last) {
  for (uint32_t k = first; k < last; ++k) {
    const uint32_t i = context.cloth.pins[k].pixel.x;
    state.position.set(i, pinned_position(context, k, state.position.at(i), state.previous.at(i)));
  }
}

void collide_pixels(const PassContext& context, ClothState& state, uint32_t first, uint32_t last) {
  const shader::ColliderSet set = colliders_of(context.frame);
  for (uint32_t i = first; i < last; ++i) {
    if (state.inverse_mass[i] == 0) continue;
    const shader::PointState point{state.position.at(i), state.previous.at(i), state.carry.at(i)};
    const shader::PointState after = shader::collide(set, context.cloth.params, context.substep, point);
    state.position.set(i, after.position);
    state.previous.set(i, after.previous);
    state.carry.set(i, after.carry);
  }
}

float penetration_of_pixels(const PassContext& context, const ClothState& state, uint32_t first, uint32_t last) {
  const shader::ColliderSet set = colliders_of(context.frame);
  float depth = 0;
  for (uint32_t i = first; i < last; ++i) {
    if (state.inverse_mass[i] == 0) continue;
    depth = std::max(depth, shader::depth_in_colliders(set, set.count, context.substep, state.position.at(i)));
  }
  return depth;
}

void run_pass(const PassStep& step, const PassContext& context, ClothState& state, Measures& measures) {
  switch (step.pass) {
    case Pass::normals:
      return normals(context, state);
    case Pass::normals_stitch:
      return normals_stitch(context, state);
    case Pass::predict:
      return predict(context, state);
    case Pass::pins:
      return pins(context, state);
    case Pass::structural:
    case Pass::shear:
    case Pass::bending:
      return SpringPass(context, state, step).run();
    case Pass::seam_bends:
      return seam_bends(context, state, step);
    case Pass::curvature:
      return curvature(context, state, step);
    case Pass::seam_curvature:
      return seam_curvature(context, state, step);
    case Pass::stitch:
      return stitch(context, state);
    case Pass::limit:
      return limit(context, state);
    case Pass::collide:
      return collide(context, state);
    case Pass::check_copies:
      measures.copy_gap = std::max(measures.copy_gap, copy_gap(context, state));
      return;
    case Pass::check_colliders:
      measures.penetration = std::max(measures.penetration, penetration(context, state));
      return;
  }
}

}  // namespace geocloth::cpu
