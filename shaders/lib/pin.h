// SPDX-License-Identifier: Apache-2.0
// A pin moves its point after the prediction. A held point goes straight to where its target is at the end of the
// frame; a soft one is drawn to its moving target by a spring of the angular frequency w and braked relative to it,
// both taken implicitly. With A = (w dt)^2, B = 2 w dt (critical damping) its position x after the substep solves
//   x - predicted = A (goal - x) + B (previous + the goal's step - x)
// per mass of the point: cloth all of which is held so sinks as far at any resolution, but an edge bears the less the
// finer the grid is. A leashed one goes where it likes within a distance of its moving target: the motion constraints
// of NvCloth, the max distance of other engines. What lies behind its target is a ball that it stays out of: separation
// constraints there, the backstop of other engines.
// The way of a target is straight, but with a parent that turns it is the arc on which the parent takes the cloth
// along: from its chord it is off by (bow + (2 t - 1) lean) 4 t (1 - t), which is the arc to the third power of the
// angle.
#ifndef GEOCLOTH_LIB_PIN_H
#define GEOCLOTH_LIB_PIN_H

#include "../shared/layout.h"
#include "limit.h"
#include "vector.h"

#ifdef __cplusplus
namespace geocloth::shader {
#endif

// What the way bows out by after the share t of the frame; nothing at its start and at its end.
inline vec3 bow_at(PinTarget pin, float t) {
  precise float height = 4.0f * t * (1.0f - t);
  precise float side = 2.0f * t - 1.0f;
  precise vec3 r = (xyz(pin.bow) + xyz(pin.lean) * side) * height;
  return r;
}

inline vec3 pinned_position(PinTarget pin, float pin_fraction, float frame_fraction, float substep_share, vec3 position,
                            vec3 previous) {
  bool held = pin.target.w == 0.0f && pin.limit.x == 0.0f;
  if (held && pin.bow.w == 0.0f) return mix3(position, xyz(pin.target), pin_fraction);
  vec3 bow = vec3(0.0f, 0.0f, 0.0f);
  vec3 bow_before = bow;
  if (pin.bow.w != 0.0f) {
    bow = bow_at(pin, frame_fraction);
    bow_before = bow_at(pin, frame_fraction - substep_share);
  }
  if (held) {
    precise vec3 straight = position - bow_before;
    precise vec3 bowed = mix3(straight, xyz(pin.target), pin_fraction) + bow;
    return bowed;
  }
  vec3 goal = mix3(xyz(pin.start), xyz(pin.target), frame_fraction);
  precise vec3 along = previous + (xyz(pin.target) - xyz(pin.start)) * substep_share;
  if (pin.bow.w != 0.0f) {
    precise vec3 bowed_goal = goal + bow;
    precise vec3 bowed_along = along + (bow - bow_before);
    goal = bowed_goal;
    along = bowed_along;
  }
  precise vec3 r = position + (goal - position) * pin.target.w + (along - position) * pin.start.w;
  if (pin.limit.x > 0.0f) r = attach(r, goal, pin.limit.x);
  if (pin.behind.w > 0.0f) {
    precise vec3 middle = goal + mix3(xyz(pin.behind_start), xyz(pin.behind), frame_fraction);
    r = out_of_ball(r, middle, pin.behind.w);
  }
  return r;
}

#ifdef __cplusplus
}  // namespace geocloth::shader
#endif

#endif
