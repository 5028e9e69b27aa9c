// SPDX-License-Identifier: Apache-2.0
// The passes for the cpu: loads and stores around the functions of shaders/lib, which both backends share. Order of
// passes: pass.cpp. Each loop runs over things that do not touch each other, so threads split it as they like.

#include "cpu/passes.h"

#include <algorithm>
#include <mutex>

#include "cpu/collider_set.h"
#include "cpu/curvature.h"
#include "cpu/lines.h"
#include "cpu/spans.h"
#include "cpu/springs.h"
#include "lib/cell_groups.h"
#include "lib/collide_cell.h"
#include "lib/fine.h"
#include "lib/finish.h"
#include "lib/frame.h"
#include "lib/limit.h"
#include "lib/normal.h"
#include "lib/predict.h"
#include "lib/stitch.h"

namespace geocloth::cpu {
namespace {

using shader::vec3;
using shader::vec4;

constexpr float kNoNumber = 0;  ///< where no collider has numbers, so that none is asked for

shader::ColliderSet colliders_of(const PassContext& context) {
  const MetColliders met(context.frame, context.cloth.params);
  return {met.shapes.data(), met.poses.data(), static_cast<uint32_t>(met.shapes.size()),
          context.frame.collider_numbers ? context.frame.collider_numbers->data() : &kNoNumber};
}

/// The same where contacts are summed, if they are.
shader::ColliderSet touched_colliders(const PassContext& context, ClothState& state) {
  shader::ColliderSet set = colliders_of(context);
  set.contacts = state.contacts.empty() ? nullptr : state.contacts.data();
  set.contact_scale = context.cloth.params.contact_scale;
  set.gravity_step = shader::xyz(context.cloth.params.gravity_step);
  return set;
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
  const bool presses = context.cloth.params.pressure.x != 0;
  for_split_rows(context.threads, state, [&](std::span<const uint32_t> copies) {
    vec3 sum(0, 0, 0);
    float mass = 0;  // only where a pressure acts
    for (const uint32_t i : copies) {
      sum = sum + state.normal.at(i) * state.normal_length[i];
      if (presses && state.inverse_mass[i] > 0) mass = mass + 1 / state.inverse_mass[i];
    }
    const vec4 n = shader::unit_and_length(sum);
    const float own = mass > 0 ? -n.w / mass : n.w;  // see pressure_acceleration() of lib/predict.h
    for (const uint32_t i : copies) {
      state.normal.set(i, shader::xyz(n));
      state.normal_length[i] = own;
    }
  });
}

vec3 air_at(const PassContext& context, const vec3& position) {
  vec3 air = shader::xyz(context.cloth.params.wind);
  for (const shader::Wave& wave : context.frame.substeps[context.substep].waves) {
    air = air + shader::gust_at(wave, position);
  }
  return air * context.cloth.params.wind.w;
}

void predict(const PassContext& context, ClothState& state) {
  const shader::ClothParams& params = context.cloth.params;
  for_pixels(context.threads, state, [&](uint32_t i) {
    const vec3 position = state.position.at(i);
    const bool fine = params.fine != shader::kFineOff;
    const vec3 low = fine ? state.offset.at(i) : vec3(0, 0, 0);
    if (state.inverse_mass[i] == 0) {
      state.previous.set(i, position);
      if (fine) state.carry.set(i, low);
      return;
    }
    const shader::PointState point = state.point(i);
    vec3 acceleration(0, 0, 0);
    if (params.air != 0) {
      const vec3 velocity = shader::way_of(point) * params.inverse_dt;
      acceleration = shader::air_acceleration(params, air_at(context, position), velocity, state.normal.at(i));
      if (params.pressure.x != 0) {
        acceleration = acceleration + shader::pressure_acceleration(params, state.normal.at(i), state.normal_length[i],
                                                                    state.inverse_mass[i]);
      }
    }
    const shader::PointState next =
        params.moving != 0 ? shader::predict_along(params, static_cast<float>(context.substep), point, acceleration)
                           : shader::predict(params, point, acceleration);
    if (fine) {
      state.previous.set(i, next.previous);
      state.offset.set(i, shader::predicted_offset(next, low));
      state.carry.set(i, low);
    } else {
      state.set_point(i, next);
    }
  });
}

void rescale(const PassContext& context, ClothState& state) {
  if (context.substep > 0) return;
  const float ratio = context.cloth.params.gravity_step.w;
  for_pixels(context.threads, state, [&](uint32_t i) { state.set_point(i, shader::rescaled(state.point(i), ratio)); });
}

void pins(const PassContext& context, ClothState& state) {
  const auto move = [&](const shader::PinTarget& pin) {
    const uint32_t i = pin.pixel.x;
    if (context.cloth.params.fine == shader::kFineOff) {
      state.position.set(i, pinned_position(context, pin, state.position.at(i), state.previous.at(i)));
    } else {
      const shader::PinTarget seen = shader::pin_from(pin, state.previous.at(i));
      state.offset.set(i, pinned_position(context, seen, state.offset.at(i), state.carry.at(i)));
    }
  };
  const std::vector<shader::PinTarget>& all = context.cloth.pins;
  context.threads.for_range(static_cast<uint32_t>(all.size()), kRowGrain, [&](uint32_t first, uint32_t last) {
    std::for_each(all.begin() + first, all.begin() + last, move);
  });
}

void stitch(const PassContext& context, ClothState& state) {
  Vec3Array& points = context.cloth.params.fine != shader::kFineOff ? state.offset : state.position;
  const auto point = [&](uint32_t i) { return vec4(points.at(i), state.inverse_mass[i]); };
  for_split_rows(context.threads, state, [&](std::span<const uint32_t> copies) {
    const vec4 first = point(copies.front());
    if (first.w == 0) return;  // pinned, and all its copies with it
    shader::StitchSum sum = shader::stitch_begin();
    for (const uint32_t i : copies) sum = shader::stitch_add(sum, first, point(i));
    const vec3 mean = shader::stitch_mean(sum, first);
    for (const uint32_t i : copies) points.set(i, mean);
  });
}

void stitch_contacts(const PassContext& context, ClothState& state) {
  for_split_rows(context.threads, state, [&](std::span<const uint32_t> copies) {
    const auto place = [&](uint32_t i) { return vec4(state.position.at(i), state.inverse_mass[i]); };
    const auto way = [&](uint32_t i) { return vec4(shader::way_of(state.point(i)), state.inverse_mass[i]); };
    const vec4 first = place(copies.front()), first_way = way(copies.front());
    if (first.w == 0) return;  // pinned, and all its copies with it
    shader::StitchSum places = shader::stitch_begin(), ways = shader::stitch_begin();
    for (const uint32_t i : copies) {
      places = shader::stitch_add(places, first, place(i));
      ways = shader::stitch_add(ways, first_way, way(i));
    }
    const shader::PointState mean =
        shader::arrived(shader::stitch_mean(places, first), shader::stitch_mean(ways, first_way));
    for (const uint32_t i : copies) state.set_point(i, mean);
  });
}

void settle(const PassContext& context, ClothState& state) {
  for_pixels(context.threads, state, [&](uint32_t i) {
    const shader::Settled next = shader::settle(state.previous.at(i), state.offset.at(i), state.carry.at(i));
    state.set_point(i, next.point);
    state.offset.set(i, next.low);
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

void collide_triangle(const PassContext& context, ClothState& state, const CellTriangle& t) {
  const shader::ClothParams& params = context.cloth.params;
  const Vec3Array &position = state.position, &previous = state.previous;
  const shader::MovedTriangle moved = shader::collide_triangle(
      touched_colliders(context, state), params, context.substep,
      {position.at(t.a), position.at(t.b), position.at(t.c), previous.at(t.a), previous.at(t.b), previous.at(t.c)},
      vec3(state.inverse_mass[t.a], state.inverse_mass[t.b], state.inverse_mass[t.c]));
  move_corner(params, state, t.a, moved.a, moved.start_a);
  move_corner(params, state, t.b, moved.b, moved.start_b);
  move_corner(params, state, t.c, moved.c, moved.start_c);
}

void collide_cells(const PassContext& context, ClothState& state, uint32_t group) {
  const uint32_t width = state.data.width, height = state.data.height;
  const shader::uvec2 count = shader::cell_extent(width, height);
  context.threads.for_range(count.y, std::max(1U, kPixelGrain / width), [&](uint32_t first, uint32_t last) {
    for (uint32_t j = first; j < last; ++j) {
      for (uint32_t i = 0; i < count.x; ++i) {
        const shader::uvec2 p = shader::cell_corner(group, i, j);
        if (p.x + 1 >= width || p.y + 1 >= height) continue;
        for (const bool is_first : {true, false}) {
          const CellTriangle triangle = triangle_of_cell(state, p.y * width + p.x, is_first);
          if (triangle.is_cloth) collide_triangle(context, state, triangle);
        }
      }
    }
  });
}

void collide(const PassContext& context, ClothState& state) {
  const shader::ColliderSet set = touched_colliders(context, state);
  for_pixels(context.threads, state, [&](uint32_t i) {
    if (state.inverse_mass[i] == 0) return;
    const shader::ClothParams& params = context.cloth.params;
    const shader::PointState point = shader::slowed(params, state.point(i));
    const float counts = shader::yield_counts(params) ? state.yield[i] : 1.F;
    const shader::ColliderSet own = shader::set_of_point(set, state.inverse_mass[i], counts);
    const shader::PointState after = shader::collide(own, params, context.substep, point);
    state.set_point(i, after);
    state.set_yield(i, shader::next_yield(state.yield[i], after.position - point.position, params.spacing));
  });
}

void hold_way(const PassContext& context, ClothState& state) {
  for_pixels(context.threads, state, [&](uint32_t i) {
    if (state.inverse_mass[i] != 0) state.set_point(i, shader::way_held(state.point(i)));
  });
}

void give_way(const PassContext& context, ClothState& state) {
  const shader::ColliderSet set = colliders_of(context);
  for_pixels(context.threads, state, [&](uint32_t i) {
    if (state.inverse_mass[i] != 0)
      state.set_point(i, shader::way_given(set, context.cloth.params, context.substep, state.point(i)));
  });
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

/// Largest depth of a pixel in a collider [m].
float penetration_of_pixels(const PassContext& context, const ClothState& state, uint32_t first, uint32_t last) {
  const shader::ColliderSet set = colliders_of(context);
  float depth = 0;
  for (uint32_t i = first; i < last; ++i) {
    if (state.inverse_mass[i] == 0) continue;
    depth = std::max(depth, shader::depth_in_colliders(set, set.count, context.substep, state.position.at(i)));
  }
  return depth;
}

float penetration(const PassContext& context, const ClothState& state) {
  return largest(context.threads, static_cast<uint32_t>(state.pixel_count()),
                 [&](uint32_t first, uint32_t last) { return penetration_of_pixels(context, state, first, last); });
}

float longest_way(const PassContext& context, const ClothState& state) {
  return largest(context.threads, static_cast<uint32_t>(state.pixel_count()), [&](uint32_t first, uint32_t last) {
    float longest = 0;
    for (uint32_t i = first; i < last; ++i) {
      if (state.inverse_mass[i] == 0) continue;
      const vec3 way = shader::way_of(state.point(i));
      longest = std::max(longest, shader::length3(way));
    }
    return longest;
  });
}

uint32_t points_left_behind(const PassContext& context, const ClothState& state) {
  if (context.cloth.params.carried_at < 0) return 0;
  uint32_t count = 0;
  for (uint32_t i = 0; i < state.pixel_count(); ++i) {
    if (state.inverse_mass[i] == 0) continue;
    const shader::PointState point = state.point(i);
    if (shader::is_left_behind(context.cloth.params, point.position, shader::way_of(point))) ++count;
  }
  return count;
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

vec3 out_of_cleft(const PassContext& context, const vec3& start, const vec3& position) {
  return shader::out_of_cleft(colliders_of(context), context.cloth.params, context.substep, start, position);
}

void run_pass(const PassStep& step, const PassContext& context, ClothState& state, Measures& measures) {
  switch (step.pass) {
    case Pass::normals:
      return normals(context, state);
    case Pass::normals_stitch:
      return normals_stitch(context, state);
    case Pass::rescale:
      return rescale(context, state);
    case Pass::predict:
      return predict(context, state);
    case Pass::pins:
      return pins(context, state);
    case Pass::structural:
    case Pass::shear:
    case Pass::bending:
      return springs(context, state, step);
    case Pass::seam_bends:
      return seam_bends(context, state, step);
    case Pass::curvature:
      return curvature(context, state, step);
    case Pass::seam_curvature:
      return seam_curvature(context, state, step);
    case Pass::seam_spans:
      return seam_spans(context, state, step);
    case Pass::spans:
      return spans(context, state, step);
    case Pass::stitch:
      return stitch(context, state);
    case Pass::settle:
      return settle(context, state);
    case Pass::limit:
      return limit(context, state);
    case Pass::self_drift:
    case Pass::self_clear:
    case Pass::self_insert:
    case Pass::self_find:
    case Pass::self_push:
    case Pass::self_move:  // see SelfRunner
    case Pass::inter_gather:
    case Pass::inter_drift:
    case Pass::inter_clear:
    case Pass::inter_insert:
    case Pass::inter_find:
    case Pass::inter_push:
    case Pass::inter_move:
      return;
    case Pass::collide_cells:
      return collide_cells(context, state, step.group);
    case Pass::stitch_contacts:
      return stitch_contacts(context, state);
    case Pass::collide:
      return collide(context, state);
    case Pass::hold_way:
      return hold_way(context, state);
    case Pass::lines:
      return lines(context, state, step);
    case Pass::ties:
      return ties(context, state, step);
    case Pass::sew:
      return sew(context, state, step);
    case Pass::whole_ties:
      return whole_ties(context, state, step);
    case Pass::give_way:
      return give_way(context, state);
    case Pass::check_copies:
      measures.copy_gap = std::max(measures.copy_gap, copy_gap(context, state));
      return;
    case Pass::measure_motion:
      measures.longest_way[step.group] = longest_way(context, state);
      measures.left_behind[step.group] = points_left_behind(context, state);
      return;
    case Pass::check_colliders:
      measures.penetration = std::max(measures.penetration, penetration(context, state));
      return;
  }
}

}  // namespace geocloth::cpu
