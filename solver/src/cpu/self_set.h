// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "cpu/cloth_state.h"
#include "lib/point_state.h"
#include "shared/layout.h"

namespace geocloth::shader {

/// self_collide.h reads and writes a cloth through this.
struct SelfSet {
  cpu::ClothState* state;
};
inline uint self_word(SelfSet set, uint i) {
  return set.state->data.self.words[i];
}
inline void set_self_word(SelfSet set, uint i, uint value) {
  set.state->data.self.words[i] = value;
}
inline const SelfPoint& self_point(SelfSet set, uint i) {
  return set.state->data.self.points[i];
}
inline vec3 self_position(SelfSet set, uint pixel) {
  return set.state->position.at(pixel);
}
inline float self_inverse_mass(SelfSet set, uint pixel) {
  return set.state->inverse_mass[pixel];
}
inline PointState self_state(SelfSet set, uint pixel) {
  return set.state->point(pixel);
}

}  // namespace geocloth::shader

#include "lib/self_collide.h"
